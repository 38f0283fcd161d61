//! Outlets: listeners to the ticks of a session, on the recorder's thread. None can delay a tick.

pub mod feed;
pub mod hands;
pub(crate) mod metrics;
pub(crate) mod opening;
pub(crate) mod recording;
pub(crate) mod status;
