//! Vocabulary of a tick's stages: the request, the goal of each tool, and the outcome for each tool.

use crate::math::Pose;
use crate::output::status;
use crate::state::State;
use crate::tissue::{Hand, Hands};
use crate::{MAX_TOOLS, Scene};

/// Goal of one tool: its haptic pose and the hand's motion since the last tick.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ToolGoal {
    /// Haptic pose, `world_from_tool`.
    pub haptic: Pose,
    /// Motion of the working point by the hand in this tick, metres.
    pub moved: f64,
    /// Rotation by the hand in this tick, radians.
    pub turned: f64,
}

/// Outcome of a tick for one tool.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ToolOutcome {
    /// Bits of [`status`].
    pub status: u16,
    /// Number of substeps, 1 to `Params::max_substeps`; 0 for an absent tool.
    pub substeps: u8,
    /// Number of rows of the last problem with contacts of this tool.
    pub rows: u16,
    /// Number of these rows with a positive multiplier.
    pub active: u16,
    /// Smallest true gap after the last substep, metres; infinite without contact.
    pub min_gap: f64,
    /// Whether the last substep converged: its step was small or limited with [`status::SETTLING`], and no true gap is
    /// below minus `Params::converged_gap`. True for an absent tool.
    pub converged: bool,
}

impl ToolOutcome {
    /// Outcome of a tool without contact, and initial value of the others.
    pub(crate) const FREE: ToolOutcome = ToolOutcome {
        status: 0,
        substeps: 0,
        rows: 0,
        active: 0,
        min_gap: f64::INFINITY,
        converged: true,
    };

    /// Outcome of a case that the program rules out. The tick flags a fault, and the force ramps to zero.
    pub(crate) const IMPOSSIBLE: ToolOutcome = ToolOutcome {
        status: status::FAULT | status::SOLVER_FAILED,
        converged: false,
        ..ToolOutcome::FREE
    };
}

/// Request of one tick: constant scene, goals of the tools, level of detail.
#[derive(Clone, Copy)]
pub(crate) struct TickRequest<'a> {
    /// Constant scene.
    pub scene: &'a Scene,
    /// Goal of each tool, by slot.
    pub goals: &'a [ToolGoal; MAX_TOOLS],
    /// Haptic poses of the present tools, by slot; `None` for an absent tool.
    pub held: &'a Held,
    /// Level of detail of the tissues, 0 for the coarsest.
    pub detail: u8,
}

/// Refusal of a tissue: another group of tools has claimed it in this tick.
#[derive(Debug)]
pub(crate) struct TissueConflict;

/// Haptic poses of the present tools, by slot, `world_from_tool`; `None` for an absent tool.
pub(crate) type Held = [Option<Pose>; MAX_TOOLS];

/// Returns the haptic poses of the tools in the slots `present`; `None` in all other slots.
pub(crate) fn held(present: &[usize], goals: &[ToolGoal; MAX_TOOLS]) -> Held {
    std::array::from_fn(|t| present.contains(&t).then(|| goals[t].haptic))
}

/// Returns the present tools as visible to the tissue models: the haptic poses `held`, and the graphic poses and loads
/// now in `state`. `detail` is the level of detail, 0 for the coarsest.
pub(crate) fn hands<'a>(scene: &'a Scene, state: &'a State, held: &Held, detail: u8) -> Hands<'a> {
    let objects = scene.objects.len();
    Hands {
        tools: std::array::from_fn(|t| {
            held[t].map(|haptic| Hand {
                tool: &scene.tools[t],
                haptic,
                graphic: state.tools[t].graphic,
                loads: &state.loads[t * objects..(t + 1) * objects],
            })
        }),
        detail,
    }
}
