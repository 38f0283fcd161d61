//! Contact list of one substep, within its capacity.

use crate::Scene;
use crate::blend::reach;
use crate::contact::{ContactsFull, Distance, Overflow, SMALLEST_PREDICTION};
use crate::math::fmax;
use crate::state::{Arrival, State};
use crate::tick::posed::{posed, substep_of};
use crate::tick::step::OVERLAP;
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
///
/// A tool alone that arrives deep in tissue is an exception: see [`collide_deep`].
pub(crate) fn collide(
    scene: &Scene,
    state: &State,
    ws: &mut Workspace,
    (group, limit): (&[usize], usize),
    // Blended surfaces list spheres from farther away; the share scales this additional reach.
    (mut d, mut share): (Distance, f64),
) -> (Fits, bool) {
    let longest = group.iter().fold(0.0, |most, &t| fmax(most, ws.levers[t]));
    let index = substep_of(group);
    let mut cut = share < 1.0;
    // Of two tools, the deeper one could fill the list alone, and the other one would feel no tissue.
    let mut arrives = matches!(group, [t] if state.tools[*t].arrival == Arrival::Travelling);
    loop {
        let overflow = if d.base > SMALLEST_PREDICTION || d.turn > 0.0 {
            Overflow::Stop
        } else {
            Overflow::KeepSmallestGaps
        };
        ws.substeps[index].contacts.begin(limit, overflow);
        if list(scene, state, ws, group, (d, share), Objects::All).is_err() {
            ws.counts.contacts += limit as u64;
            cut = true;
            if std::mem::take(&mut arrives)
                && collide_deep(scene, state, ws, (group, limit), (d, share))
            {
                return (Fits { d, share }, true);
            }
            let most = d.at(longest);
            let blended = || (0..scene.objects.len()).any(|k| scene.blend_of(k) > 0.0);
            if share > 0.0 && most <= 2.0 * scene.params.predict_min && blended() {
                share = if share > 0.1 { 0.5 * share } else { 0.0 };
            } else {
                d = d.shorter(longest);
            }
            continue;
        }
        let contacts = &mut ws.substeps[index].contacts;
        contacts.sort();
        let listed = contacts.as_slice().len();
        ws.counts.contacts += listed as u64;
        // At the smallest distance a full list has dropped the largest gaps.
        let full = overflow == Overflow::KeepSmallestGaps && listed == limit;
        return (Fits { d, share }, cut || full);
    }
}

/// Lists all contacts with rigid objects, and beside them the deepest overlaps with tissue. Returns whether every
/// listed contact with tissue is an overlap of more than [`OVERLAP`]. Otherwise the list is no answer.
///
/// Tissue relaxes into an absent tool. The overlaps of the tool that comes back can fill the list at any distance. At
/// the smallest one the tool would leave the tissue by 1 um in a substep. The dropped contacts are shallower than the
/// listed ones and push less far, so the tool may move by the whole distance `d`.
fn collide_deep(
    scene: &Scene,
    state: &State,
    ws: &mut Workspace,
    (group, limit): (&[usize], usize),
    within: (Distance, f64),
) -> bool {
    let index = substep_of(group);
    ws.substeps[index].contacts.begin(limit, Overflow::Stop);
    if list(scene, state, ws, group, within, Objects::Rigid).is_err() {
        ws.counts.contacts += limit as u64;
        return false;
    }
    let contacts = &mut ws.substeps[index].contacts;
    contacts.fix(Overflow::KeepSmallestGaps);
    // A list that keeps the smallest gaps is never full.
    let found = list(scene, state, ws, group, within, Objects::Yielding);
    let contacts = &mut ws.substeps[index].contacts;
    let is_deep = found.is_ok() && contacts.largest_kept().is_some_and(|gap| gap < -OVERLAP);
    contacts.sort();
    ws.counts.contacts += contacts.as_slice().len() as u64;
    is_deep
}

/// Objects of a query.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Objects {
    All,
    Rigid,
    Yielding,
}

/// Adds the contacts of the group's tools with `objects` to the list of the group's substep. `d` is the distance,
/// `share` the share of the reach of blended surfaces.
///
/// # Errors
/// The list is full.
fn list(
    scene: &Scene,
    state: &State,
    ws: &mut Workspace,
    group: &[usize],
    (d, share): (Distance, f64),
    objects: Objects,
) -> Result<(), ContactsFull> {
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
    for &t in group {
        let posed = posed(scene, state, t);
        predictor.begin(&posed);
        let displaced = |k: usize| slots[k].map_or(0.0, |slot| yielding[slot].displaced(zeros));
        for &k in broad.near(scene, predictor, &posed, (d, levers[t]), displaced) {
            let at = usize::from(k);
            let (object, blend) = (&scene.objects[at], scene.blend_of(at));
            let mut within = d;
            if blend > 0.0 {
                // Blended surfaces list spheres from farther away.
                within.base += share * reach(blend) * blend;
            }
            match slots[at] {
                None if objects != Objects::Yielding => {
                    let object = (k, object.tree.nodes(), object.level);
                    predictor.predict(&posed, object, within, contacts)?;
                }
                Some(slot) if objects != Objects::Rigid => {
                    yielding[slot].predict(scene, predictor, &posed, within, contacts)?;
                }
                _ => {}
            }
        }
    }
    Ok(())
}
