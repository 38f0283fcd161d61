//! Precedence of a simulation thread over those of other stations on its core.
//!
//! Real-time threads of equal priority do not interrupt each other, so a tick of a millisecond would delay every station
//! on its core. A station with frequent long ticks goes behind the others: their ticks interrupt its own.

use super::realtime::PRIORITY;

/// SCHED_FIFO priority of a station with frequent long ticks.
const BEHIND: i32 = PRIORITY - 1;
/// Number of long ticks, each forgotten after a second, above which a station goes behind. Every exercise has a rare
/// long tick.
const OFTEN: u64 = 2;
/// Largest number that is remembered: the time behind the others after the last long tick, seconds.
const MOST: u64 = 10;

/// Precedence of one station.
pub(super) struct Precedence {
    /// CPU time above which a tick is long, nanoseconds: half a period.
    long_ns: u64,
    /// Ticks in a second.
    second: u64,
    /// Long ticks, `second` for each, less the ticks since.
    level: u64,
    behind: bool,
}

impl Precedence {
    /// Equal precedence, for ticks of `tick_ns`.
    pub fn new(tick_ns: u64) -> Self {
        Self {
            long_ns: tick_ns / 2,
            second: 1_000_000_000 / tick_ns,
            level: 0,
            behind: false,
        }
    }

    /// Takes the CPU time of a tick. Returns the SCHED_FIFO priority that the thread needs from now on, if it changes.
    pub fn took(&mut self, cpu_ns: u64) -> Option<i32> {
        self.level = if cpu_ns > self.long_ns {
            (self.level + self.second).min(MOST * self.second)
        } else {
            self.level.saturating_sub(1)
        };
        let behind = self.level > if self.behind { 0 } else { OFTEN * self.second };
        let changed = behind != std::mem::replace(&mut self.behind, behind);
        changed.then_some(if behind { BEHIND } else { PRIORITY })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Priority after each change, for a session whose ticks are long in some places.
    fn changes(is_long: impl Fn(u64) -> bool) -> Vec<(u64, i32)> {
        let mut precedence = Precedence::new(1_000_000);
        let took = |tick| {
            let cpu_ns = 500_000 + u64::from(is_long(tick));
            precedence.took(cpu_ns).map(|priority| (tick, priority))
        };
        (0..60_000).filter_map(took).collect()
    }

    #[test]
    fn a_station_with_frequent_long_ticks_goes_behind_the_others_for_a_while() {
        let burst = changes(|tick| (100..103).contains(&tick));
        assert_eq!(burst, [(102, BEHIND), (3102, PRIORITY)]);
        let leaps = changes(|tick| tick < 20_000 && tick % 10 == 0);
        assert_eq!(leaps[0], (20, BEHIND));
        assert!(leaps[1].0 > 29_900 && leaps.len() == 2, "{leaps:?}");
    }

    #[test]
    fn a_rare_long_tick_changes_nothing() {
        assert_eq!(changes(|tick| tick % 1001 == 0), []);
        assert_eq!(changes(|tick| tick % 20_000 < 2), []);
    }
}
