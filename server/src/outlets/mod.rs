//! Outlets: listeners to the ticks of a session. The recorder is the only one so far.

pub(crate) mod recording;
