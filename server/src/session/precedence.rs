//! Precedence of a simulation thread over those of other stations on its core.
//!
//! Real-time threads of equal priority do not interrupt each other, so a tick of a millisecond would delay every
//! station on its core. A station with frequent long ticks goes behind the others: their ticks interrupt its own.
//!
//! The number of such stations is limited. On a full machine all stations have long ticks; interrupts of most stations
//! by the network would make the machine fuller.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use super::realtime::PRIORITY;

/// SCHED_FIFO priority of a station with frequent long ticks.
const BEHIND: i32 = PRIORITY - 1;
/// Long ticks in a second above which a station stays behind. Two hands in the whole mouth have a few on a full core,
/// random leaps more than fifty. All seconds here are those of computed ticks.
const OFTEN: u64 = 10;
/// Seconds of [`OFTEN`] long ticks after which the station goes behind: a burst of so many times `OFTEN` does the same.
const ENTER_S: u64 = 1;
/// Longest time behind the others after the last long tick, seconds.
const STAY_S: u64 = 2;

/// Places behind the others, shared by the stations of a server.
#[derive(Debug)]
pub(crate) struct Places {
    free: AtomicUsize,
}

impl Places {
    /// Places for an eighth of a number of stations, at least one.
    pub fn of(stations: usize) -> Self {
        Self {
            free: AtomicUsize::new((stations / 8).max(1)),
        }
    }

    fn take(&self) -> bool {
        let one_less = |free: usize| free.checked_sub(1);
        self.free
            .fetch_update(Ordering::Relaxed, Ordering::Relaxed, one_less)
            .is_ok()
    }

    fn give_back(&self) {
        self.free.fetch_add(1, Ordering::Relaxed);
    }
}

/// Precedence of one station.
pub(super) struct Precedence {
    places: Arc<Places>,
    /// CPU time above which a tick is long, nanoseconds: three quarters of a period.
    long_ns: u64,
    /// Ticks in a second.
    second: u64,
    /// Ticks until all long ticks are forgotten: each long tick adds `second / OFTEN`, each tick takes one.
    level: u64,
    behind: bool,
}

impl Precedence {
    /// Equal precedence, for ticks of `tick_ns`.
    pub fn new(tick_ns: u64, places: Arc<Places>) -> Self {
        Self {
            places,
            long_ns: tick_ns / 4 * 3,
            second: 1_000_000_000 / tick_ns,
            level: 0,
            behind: false,
        }
    }

    /// Takes the CPU time of a tick. Returns the SCHED_FIFO priority that the thread needs from now on, if it changes.
    pub fn took(&mut self, cpu_ns: u64) -> Option<i32> {
        self.level = if cpu_ns > self.long_ns {
            (self.level + self.second / OFTEN).min(STAY_S * self.second)
        } else {
            self.level.saturating_sub(1)
        };
        if self.behind && self.level == 0 {
            self.behind = false;
            self.places.give_back();
            return Some(PRIORITY);
        }
        if !self.behind && self.level > ENTER_S * self.second && self.places.take() {
            self.behind = true;
            return Some(BEHIND);
        }
        None
    }
}

impl Drop for Precedence {
    fn drop(&mut self) {
        if self.behind {
            self.places.give_back();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Priority after each change, for a session whose ticks are long in some places.
    fn changes(is_long: impl Fn(u64) -> bool) -> Vec<(u64, i32)> {
        let mut precedence = Precedence::new(1_000_000, Arc::new(Places::of(1)));
        let took = |tick| {
            let cpu_ns = 750_000 + u64::from(is_long(tick));
            precedence.took(cpu_ns).map(|priority| (tick, priority))
        };
        (0..60_000).filter_map(took).collect()
    }

    #[test]
    fn a_station_with_frequent_long_ticks_goes_behind_the_others_for_a_while() {
        let burst = changes(|tick| (100..111).contains(&tick));
        assert_eq!(burst, [(110, BEHIND), (1210, PRIORITY)]);
        let leaps = changes(|tick| tick < 20_000 && tick % 20 == 0);
        assert_eq!((leaps[0].1, leaps.len()), (BEHIND, 2), "{leaps:?}");
        assert!((20_000..22_000).contains(&leaps[1].0), "{leaps:?}");
    }

    #[test]
    fn an_eighth_of_the_stations_goes_behind_and_its_places_are_given_back() {
        let places = Arc::new(Places::of(16));
        let behind = || {
            let mut precedence = Precedence::new(1_000_000, places.clone());
            let changed = (0..100).find_map(|_| precedence.took(1_000_000));
            (precedence, changed)
        };
        let (first, second, third) = (behind(), behind(), behind());
        assert_eq!((first.1, second.1), (Some(BEHIND), Some(BEHIND)));
        assert_eq!(third.1, None, "two places for sixteen stations");
        // A session that ends gives its place back.
        drop(first);
        drop(third);
        assert_eq!(behind().1, Some(BEHIND));
    }

    #[test]
    fn a_rare_long_tick_changes_nothing() {
        assert_eq!(changes(|tick| tick % 101 == 0), []);
        assert_eq!(changes(|tick| tick % 20_000 < 10), []);
    }
}
