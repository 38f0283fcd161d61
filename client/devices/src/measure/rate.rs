//! Rate, jitter and noise of a held handle.

use sulcus_core::Vec3;

use super::holder::Holder;
use super::report::{Measured, Outcome, RateFigures, quantile};
use super::task::{Next, Task};
use super::tip::Tip;

/// Number of intervals.
const INTERVALS: usize = 3000;
/// Number of samples before the first interval: the handle comes to rest.
const SETTLING: usize = 1500;

/// Stage of rate and noise.
pub(super) struct Rate {
    holder: Holder,
    samples: usize,
    /// Time and number of periods of each interval.
    intervals: Vec<(f64, u32)>,
    low: Vec3,
    high: Vec3,
}

impl Rate {
    /// Creates the stage.
    pub fn new(holder: Holder) -> Self {
        Self {
            holder,
            samples: 0,
            intervals: Vec::with_capacity(INTERVALS),
            low: Vec3::repeat(f64::INFINITY),
            high: Vec3::repeat(f64::NEG_INFINITY),
        }
    }

    fn figures(&self) -> Option<RateFigures> {
        let time: f64 = self.intervals.iter().map(|(seconds, _)| seconds).sum();
        let periods: f64 = self
            .intervals
            .iter()
            .map(|&(_, periods)| f64::from(periods))
            .sum();
        let nominal = time / periods;
        let single: Vec<f64> = self
            .intervals
            .iter()
            .map(|&(seconds, periods)| (seconds - f64::from(periods - 1) * nominal) * 1e6)
            .collect();
        Some(RateFigures {
            rate_hz: periods / time,
            interval_p50_us: quantile(&single, 0.5)?,
            interval_p99_us: quantile(&single, 0.99)?,
            interval_most_us: quantile(&single, 1.0)?,
            count: single.len(),
            noise_mm: (self.high - self.low).max() * 1e3,
        })
    }
}

impl Task for Rate {
    fn step(&mut self, tip: &Tip) -> Next {
        self.samples += 1;
        if self.holder.is_lost(tip) {
            return Next::Fail(Holder::LOST.into());
        }
        if self.samples > SETTLING {
            self.intervals.push((tip.seconds, tip.periods));
            self.low = self.low.inf(&tip.position);
            self.high = self.high.sup(&tip.position);
        }
        if self.intervals.len() >= INTERVALS {
            return Next::Done;
        }
        Next::Force(self.holder.force(tip))
    }

    fn share(&self) -> f64 {
        self.samples as f64 / (SETTLING + INTERVALS) as f64
    }

    fn finish(self: Box<Self>, report: &mut Measured) {
        report.rate = match self.figures() {
            Some(figures) => Outcome::Measured(figures),
            None => Outcome::NotMeasured("no intervals".into()),
        };
    }
}
