//! Limit on the change of a force within one tick, which prevents clicks.
//!
//! A tool that comes loose has its next place of rest a tenth of a millimetre or more away. Examples are a slip off an
//! edge, or from between two spheres into the next gap. Without a limit the tool would be there within one tick. The
//! hand would feel a click, however slow its motion.
//!
//! The force that a tool already bears therefore has a limited change per tick. The limit is the change by the hand's
//! own motion (`k_t |dq_h|`) plus [`Params::max_settle_step`] per millisecond. Tool, tissue and loads move by the share
//! of the last substep's step that keeps the limit. The motion continues in the next tick. On linear rows every place
//! between two places without penetration is free of penetration.
//!
//! A tool that arrives from its entry has the limit from its first touch on: [`Params::max_arrival_step`] instead of
//! [`Params::max_settle_step`], and no faster catching up. Before its entry a tool bears no load.
//!
//! [`Params::max_settle_step`]: crate::Params::max_settle_step
//! [`Params::max_arrival_step`]: crate::Params::max_arrival_step

use crate::MAX_TOOLS;
use crate::math::{Pose, Vec3, fclamp, fmax, fmin, norm};
use crate::state::{Arrival, State};
use crate::tick::request::TickRequest;
use crate::tick::workspace::Workspace;

/// Rate per millisecond at which a tool catches up with its hand, as a share of the coupling force not yet borne.
/// Replaces `Params::max_settle_step` where larger. After exhausted substeps, as after lost packets, the tool arrives
/// within one or two tenths of a second, whatever the distance.
const CATCH_UP: f64 = 0.03;

/// Limits on the change of the contact force on each tool in this tick, newtons.
pub(crate) struct Settle {
    /// Largest change of the contact force on each tool in this tick, by slot, newtons. Infinite for a tool without
    /// contact force in the last tick.
    most: [f64; MAX_TOOLS],
    /// Contact force on each tool at the end of the last tick, by slot, newtons.
    before: [Vec3; MAX_TOOLS],
    objects: usize,
}

impl Settle {
    pub fn new(request: &TickRequest<'_>, state: &State, ws: &Workspace, group: &[usize]) -> Self {
        let mut most = [f64::INFINITY; MAX_TOOLS];
        let mut before = state.tools.map(|kept| kept.raw.force);
        for &t in group {
            let (tool, kept) = (&request.scene.tools[t], &state.tools[t]);
            let (goal, params) = (&request.goals[t], &request.scene.params);
            let moved = tool.stiffness_n_per_m * (goal.moved + goal.turned * ws.levers[t]);
            if kept.arrival == Arrival::Travelling {
                let step = params.tick_ms() * params.max_arrival_step;
                // The motion of the hand during its absence is none of its own.
                (most[t], before[t]) = if kept.entered {
                    (moved + step, before[t])
                } else {
                    (step, Vec3::zeros())
                };
                continue;
            }
            // The first touch has no limit.
            if !kept.entered || kept.raw.force == Vec3::zeros() {
                continue;
            }
            let at = |pose: &Pose| pose.transform(&tool.working_point);
            let spring = (at(&kept.graphic) - at(&kept.haptic)) * tool.stiffness_n_per_m;
            let behind = norm(&(spring - kept.raw.force));
            let more = params.tick_ms() * fmax(params.max_settle_step, CATCH_UP * behind);
            most[t] = moved + more;
        }
        Self {
            most,
            before,
            objects: request.scene.objects.len(),
        }
    }

    /// Returns the share of the substep's step, 0 to 1, at which the first force of the group reaches its limit; 1 if
    /// none does.
    pub fn share(&self, state: &State, ws: &Workspace, group: &[usize]) -> f64 {
        let mut share = 1.0;
        let substep = &ws.substeps[group.first().copied().unwrap_or(0)];
        let objects = self.objects;
        for &t in group {
            let most = self.most[t];
            if most == f64::INFINITY {
                continue;
            }
            // Sum of the loads on the objects, which is minus the wrench.
            let now = state.loads[t * objects..(t + 1) * objects]
                .iter()
                .fold(Vec3::zeros(), |sum, load| sum + load.force);
            let ours = substep.loaded().filter(|(c, _)| usize::from(c.tool) == t);
            let target = ours.fold(Vec3::zeros(), |sum, (contact, lambda)| {
                sum - contact.normal * fmax(lambda, 0.0)
            });
            let (gone, step) = (now + self.before[t], target - now);
            if norm(&(gone + step)) <= most {
                continue;
            }
            // Solution of `|gone + share step| = most`.
            let (a, b) = (step.dot(&step), gone.dot(&step));
            let c = gone.dot(&gone) - most * most;
            let root = fmax(b * b - a * c, 0.0).sqrt();
            share = fmin(share, fclamp((root - b) / a, 0.0, 1.0));
        }
        share
    }
}
