//! Times of a session in a review.

use sulcus_core::Scene;

use crate::review::Moment;

/// Part of a session.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Window {
    /// Start, seconds of the session.
    pub from_s: f64,
    /// End, seconds of the session.
    pub to_s: f64,
}

impl Window {
    /// Whether a time is within the window, seconds of the session.
    pub(super) fn holds(&self, time_s: f64) -> bool {
        (self.from_s..=self.to_s).contains(&time_s)
    }
}

/// Time of a tick.
pub(super) fn moment(scene: &Scene, tick: u64) -> Moment {
    Moment {
        tick: tick as i64,
        session_ns: (tick as f64 * scene.tick_s() * 1e9).round() as i64,
    }
}
