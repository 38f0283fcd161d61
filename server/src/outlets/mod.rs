//! Outlets: listeners to the ticks of a session: the recorder, and the feed for displays.

pub mod feed;
pub(crate) mod recording;
