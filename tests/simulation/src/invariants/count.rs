//! Numbers of the ticks: invariant 7.

use crate::seen::Tick;

use super::Found;

/// Sums of the ticks so far.
#[derive(Default)]
pub(super) struct Count {
    last: u64,
    ticks: u64,
    skipped: u64,
}

impl Count {
    /// Judges the number of a tick. The first tick has the number 1 plus the grid points before it.
    pub(super) fn tick(&mut self, tick: &Tick, found: &mut Found) {
        let expected = self.last + 1 + u64::from(tick.skipped);
        found.must(tick.tick == expected, 7, || {
            format!(
                "tick {} after tick {}, {} skipped; expected {expected}",
                tick.tick, self.last, tick.skipped
            )
        });
        self.last = tick.tick;
        self.ticks += 1;
        self.skipped += u64::from(tick.skipped);
    }

    /// Compares the sums of the server with those seen.
    pub(super) fn finish(&self, ticks: u64, skipped: u64, found: &mut Found) {
        found.must((ticks, skipped) == (self.ticks, self.skipped), 7, || {
            format!(
                "the end names {ticks} ticks and {skipped} skipped; seen: {} and {}",
                self.ticks, self.skipped
            )
        });
    }
}
