//! Precedence of a simulation thread over those of other stations on its core.
//!
//! Real-time threads of equal priority do not interrupt each other, so a tick of a millisecond would delay every
//! station on its core. A station with frequent long ticks goes behind the others: their ticks interrupt its own.
//!
//! The number of such stations is limited. On a full machine all stations have long ticks; interrupts of most stations
//! by the network would make the machine fuller. On a full core a station behind the others would also starve: after
//! five periods without an end of its tick every other station leaves out a grid point.

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

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

/// Periods without an end of a tick after which the other stations give way.
const STARVED_PERIODS: u64 = 5;

/// Fraction of the golden ratio, in 2^-64. Its multiples, modulo one, divide a period evenly for any number of
/// sessions.
const GOLDEN: u64 = 0x9E37_79B9_7F4A_7C15;

/// Places behind the others, and phases of the ticks, shared by the stations of a server.
#[derive(Debug)]
pub(crate) struct Places {
    /// For each core the number of sessions begun so far; `None`: sessions that are bound to no core.
    begun: Mutex<BTreeMap<Option<usize>, u64>>,
    /// For each place the end of its station's newest tick, nanoseconds of the monotonic clock; 0 for a free place.
    ended_ns: Vec<AtomicU64>,
}

impl Places {
    /// Places for an eighth of a number of stations, at least one.
    pub fn of(stations: usize) -> Self {
        let places = (stations / 8).max(1);
        Self {
            begun: Mutex::default(),
            ended_ns: (0..places).map(|_| AtomicU64::new(0)).collect(),
        }
    }

    /// Phase of the ticks of a new session on `core` in their period. The ticks of successive sessions on one core are
    /// staggered, so that they wait little for each other.
    pub fn phase_ns(&self, core: Option<usize>, tick_ns: u64) -> u64 {
        let mut begun = self.begun.lock().unwrap_or_else(PoisonError::into_inner);
        let begun = begun.entry(core).or_default();
        let share = begun.wrapping_mul(GOLDEN);
        *begun += 1;
        ((u128::from(share) * u128::from(tick_ns)) >> 64) as u64
    }

    /// Takes a free place, if there is one.
    fn take(&self, now_ns: u64) -> Option<usize> {
        let is_mine = |place: &AtomicU64| {
            place
                .compare_exchange(0, now_ns.max(1), Ordering::Relaxed, Ordering::Relaxed)
                .is_ok()
        };
        self.ended_ns.iter().position(is_mine)
    }

    /// Notes the end of a tick, or with 0 the end of the place's use.
    fn note(&self, place: usize, ended_ns: u64) {
        self.ended_ns[place].store(ended_ns, Ordering::Relaxed);
    }

    /// Whether a station behind the others has not ended a tick since `before_ns`.
    fn starves(&self, before_ns: u64) -> bool {
        let ended_ns = |place: &AtomicU64| place.load(Ordering::Relaxed);
        self.ended_ns
            .iter()
            .map(ended_ns)
            .any(|ended_ns| ended_ns != 0 && ended_ns < before_ns)
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
    /// Place behind the others; `None` at equal precedence.
    place: Option<usize>,
    /// Time without an end of a tick after which the other stations give way, nanoseconds.
    starved_ns: u64,
}

impl Precedence {
    /// Equal precedence, for ticks of `tick_ns`.
    pub fn new(tick_ns: u64, places: Arc<Places>) -> Self {
        Self {
            places,
            long_ns: tick_ns / 4 * 3,
            second: 1_000_000_000 / tick_ns,
            level: 0,
            place: None,
            starved_ns: tick_ns * STARVED_PERIODS,
        }
    }

    /// Takes the CPU time of a tick that ended at `ended_ns` of the monotonic clock. Returns the SCHED_FIFO priority
    /// that the thread needs from now on, if it changes.
    pub fn took(&mut self, cpu_ns: u64, ended_ns: u64) -> Option<i32> {
        self.level = if cpu_ns > self.long_ns {
            (self.level + self.second / OFTEN).min(STAY_S * self.second)
        } else {
            self.level.saturating_sub(1)
        };
        match self.place {
            Some(place) if self.level == 0 => {
                self.place = None;
                self.places.note(place, 0);
                return Some(PRIORITY);
            }
            Some(place) => self.places.note(place, ended_ns),
            None if self.level > ENTER_S * self.second => {
                self.place = self.places.take(ended_ns);
                return self.place.map(|_| BEHIND);
            }
            None => {}
        }
        None
    }

    /// Whether this station leaves out its next grid point at `now_ns`, because a station behind the others starves.
    pub fn gives_way(&self, now_ns: u64) -> bool {
        self.place.is_none() && self.places.starves(now_ns.saturating_sub(self.starved_ns))
    }
}

impl Drop for Precedence {
    fn drop(&mut self) {
        if let Some(place) = self.place {
            self.places.note(place, 0);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_of_the_sessions_of_a_core_are_staggered_over_the_period() {
        const TICK_NS: u64 = 1_000_000;
        for (cores, sessions) in [(1, 2), (1, 16), (2, 5), (5, 6), (8, 4), (13, 3)] {
            let places = Places::of(sessions);
            // Sessions go to the cores in turn.
            let begun = (0..cores * sessions).map(|k| places.phase_ns(Some(k % cores), TICK_NS));
            let mut sorted: Vec<u64> = begun.skip(cores - 1).step_by(cores).collect();
            assert_eq!(sorted.len(), sessions);
            sorted.sort_unstable();
            sorted.push(sorted[0] + TICK_NS);
            let nearest = sorted.windows(2).map(|pair| pair[1] - pair[0]).min();
            let even = TICK_NS as f64 / sessions as f64;
            assert!(
                nearest.is_some_and(|nearest| nearest as f64 >= even / 2.0),
                "{sessions} sessions: {nearest:?} of {even}"
            );
        }
    }

    /// Priority after each change, for a session whose ticks are long in some places.
    fn changes(is_long: impl Fn(u64) -> bool) -> Vec<(u64, i32)> {
        let mut precedence = Precedence::new(1_000_000, Arc::new(Places::of(1)));
        let took = |tick| {
            let cpu_ns = 750_000 + u64::from(is_long(tick));
            precedence
                .took(cpu_ns, tick)
                .map(|priority| (tick, priority))
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
            let changed = (0..100).find_map(|_| precedence.took(1_000_000, 1));
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

    /// On a full core a station behind the others once waited a second for the end of its tick.
    #[test]
    fn the_others_give_way_to_a_station_that_starves() {
        let places = Arc::new(Places::of(8));
        let of = || Precedence::new(1_000_000, places.clone());
        let (mut behind, other) = (of(), of());
        assert!((0..100).any(|_| behind.took(1_000_000, 7_000_000) == Some(BEHIND)));
        assert!(!other.gives_way(12_000_000));
        assert!(other.gives_way(12_000_001));
        assert!(!behind.gives_way(12_000_001), "it needs the core itself");
        behind.took(1_000_000, 12_000_000);
        assert!(!other.gives_way(17_000_000));
        drop(behind);
        assert!(!other.gives_way(u64::MAX), "the place is free");
    }

    #[test]
    fn a_rare_long_tick_changes_nothing() {
        assert_eq!(changes(|tick| tick % 101 == 0), []);
        assert_eq!(changes(|tick| tick % 20_000 < 10), []);
    }
}
