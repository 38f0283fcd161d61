//! State of the tip, from the samples of the door.

use sulcus_core::Vec3;
use sulcus_core::math::norm;
use sulcus_haptics::{Sample, Stage};

/// Time constant of the speed, seconds: a step of an encoder in one period is no motion.
const SPEED_TIME_S: f64 = 6e-3;

/// Tip as the loop sees it.
#[derive(Clone, Debug)]
pub(super) struct Tip {
    /// Time of the newest measurement, nanoseconds.
    pub at_ns: u64,
    /// Number of the newest period of the device.
    pub sequence: u32,
    /// Number of periods since the sample before; 0 for the same sample again.
    pub periods: u32,
    /// Time since the sample before, seconds; 0 for the same sample again.
    pub seconds: f64,
    /// Position, base axes, metres.
    pub position: Vec3,
    /// Speed, smoothed, m/s.
    pub velocity: Vec3,
    /// Displayed force, base axes, newtons.
    pub displayed: Vec3,
    /// Position at which the tip came to rest, metres.
    pub rest: Vec3,
    /// Number of new samples since then.
    pub still: u32,
    /// Largest distance from [`Tip::rest`] along an axis that counts as rest, metres.
    pub threshold: f64,
    started: bool,
}

impl Tip {
    /// Creates a tip before its first sample.
    pub fn new(threshold: f64) -> Self {
        let zero = Vec3::zeros();
        Self {
            at_ns: 0,
            sequence: 0,
            periods: 0,
            seconds: 0.0,
            position: zero,
            velocity: zero,
            displayed: zero,
            rest: zero,
            still: 0,
            threshold,
            started: false,
        }
    }

    /// Accounts for a sample.
    pub fn see(&mut self, sample: &Sample) {
        let position = Vec3::from(sample.pose.position.map(f64::from));
        self.displayed = sample.displayed.force;
        if !self.started {
            self.started = true;
            (self.position, self.rest) = (position, position);
            (self.at_ns, self.sequence) = (sample.at_ns, sample.sequence);
        }
        self.periods = sample.sequence.wrapping_sub(self.sequence);
        self.seconds = sample.at_ns.saturating_sub(self.at_ns) as f64 * 1e-9;
        if self.periods == 0 || self.seconds <= 0.0 {
            (self.periods, self.seconds) = (0, 0.0);
            return;
        }
        let share = self.seconds / (self.seconds + SPEED_TIME_S);
        self.velocity += ((position - self.position) / self.seconds - self.velocity) * share;
        (self.at_ns, self.sequence, self.position) = (sample.at_ns, sample.sequence, position);
        if (position - self.rest).amax() <= self.threshold {
            self.still += 1;
        } else {
            (self.rest, self.still) = (position, 0);
        }
    }

    /// Whether the sample is new.
    pub fn is_new(&self) -> bool {
        self.periods > 0
    }

    /// Whether the tip has been at rest for `samples` new samples.
    pub fn is_still(&self, samples: u32) -> bool {
        self.still >= samples
    }
}

/// Reason why `sample` of `now_ns` ends a stage; `None` for a live hand.
pub(super) fn unfit(sample: &Sample, now_ns: u64) -> Option<String> {
    /// Age from which the thread of a device counts as stopped, nanoseconds.
    const SILENT_NS: u64 = 50_000_000;
    if now_ns.saturating_sub(sample.at_ns) > SILENT_NS {
        return Some("the thread of the device gives no samples".into());
    }
    match sample.stage {
        Stage::Live if sample.present => None,
        stage => Some(stage.to_string()),
    }
}

/// Returns `force` with its length clamped to `most`, and zero for a force that is not finite.
pub(super) fn bounded(force: Vec3, most: f64) -> Vec3 {
    let length = norm(&force);
    if !length.is_finite() {
        Vec3::zeros()
    } else if length > most {
        force * (most / length)
    } else {
        force
    }
}
