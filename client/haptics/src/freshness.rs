//! Share of the force by the age of the newest wrench: whole while wrenches arrive, zero at a fixed age.
//!
//! The watchdog of [`crate::Watchdog`] falls by steps of the loop. The share of this module depends on the age alone,
//! so that a late call of the device's thread cannot prolong the fall.

use std::time::Duration;

/// Ages of the newest wrench at which the force falls.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Silence {
    /// Age up to which the whole force is displayed.
    pub hold: Duration,
    /// Age from which the force is zero, above `hold`.
    pub zero: Duration,
}

impl Silence {
    /// Ages for a device with a thread of its own. The displayed force is zero at an age of 20 ms: the fall ends 2 ms
    /// earlier, which is one period of the slowest device, of 500 Hz.
    pub const DEVICE: Self = Self {
        hold: Duration::from_millis(5),
        zero: Duration::from_millis(18),
    };

    /// Duration of the fall.
    pub fn fall(&self) -> Duration {
        self.zero.saturating_sub(self.hold)
    }
}

/// Time in which a share that fell rises from zero to one.
const RISE: Duration = Duration::from_millis(100);
/// Longest step of the rise: a late call of the device's thread does not hasten the rise.
const LONGEST_STEP: Duration = Duration::from_millis(2);

/// Share of the force, from the age of the newest wrench.
#[derive(Clone, Debug, PartialEq)]
pub struct Freshness {
    silence: Silence,
    /// Period of the device.
    period: Duration,
    share: f64,
    /// Newest time of a call: the base of the rise.
    stepped_ns: Option<u64>,
    /// Time of the last call: the base of the age.
    called_ns: Option<u64>,
    heard_ns: Option<u64>,
    /// Age of the newest wrench at the last call.
    age: Duration,
}

impl Freshness {
    /// Creates the share 0 without a wrench, for a device of `period`.
    pub fn new(silence: Silence, period: Duration) -> Self {
        Self {
            silence,
            period,
            share: 0.0,
            stepped_ns: None,
            called_ns: None,
            heard_ns: None,
            age: Duration::ZERO,
        }
    }

    /// Returns the share at `now_ns`, 0 to 1, for a newest wrench of `heard_ns`. `None`: no wrench so far, share 0.
    pub fn share(&mut self, heard_ns: Option<u64>, now_ns: u64) -> f64 {
        let step_ns = self
            .stepped_ns
            .map_or(0, |last| now_ns.saturating_sub(last));
        self.stepped_ns = self.stepped_ns.max(Some(now_ns));
        let step = Duration::from_nanos(step_ns).min(LONGEST_STEP);
        let risen = self.share + step.as_secs_f64() / RISE.as_secs_f64();
        self.age = self.age_at(heard_ns, now_ns);
        (self.called_ns, self.heard_ns) = (Some(now_ns), heard_ns);
        self.share = risen.min(self.most());
        self.share
    }

    /// Whether no wrench of `heard_ns` may be displayed at `now_ns`: there is none, or its age is that of the zero.
    pub fn is_silent(&self, heard_ns: Option<u64>, now_ns: u64) -> bool {
        heard_ns.is_none() || self.age_at(heard_ns, now_ns) >= self.silence.zero
    }

    /// Age at `now_ns` of the newest wrench, of `heard_ns`. The age grows by the steps of the clock from call to call.
    /// A clock that stands or steps back makes no wrench younger: such a call counts as one period.
    fn age_at(&self, heard_ns: Option<u64>, now_ns: u64) -> Duration {
        match (heard_ns, self.called_ns) {
            (Some(heard_ns), _) if self.heard_ns != Some(heard_ns) => {
                Duration::from_nanos(now_ns.saturating_sub(heard_ns))
            }
            (_, Some(called_ns)) if now_ns > called_ns => self
                .age
                .saturating_add(Duration::from_nanos(now_ns - called_ns)),
            _ => self.age.saturating_add(self.period),
        }
    }

    /// Largest share at the age of the newest wrench.
    fn most(&self) -> f64 {
        if self.heard_ns.is_none() {
            return 0.0;
        }
        let age = self.age;
        let fallen = age.saturating_sub(self.silence.hold).as_secs_f64();
        let fall = self.silence.fall().as_secs_f64();
        if age >= self.silence.zero {
            0.0
        } else {
            (1.0 - fallen / fall).clamp(0.0, 1.0)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MS: u64 = 1_000_000;

    fn open() -> Freshness {
        let mut freshness = Freshness::new(Silence::DEVICE, Duration::from_millis(1));
        for ms in 0..200 {
            freshness.share(Some(ms * MS), ms * MS);
        }
        assert_eq!(freshness.share(Some(200 * MS), 200 * MS), 1.0);
        freshness
    }

    #[test]
    fn the_share_holds_for_five_milliseconds_and_is_zero_at_eighteen() {
        let mut freshness = open();
        let shares: Vec<f64> = (201..=220)
            .map(|ms| freshness.share(Some(200 * MS), ms * MS))
            .collect();
        assert!(shares[..5].iter().all(|&share| share == 1.0), "{shares:?}");
        assert!(shares[5] < 1.0 && shares[16] > 0.0, "{shares:?}");
        assert!(shares[17..].iter().all(|&share| share == 0.0), "{shares:?}");
    }

    #[test]
    fn a_device_thread_that_was_held_up_finds_the_share_at_zero() {
        assert_eq!(open().share(Some(200 * MS), 260 * MS), 0.0);
    }

    #[test]
    fn a_share_that_fell_rises_slowly() {
        let mut freshness = open();
        let low = freshness.share(Some(200 * MS), 212 * MS);
        let next = freshness.share(Some(213 * MS), 213 * MS);
        assert!(
            low < 0.5 && next > low && next - low < 0.0101,
            "{low} {next}"
        );
        // A late call rises by two milliseconds at most.
        let late = freshness.share(Some(290 * MS), 290 * MS);
        assert!(late - next < 0.0201, "{next} {late}");
    }

    #[test]
    fn a_share_without_a_wrench_is_zero() {
        let mut freshness = Freshness::new(Silence::DEVICE, Duration::from_millis(1));
        assert!((0..100).all(|ms| freshness.share(None, ms * MS) == 0.0));
    }
}
