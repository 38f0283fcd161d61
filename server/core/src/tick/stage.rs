//! How the stages of a tick are timed without a clock in the core.

/// Stages of a tick, in order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// Input checks and the free step of tissue.
    Prepare,
    /// Contact prediction: tree against tree.
    Collide,
    /// The constrained optimisation.
    Optimise,
    /// Loads to the tissue, wrench, ramps.
    Apply,
    /// State hash.
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

/// Told when a stage begins; the previous one ends there.
pub trait StageProbe {
    /// `stage` begins now.
    fn begin(&mut self, stage: Stage);
    /// The tick is over.
    fn end(&mut self);
}

/// Times nothing and costs nothing.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoProbe;

impl StageProbe for NoProbe {
    #[inline(always)]
    fn begin(&mut self, _: Stage) {}
    #[inline(always)]
    fn end(&mut self) {}
}
