//! Choice of tissue's level of detail by time (the paper's section 3.1): coarse, and fine while ticks leave time for
//! it.
//!
//! The choice is a function of the CPU times of the previous ticks. The level enters the tick as
//! [`sulcus_core::TickInput::detail`] and is recorded, so a replay needs no clock.
//!
//! A switch of level changes the force by a small step. The choice therefore rises slowly and falls quickly. Each fall
//! doubles the wait for the next rise, up to 64 times the first wait.

use sulcus_core::TickInput;

/// Level of detail of tissue.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Detail {
    /// One level, 0 (coarse) or 1 (fine), for the whole session. A graded session needs a fixed level, because all
    /// students must feel the same tissue.
    Fixed(u8),
    /// The finest level that the time allows, from coarse at the start.
    ByTime(Budget),
}

impl Detail {
    /// The one level; `None` for a choice by time.
    pub fn fixed(self) -> Option<u8> {
        match self {
            Self::Fixed(level) => Some(level),
            Self::ByTime(_) => None,
        }
    }
}

impl Default for Detail {
    fn default() -> Self {
        Detail::Fixed(0)
    }
}

/// Parameters of the choice by time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Budget {
    /// Largest mean CPU time of a tick, microseconds, 10 to 900. The level falls at a mean above it.
    ///
    /// The number is absolute at every rate: a tick has 1000 us at 1 kHz and 125 us at 8 kHz. A larger budget keeps the
    /// fine level longer and leaves less time for rare long ticks.
    pub budget_us: u32,
    /// Expected CPU time of a tick at the next finer level, per cent of the time at the present level, 100 to 2000.
    ///
    /// The level may rise while the mean times this factor is within the budget. A larger number causes fewer rises
    /// that are soon followed by a fall.
    pub growth_percent: u32,
    /// Number of consecutive ticks with time left before the first rise, 10 to 60,000. Each fall doubles the number, up
    /// to 64 times the first one.
    pub settle_ticks: u32,
}

impl Default for Budget {
    /// A third of a tick and half a second at 1 kHz, and three times the CPU time at the finer level.
    ///
    /// The finer skeleton has 8 times as many spheres, but its collision costs the same.
    fn default() -> Self {
        Self {
            budget_us: 333,
            growth_percent: 300,
            settle_ticks: 500,
        }
    }
}

impl Budget {
    /// Checks the ranges of all fields for a tick rate, 1/s. A budget of nine tenths of a tick is the largest.
    ///
    /// # Errors
    /// The first field out of range: its name, the value found, the range expected.
    pub fn validate(&self, rate_hz: u16) -> Result<(), (&'static str, String, &'static str)> {
        let most_us = 900_000 / u32::from(rate_hz.max(1));
        let fields = [
            (
                "detail budget",
                self.budget_us,
                10..=most_us,
                "10 us to nine tenths of a tick: 900 us at 1 kHz, 112 us at 8 kHz",
            ),
            (
                "detail growth",
                self.growth_percent,
                100..=2000,
                "100 to 2000 %",
            ),
            (
                "detail settle time",
                self.settle_ticks,
                10..=60_000,
                "10 to 60000 ticks",
            ),
        ];
        for (field, found, range, expected) in fields {
            if !range.contains(&found) {
                return Err((field, found.to_string(), expected));
            }
        }
        Ok(())
    }
}

/// Time constant of the moving mean, ticks: each tick moves the mean by a sixteenth of the difference. A cache miss or
/// a page fault alone then changes no level.
const MEMORY_TICKS: u64 = 16;
/// Largest number of doublings of the wait.
const MOST_DOUBLINGS: u32 = 6;
/// Duration of the fine level, in waits of the present length, after which the next wait is the shortest again.
///
/// Only the fine level counts, and only in a tick whose mean is within the budget. The wait is the doubled one: after
/// six falls, 8 times 64 times [`Budget::settle_ticks`].
const PROVED_WAITS: u32 = 8;

/// Chooses the level of the next tick. The choice is a pure function of the durations of the previous ticks.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Chooser {
    detail: Detail,
    level: u8,
    /// Moving mean of the CPU time, nanoseconds, times [`MEMORY_TICKS`].
    mean: u64,
    /// Number of consecutive ticks with time left for the finer level.
    quiet: u32,
    /// Number of ticks at the present level.
    stood: u32,
    /// Number of doublings of the wait, 0 to [`MOST_DOUBLINGS`].
    doublings: u32,
}

impl Chooser {
    pub fn new(detail: Detail) -> Self {
        let level = match detail {
            Detail::Fixed(level) => level.min(TickInput::MAX_DETAIL),
            Detail::ByTime(_) => 0,
        };
        Self {
            detail,
            level,
            mean: 0,
            quiet: 0,
            stood: 0,
            doublings: 0,
        }
    }

    /// Level for the next tick.
    pub fn level(&self) -> u8 {
        self.level
    }

    /// Takes the CPU time of the tick that has just run, nanoseconds. A fixed level ignores it.
    pub fn took(&mut self, cpu_ns: u64) {
        let Detail::ByTime(budget) = self.detail else {
            return;
        };
        // A limit of one second prevents an overflow of the products.
        let cpu_ns = cpu_ns.min(1_000_000_000);
        self.mean = self.mean - self.mean / MEMORY_TICKS + cpu_ns;
        let mean_ns = self.mean / MEMORY_TICKS;
        let budget_ns = u64::from(budget.budget_us) * 1000;
        self.stood = self.stood.saturating_add(1);
        let wait = budget.settle_ticks.saturating_mul(1 << self.doublings);
        if mean_ns > budget_ns {
            self.quiet = 0;
            if self.level > 0 {
                self.switch(self.level - 1);
                self.doublings = (self.doublings + 1).min(MOST_DOUBLINGS);
            }
            return;
        }
        if self.level > 0 && self.stood >= wait.saturating_mul(PROVED_WAITS) {
            self.doublings = 0;
        }
        if mean_ns * u64::from(budget.growth_percent) > budget_ns * 100 {
            self.quiet = 0;
            return;
        }
        self.quiet = self.quiet.saturating_add(1);
        if self.level < TickInput::MAX_DETAIL && self.quiet >= wait {
            self.switch(self.level + 1);
        }
    }

    fn switch(&mut self, level: u8) {
        (self.level, self.quiet, self.stood) = (level, 0, 0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn by_time() -> Chooser {
        Chooser::new(Detail::ByTime(Budget::default()))
    }

    /// Runs `ticks` ticks, of which tick `k` costs `cost(k, level)` nanoseconds. Returns the number of switches.
    fn run(chooser: &mut Chooser, ticks: u32, cost: impl Fn(u32, u8) -> u64) -> u32 {
        let mut switches = 0;
        for k in 0..ticks {
            let before = chooser.level();
            chooser.took(cost(k, before));
            switches += u32::from(chooser.level() != before);
        }
        switches
    }

    #[test]
    fn a_fixed_level_stays_whatever_ticks_cost() {
        for level in [0, 1] {
            let mut chooser = Chooser::new(Detail::Fixed(level));
            let switches = run(&mut chooser, 20_000, |k, _| u64::from(k % 7) * 300_000);
            assert_eq!((switches, chooser.level()), (0, level));
        }
        assert_eq!(
            Chooser::new(Detail::Fixed(9)).level(),
            TickInput::MAX_DETAIL
        );
    }

    #[test]
    fn it_rises_once_when_there_is_time_and_only_after_the_wait() {
        let mut chooser = by_time();
        let cost = |_, level| if level == 0 { 50_000 } else { 150_000 };
        assert_eq!(run(&mut chooser, 499, cost), 0);
        assert_eq!(run(&mut chooser, 60_000, cost), 1);
        assert_eq!(chooser.level(), 1);
    }

    #[test]
    fn it_falls_within_a_few_ticks_of_work_that_does_not_fit() {
        let mut chooser = by_time();
        run(&mut chooser, 1000, |_, _| 50_000);
        assert_eq!(chooser.level(), 1);
        assert_eq!(run(&mut chooser, 32, |_, _| 600_000), 1);
        assert_eq!(chooser.level(), 0);
    }

    #[test]
    fn one_late_tick_in_a_hundred_is_no_trend() {
        let mut chooser = by_time();
        let cost = |k: u32, _| if k % 100 == 99 { 2_000_000 } else { 40_000 };
        // One tick of 2 ms in a hundred gives an average of 60 us, but just after it the moving mean exceeds 100 us.
        let switches = run(&mut chooser, 60_000, cost);
        assert!(switches <= 1, "{switches} switches");
    }

    #[test]
    fn a_finer_level_that_never_fits_is_tried_ever_more_rarely() {
        let mut chooser = by_time();
        let cost = |_, level| if level == 0 { 50_000 } else { 800_000 };
        // Ten minutes with waits of 0.5, 1, 2, ... 32 s. Each attempt is one rise and one fall.
        let early = run(&mut chooser, 30_000, cost);
        let late = run(&mut chooser, 570_000, cost);
        assert!((8..=12).contains(&early), "{early} switches in 30 s");
        assert!(late <= 2 * 570 / 32 + 2, "{late} switches in 570 s");
    }

    #[test]
    fn the_choice_is_a_function_of_the_durations() {
        let trace = |mut chooser: Chooser| -> Vec<u8> {
            (0..5000_u64)
                .map(|k| {
                    chooser.took(k * 7919 % 500_000);
                    chooser.level()
                })
                .collect()
        };
        assert_eq!(trace(by_time()), trace(by_time()));
    }

    #[test]
    fn ranges_are_said() {
        assert_eq!(Budget::default().validate(1000), Ok(()));
        let wrong = Budget {
            budget_us: 5000,
            ..Budget::default()
        };
        assert_eq!(
            wrong.validate(1000),
            Err((
                "detail budget",
                "5000".into(),
                "10 us to nine tenths of a tick: 900 us at 1 kHz, 112 us at 8 kHz"
            ))
        );
    }
}
