//! End of a session: invariant 13.

use crate::seen::Seen;

use super::Found;

/// Phase of a session around its end.
#[derive(Default)]
pub(super) struct End {
    /// Number of the last grid point, once the session is finished.
    last: Option<u64>,
    is_replayed: bool,
}

impl End {
    /// Judges the order of the observations.
    ///
    /// A replay follows the end once. A device goes on until its force is zero, on wrenches that were under way.
    pub(super) fn see(&mut self, seen: &Seen, found: &mut Found) {
        match (seen, self.last) {
            (Seen::Replayed { .. }, last) => {
                found.must(last.is_some(), 13, || {
                    "a replay before the end of the session".to_string()
                });
                found.must(!self.is_replayed, 13, || {
                    "a second replay of the session".to_string()
                });
                self.is_replayed = true;
            }
            (Seen::Pass(pass), Some(last)) => {
                let newest = pass.newest.map_or(0, |newest| newest.tick);
                found.must(newest <= last, 13, || {
                    format!("a wrench of tick {newest}; the session ended at {last}")
                });
            }
            (Seen::Pass(_), None) => {}
            (seen, Some(last)) => {
                found.must(false, 13, || {
                    format!("the session ended at tick {last}; then {seen:?}")
                });
            }
            (Seen::Finished { ticks, skipped, .. }, None) => self.last = Some(ticks + skipped),
            (_, None) => {}
        }
    }
}
