//! What a tick is request for and how it went: the vocabulary of its stages.

use crate::math::Pose;
use crate::state::State;
use crate::tissue::{Hand, Hands};
use crate::{MAX_TOOLS, Scene};

/// What the group asks for, per tool slot.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ToolGoal {
    /// Haptic pose.
    pub haptic: Pose,
    /// How far the hand moved the working point in this tick, metres.
    pub moved: f64,
    /// How far it turned, radians.
    pub turned: f64,
}

/// How it went, per tool slot.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ToolOutcome {
    pub status: u16,
    pub substeps: u8,
    pub rows: u16,
    pub active: u16,
    pub min_gap: f64,
    pub converged: bool,
}

impl ToolOutcome {
    pub(crate) const NOTHING: ToolOutcome = ToolOutcome {
        status: 0,
        substeps: 0,
        rows: 0,
        active: 0,
        min_gap: f64::INFINITY,
        converged: true,
    };
}

/// What a tick is about, beside its state.
#[derive(Clone, Copy)]
pub(crate) struct TickRequest<'a> {
    pub scene: &'a Scene,
    pub goals: &'a [ToolGoal; MAX_TOOLS],
    pub held: &'a Held,
    pub detail: u8,
}

/// Another group has a tissue that this one needs.
#[derive(Debug)]
pub(crate) struct TissueConflict;

/// Haptic poses of the hands that hold something, by slot.
pub(crate) type Held = [Option<Pose>; MAX_TOOLS];

pub(crate) fn held(present: &[usize], goals: &[ToolGoal; MAX_TOOLS]) -> Held {
    std::array::from_fn(|t| present.contains(&t).then(|| goals[t].haptic))
}

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
