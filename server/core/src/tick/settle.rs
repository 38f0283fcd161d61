//! No click: what a force may change by in one tick.
//!
//! A tool that comes loose (off an edge, from between two spheres into the next gap) has its next place of rest a tenth of a
//! millimetre and more away, and would be there at once: felt as a click, however slowly the hand goes. So a force that a tool
//! already bears changes in a tick by what the hand's own motion brings (`k_t |dq_h|`) and by [`Params::max_settle_step`]
//! beyond that; tool, tissue and loads go the share of the last pass's step that keeps to it, and on from there in the next tick.
//! Between two places where nothing is penetrated lies, on rows that are linear, no other kind.
//!
//! [`Params::max_settle_step`]: crate::Params::max_settle_step

use crate::MAX_TOOLS;
use crate::math::{Pose, Vec3, fclamp, fmax, fmin, norm};
use crate::state::State;
use crate::tick::request::TickRequest;
use crate::tick::workspace::Workspace;

/// Share per millisecond, on top, of what the coupling of a tool that is behind its hand has and the tool does not bear yet: where substeps
/// have run out, as after lost packets, it comes in a tenth of a second or two whatever the way.
const CATCH_UP: f64 = 0.03;

/// What the force of each tool may change by in this tick, newtons.
pub(crate) struct Settle {
    most: [f64; MAX_TOOLS],
    objects: usize,
}

impl Settle {
    pub fn new(request: &TickRequest<'_>, state: &State, ws: &Workspace, group: &[usize]) -> Self {
        let mut most = [f64::INFINITY; MAX_TOOLS];
        for &t in group {
            let (tool, kept) = (&request.scene.tools[t], &state.tools[t]);
            // First touch takes what it takes.
            if !kept.entered || kept.raw.force == Vec3::zeros() {
                continue;
            }
            let at = |pose: &Pose| pose.transform(&tool.working_point);
            let spring = (at(&kept.graphic) - at(&kept.haptic)) * tool.stiffness_n_per_m;
            let behind = norm(&(spring - kept.raw.force));
            let goal = &request.goals[t];
            let hand = goal.moved + goal.turned * ws.levers[t];
            let params = &request.scene.params;
            let more = params.tick_ms() * fmax(params.max_settle_step, CATCH_UP * behind);
            most[t] = tool.stiffness_n_per_m * hand + more;
        }
        Self {
            most,
            objects: request.scene.objects.len(),
        }
    }

    /// Share of a pass's step after which the first of the group's forces has changed by as much as it may; 1 where none does.
    pub fn share(&self, state: &State, ws: &Workspace, group: &[usize]) -> f64 {
        let mut share = 1.0;
        let substep = &ws.substeps[group.first().copied().unwrap_or(0)];
        let objects = self.objects;
        for &t in group {
            let most = self.most[t];
            if most == f64::INFINITY {
                continue;
            }
            // Sums of the loads on the objects; the wrench is minus them.
            let now = state.loads[t * objects..(t + 1) * objects]
                .iter()
                .fold(Vec3::zeros(), |sum, load| sum + load.force);
            let ours = substep.loaded().filter(|(c, _)| usize::from(c.tool) == t);
            let target = ours.fold(Vec3::zeros(), |sum, (contact, lambda)| {
                sum - contact.normal * fmax(lambda, 0.0)
            });
            let (gone, step) = (now + state.tools[t].raw.force, target - now);
            if norm(&(gone + step)) <= most {
                continue;
            }
            // Where |gone + share step| is as much as it may be.
            let (a, b) = (step.dot(&step), gone.dot(&step));
            let c = gone.dot(&gone) - most * most;
            let root = fmax(b * b - a * c, 0.0).sqrt();
            share = fmin(share, fclamp((root - b) / a, 0.0, 1.0));
        }
        share
    }
}
