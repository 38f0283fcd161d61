//! Times of the frames of a window.

/// Number of the newest frames that are kept: five minutes at 60 Hz.
const KEPT: usize = 18_000;

/// Times of frames, seconds.
#[derive(Clone, Debug, Default)]
pub struct FrameTimes {
    /// Frames drawn.
    pub frames: u64,
    ages: Vec<f32>,
    costs: Vec<f32>,
}

/// Percentiles of a time, milliseconds.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Milliseconds {
    /// Median.
    pub p50: f64,
    /// Percentile 99.
    pub p99: f64,
    /// Largest value.
    pub max: f64,
}

impl FrameTimes {
    /// Takes a frame: age of its content when it was shown, and the time that drawing took, seconds.
    pub fn frame(&mut self, age_s: f64, cost_s: f64) {
        let at = (self.frames % KEPT as u64) as usize;
        for (kept, value) in [(&mut self.ages, age_s), (&mut self.costs, cost_s)] {
            let value = value as f32;
            match kept.get_mut(at) {
                Some(old) => *old = value,
                None => kept.push(value),
            }
        }
        self.frames += 1;
    }

    /// Age of the content at the time of its frame, over the newest frames.
    pub fn age(&self) -> Milliseconds {
        percentiles(&self.ages)
    }

    /// Time of drawing, over the newest frames.
    pub fn cost(&self) -> Milliseconds {
        percentiles(&self.costs)
    }
}

fn percentiles(seconds: &[f32]) -> Milliseconds {
    let mut sorted = seconds.to_vec();
    sorted.sort_by(f32::total_cmp);
    let at = |share: f64| {
        let last = sorted.len().saturating_sub(1);
        let place = (share * last as f64).round() as usize;
        sorted.get(place).map_or(0.0, |s| f64::from(*s) * 1e3)
    };
    Milliseconds {
        p50: at(0.5),
        p99: at(0.99),
        max: at(1.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn percentiles_are_those_of_the_newest_frames() {
        let mut times = FrameTimes::default();
        assert_eq!(times.age(), Milliseconds::default());
        (0..KEPT).for_each(|_| times.frame(9.0, 9.0));
        for k in 0..=KEPT {
            times.frame(k as f64 * 1e-3, 0.002);
        }
        assert_eq!(times.frames, 2 * KEPT as u64 + 1);
        let Milliseconds { p50, p99, max } = times.age();
        assert!(
            (p50 - 9000.0).abs() < 2.0 && (p99 - 17_820.0).abs() < 3.0,
            "{p50} {p99}"
        );
        assert!((max - 18_000.0).abs() < 0.1, "{max}");
        assert!((times.cost().max - 2.0).abs() < 1e-3);
    }
}
