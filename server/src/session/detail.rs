//! The time-critical choice of level (the paper's section 3.1): tissue is simulated at its coarse level, and at
//! the finer one while ticks leave time for it. Decided here, from the CPU time of the ticks before; recorded,
//! because it enters the tick as [`sulcus_core::TickInput::detail`], so a replay needs no clock.
//!
//! A switch of level steps the force a little, so the choice is slow to rise, quick to fall, and does not
//! go to and fro: each fall doubles the wait for the next rise.

use sulcus_core::TickInput;

/// Which level of detail tissue is simulated at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Detail {
    /// The same throughout: what a graded session needs, since all students must feel the same.
    Fixed(u8),
    /// As fine as the time allows.
    ByTime(Budget),
}

impl Default for Detail {
    fn default() -> Self {
        Detail::Fixed(0)
    }
}

/// What the choice by time goes by.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Budget {
    /// CPU time that a tick may take on average, microseconds. Over it the level falls. Range 10 to 900 (a
    /// tick has 1,000, and the hand's share of them is the network's). Larger: finer for longer, and less room
    /// for what is rare.
    pub budget_us: u32,
    /// How many times longer a tick is expected to take one level finer, per cent. The level rises while this
    /// much more is still within the budget. Range 100 to 2000. Larger: rises less often in vain.
    pub growth_percent: u32,
    /// Ticks that must leave time before the level rises, after the first fall twice as many, and so on up to
    /// 64 times. Range 10 to 60,000.
    pub settle_ticks: u32,
}

impl Default for Budget {
    /// A third of a tick; a finer level about three times as dear (8 times as many spheres in the skeleton, but
    /// the collision is the same); half a second.
    fn default() -> Self {
        Self {
            budget_us: 333,
            growth_percent: 300,
            settle_ticks: 500,
        }
    }
}

impl Budget {
    /// Checks the ranges.
    ///
    /// # Errors
    /// Field, value found, range expected.
    pub fn validate(&self) -> Result<(), (&'static str, String, &'static str)> {
        let fields = [
            ("detail budget", self.budget_us, 10..=900, "10 to 900 us"),
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

/// The mean follows this share of the way per tick: about 16 ticks of memory, so that neither a cache miss nor
/// a page fault counts as a trend.
const MEMORY_TICKS: u64 = 16;
/// Doublings of the wait at most.
const MOST_DOUBLINGS: u32 = 6;
/// A level that stood for so many waits has proved itself: the wait is back at its shortest.
const PROVED_WAITS: u32 = 8;

/// Chooses the level of the next tick from the durations of those before: a pure function of them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Chooser {
    detail: Detail,
    level: u8,
    /// Mean CPU time, nanoseconds, times [`MEMORY_TICKS`].
    mean: u64,
    /// Ticks that left time since the last that did not.
    quiet: u32,
    /// Ticks at the present level.
    stood: u32,
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

    /// The level for the next tick.
    pub fn level(&self) -> u8 {
        self.level
    }

    /// Takes in the CPU time of the tick that has just run.
    pub fn took(&mut self, cpu_ns: u64) {
        let Detail::ByTime(budget) = self.detail else {
            return;
        };
        // A second is as bad as it gets, and leaves room to multiply.
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

    /// Runs `ticks` in which a tick costs `cost(level)` nanoseconds; returns the switches.
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
        // 2 ms now and then is an average of 60 us, but just after it the mean is over 100.
        let switches = run(&mut chooser, 60_000, cost);
        assert!(switches <= 1, "{switches} switches");
    }

    #[test]
    fn a_finer_level_that_never_fits_is_tried_ever_more_rarely() {
        let mut chooser = by_time();
        let cost = |_, level| if level == 0 { 50_000 } else { 800_000 };
        // Ten minutes. Waits of 0.5, 1, 2, ... 32 s: each try is one rise and one fall.
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
        assert_eq!(Budget::default().validate(), Ok(()));
        let wrong = Budget {
            budget_us: 5000,
            ..Budget::default()
        };
        assert_eq!(
            wrong.validate(),
            Err(("detail budget", "5000".into(), "10 to 900 us"))
        );
    }
}
