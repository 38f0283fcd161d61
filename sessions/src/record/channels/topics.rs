//! Topics and frames that do not depend on names of tools or objects.

/// Topic of the session's log for viewers.
pub(crate) const LOG: &str = "/log";
/// Topic of the frames.
pub(super) const TRANSFORMS: &str = "/tf";
/// Topic of [`super::v1::SessionMetrics`].
pub(crate) const SESSION_METRICS: &str = "/session/metrics";
/// Frame of everything that does not move with a tool.
pub(super) const WORLD: &str = "world";
