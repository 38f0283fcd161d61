//! Session: simulation thread at SCHED_FIFO, its inputs, and the wait-free hand-overs to the other threads.

pub(crate) mod at_hand;
pub(crate) mod changes;
pub(crate) mod coupling;
pub mod detail;
mod ending;
pub(crate) mod gaps;
mod grid;
pub(crate) mod handoff;
pub(crate) mod inputs;
pub(crate) mod levels;
pub(crate) mod loops;
pub(crate) mod metrics;
pub(crate) mod ports;
pub(crate) mod precedence;
pub(crate) mod queue;
pub(crate) mod realtime;
pub(crate) mod running;
pub(crate) mod simulation;
#[doc(hidden)]
pub mod stepped;
