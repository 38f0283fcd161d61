//! Server of the model: one tick with its ramp, clamp and slew limit.

use super::{MS, Play, Turn, slewed, wrenches};
use crate::seen::{Newest, Seen, Tick};

impl Play {
    /// Runs a tick, and sends its wrench.
    pub(super) fn step(&mut self, turn: &Turn) {
        let skipped = std::mem::take(&mut self.skipped_now);
        self.tick += 1 + u64::from(skipped);
        self.ticks += 1;
        self.skipped += u64::from(skipped);
        let lowest = self
            .limits
            .iter()
            .filter(|limit| **limit > 0.0)
            .fold(f64::INFINITY, |a, b| a.min(*b));
        let levels = (
            self.pauses.contains(&true),
            if lowest.is_finite() { lowest } else { 0.0 },
        );
        let before = std::mem::replace(&mut self.levels_before, levels);
        let (paused, force_limit_n) = if self.faulty.late_levels {
            before
        } else {
            levels
        };
        let present = self.is_attached && self.used.is_some();
        let stale = present
            && self
                .used
                .is_some_and(|used| self.now_ms * MS - used.arrived_ns > 50 * MS);
        if self.is_attached {
            self.is_gap = false;
        } else if !std::mem::replace(&mut self.is_gap, true) {
            self.gaps += 1;
        }
        let is_idle = paused || !present || stale;
        self.strength += if is_idle { -1.0 / 20.0 } else { 1.0 / 500.0 };
        self.strength = self.strength.clamp(0.0, 1.0);
        // A raw force of 8 N is beyond the limit, so the limit is what the hand feels.
        let limit = if force_limit_n > 0.0 {
            force_limit_n.min(3.3)
        } else {
            3.3
        };
        let target = (8.0 * self.strength).min(limit);
        self.sent_n = slewed(self.sent_n, target);
        let tick = Tick {
            tick: self.tick,
            skipped,
            present: [present, false],
            stale: [stale, false],
            paused,
            force_limit_n,
            used: self.used,
            sent: wrenches(self.sent_n),
        };
        self.see(0, Seen::Tick(Box::new(tick)));
        self.see(0, Seen::Queues { recorder: 3 });
        if self.is_attached && !turn.loses_wrench {
            let arrived_ns = self.now_ms * MS + 300_000 + turn.delay_ns;
            let newest = Newest {
                epoch: self.epoch,
                tick: self.tick,
                arrived_ns,
                force_limit_n,
                paused,
            };
            self.on_the_way.push_back((arrived_ns, newest, self.sent_n));
        }
    }
}
