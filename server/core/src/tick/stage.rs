//! Stages of a tick, and the probe that times them without a clock in the core.

/// Stages of a tick, in order. `Collide` and `Optimise` begin again in every substep.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// Input checks and free step of the tissues.
    Prepare,
    /// Contact prediction, tree against tree, and the rows of the contacts.
    Collide,
    /// Optimisation of a substep, its step, and the check of the true gaps.
    Optimise,
    /// Commit of the tissues, wrench and ramps.
    Apply,
    /// Hash of the input and the state.
    Hash,
}

impl Stage {
    /// All stages, in order.
    pub const ALL: [Stage; 5] = [
        Stage::Prepare,
        Stage::Collide,
        Stage::Optimise,
        Stage::Apply,
        Stage::Hash,
    ];
}

/// Observer of the stages of a tick. A stage ends when the next begins.
pub trait StageProbe {
    /// Called when `stage` begins.
    fn begin(&mut self, stage: Stage);
    /// Called at the end of the tick.
    fn end(&mut self);
}

/// Probe that records nothing and costs nothing.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoProbe;

impl StageProbe for NoProbe {
    #[inline(always)]
    fn begin(&mut self, _: Stage) {}
    #[inline(always)]
    fn end(&mut self) {}
}
