//! Contact list of one substep, within its capacity.

use crate::Scene;
use crate::blend::reach;
use crate::contact::{Distance, Overflow, SMALLEST_PREDICTION};
use crate::math::fmax;
use crate::state::State;
use crate::tick::posed::{posed, substep_of};
use crate::tick::workspace::Workspace;

/// Prediction distance, and share of the reach of blended surfaces, with which the contacts fit into the list.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Fits {
    /// Prediction distance that was used: the one requested, or a shorter one if the list was full.
    pub d: Distance,
    /// Share of the reach of blended surfaces ([`reach`]) that is added to `d`, 0 to 1; normally 1.
    pub share: f64,
}

/// Lists the contacts of the tools `group` (slots) at the present poses and shapes, at most `limit` of them, within `d`
/// or within the distance that fits into the list. Returns the distance and the share used, and whether either was cut
/// or a contact was dropped.
///
/// On overflow `d` shrinks by a factor of 0.7, which costs only more substeps. With blended surfaces, once `d` is
/// within twice `Params::predict_min`, the share of their reach is halved instead. Blended surfaces then consist of
/// fewer spheres. A share of 0.1 or less is set to 0 on the next overflow, and after that `d` shrinks further.
///
/// Even the smallest distance can overflow, as with a flat tool on a flat face. The list then keeps the smallest gaps.
/// The dropped contacts are within the smallest distance. No substep moves farther, and the next substep ranks again.
pub(crate) fn collide(
    scene: &Scene,
    state: &State,
    ws: &mut Workspace,
    (group, limit): (&[usize], usize),
    // Blended surfaces list spheres from farther away; the share scales this additional reach.
    (mut d, mut share): (Distance, f64),
) -> (Fits, bool) {
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
        counts,
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
                    counts.contacts += limit as u64;
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
        counts.contacts += contacts.as_slice().len() as u64;
        // At the smallest distance a full list has dropped the largest gaps.
        let full = overflow == Overflow::KeepSmallestGaps && contacts.as_slice().len() == limit;
        return (Fits { d, share }, cut || full);
    }
}
