//! One pass's list of contacts, as far as it has room.

use crate::Scene;
use crate::blend::reach;
use crate::contact::{Distance, Overflow, SMALLEST_PREDICTION};
use crate::math::fmax;
use crate::state::State;
use crate::tick::posed::{posed, substep_of};
use crate::tick::workspace::Workspace;

/// How far a pass looks, and with how much of the reach of blended surfaces.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Fits {
    pub d: Distance,
    pub share: f64,
}

/// Lists the contacts at the present poses and shapes, within `d` or as far as the list reaches: while it
/// is full it halves `d`, which costs passes only, then the reach of blended surfaces, which are then made
/// of fewer spheres. Returns what it used and whether anything was cut. Where even the smallest distance
/// finds more than the list holds (a flat tool on a flat face), the smallest gaps are kept: what is left
/// out lies within that smallest distance, no pass moves farther, and the next one ranks anew.
pub(crate) fn collide(
    scene: &Scene,
    state: &State,
    ws: &mut Workspace,
    group: &[usize],
    // Blended surfaces are made of spheres from farther away; where there is no room for them, of fewer.
    (mut d, mut share): (Distance, f64),
) -> (Fits, bool) {
    let limit = scene.most_contacts() * group.len();
    let longest = group.iter().fold(0.0, |most, &t| fmax(most, ws.levers[t]));
    let mut cut = share < 1.0;
    let Workspace {
        predictor,
        broad,
        yielding,
        slots,
        zeros,
        substeps,
        levers,
        ..
    } = ws;
    let contacts = &mut substeps[substep_of(group)].contacts;
    'again: loop {
        let overflow = if d.base > SMALLEST_PREDICTION || d.turn > 0.0 {
            Overflow::Stop
        } else {
            Overflow::KeepSmallestGaps
        };
        contacts.begin(limit, overflow);
        for &t in group {
            let posed = posed(scene, state, t);
            predictor.begin(&posed);
            let displaced = |k: usize| slots[k].map_or(0.0, |slot| yielding[slot].displaced(zeros));
            for &k in broad.near(scene, predictor, &posed, (d, levers[t]), displaced) {
                let at = usize::from(k);
                let (object, blend) = (&scene.objects[at], scene.blend_of(at));
                let mut within = d;
                if blend > 0.0 {
                    within.base += share * reach(blend) * blend;
                }
                let found = match slots[at] {
                    None => {
                        let object = (k, object.tree.nodes(), object.level);
                        predictor.predict(&posed, object, within, contacts)
                    }
                    Some(slot) => {
                        yielding[slot].predict(scene, predictor, &posed, within, contacts)
                    }
                };
                if found.is_err() {
                    cut = true;
                    let most = d.at(longest);
                    let blended = || (0..scene.objects.len()).any(|k| scene.blend_of(k) > 0.0);
                    if share > 0.0 && most <= 2.0 * scene.params.predict_min && blended() {
                        share = if share > 0.1 { 0.5 * share } else { 0.0 };
                    } else {
                        d = d.shorter(longest);
                    }
                    continue 'again;
                }
            }
        }
        contacts.sort();
        // In the last resort a full list has left out the largest gaps.
        let full = overflow == Overflow::KeepSmallestGaps && contacts.as_slice().len() == limit;
        return (Fits { d, share }, cut || full);
    }
}
