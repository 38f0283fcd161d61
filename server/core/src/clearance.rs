//! Clearance of a tool at any pose, for decisions outside of a tick: whether the haptic tool is free of contact.
//!
//! A device may change its gain, or a station its place of computation, only while the hand feels nothing.

use crate::Scene;
use crate::contact::PosedTool;
use crate::contact::near::Near;
use crate::math::Pose;
use crate::state::State;
use crate::tick::workspace::Workspace;

/// Clearance from which a tool counts as free, metres: the distance of the status bit
/// [`FREE`](crate::output::status::FREE).
pub const FREE_DISTANCE: f64 = 5e-4;

/// Limit of tested pairs of nodes in one call, for all objects together. A pair takes about 4 ns, so that a call takes
/// at most 80 us.
const MOST_TESTS: u32 = 20_000;

/// Whether tool `tool` (slot) at `pose` (`world_from_tool`) has no contact within `distance` metres of any object.
///
/// The objects have their shapes at the end of the last tick: rigid trees and deformed tissue, sphere by sphere at the
/// levels in contact. `state` and `ws` must be those of that tick. The call allocates nothing, changes no result of
/// later ticks, and tests at most 20,000 pairs of nodes.
///
/// False without such a tool, for a pose with a number that is not finite, and where the limit of tests is reached.
pub fn is_free(
    scene: &Scene,
    state: &State,
    ws: &mut Workspace,
    tool: usize,
    pose: &Pose,
    distance: f64,
) -> bool {
    let turned = pose.orientation.coords.iter();
    let finite = pose.position.iter().chain(turned).all(|x| x.is_finite());
    let Some(held) = scene.tools.get(tool).filter(|_| finite) else {
        return false;
    };
    let posed = PosedTool {
        nodes: held.tree.nodes(),
        pose,
        level: held.level,
        working_point: &held.working_point,
        slot: tool as u8,
    };
    let Workspace {
        predictor,
        yielding,
        slots,
        ..
    } = ws;
    predictor.begin(&posed);
    let mut tests = MOST_TESTS;
    for (object, slot) in scene.objects.iter().zip(slots) {
        let found = match *slot {
            None => {
                let nodes = (object.tree.nodes(), object.level);
                predictor.any_within(&posed, nodes, distance, &mut tests)
            }
            Some(slot) => {
                // A fresh workspace knows no shape: only the state tells that the tissue is at rest.
                let yielding = &mut yielding[slot];
                if yielding.still && !state.tissue.at_rest(slot) {
                    return false;
                }
                let nodes = (yielding.fitted_nodes(scene), object.level);
                predictor.any_within(&posed, nodes, distance, &mut tests)
            }
        };
        if found != Near::None {
            return false;
        }
    }
    true
}

#[cfg(test)]
mod tests;
