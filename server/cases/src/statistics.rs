//! Statistics of samples: percentiles, and means with their confidence intervals.

use std::fmt;

pub use sulcus_proto::Percentiles;

/// 97.5 % points of Student's distribution for 1 to 20 degrees of freedom.
const STUDENT: [f64; 20] = [
    12.706, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306, 2.262, 2.228, 2.201, 2.179, 2.160,
    2.145, 2.131, 2.120, 2.110, 2.101, 2.093, 2.086,
];

/// Returns the sample below which `share` of the sorted samples lie: the one of rank `share * (n - 1)`, rounded down.
///
/// `share` is 0 to 1. `None` without samples.
pub fn percentile<T: Copy>(sorted: &[T], share: f64) -> Option<T> {
    let last = sorted.len().checked_sub(1)?;
    sorted.get((last as f64 * share) as usize).copied()
}

/// Returns percentiles, microseconds, of times in nanoseconds in any order; all zero without times.
pub fn percentiles_us(times_ns: impl IntoIterator<Item = u64>) -> Percentiles {
    let mut times: Vec<u64> = times_ns.into_iter().collect();
    times.sort_unstable();
    let at = |share: f64| percentile(&times, share).map_or(0.0, |ns| ns as f64 * 1e-3);
    Percentiles {
        p50: at(0.5),
        p99: at(0.99),
        p999: at(0.999),
        max: at(1.0),
    }
}

/// Returns the median, the lower middle of an even number of samples; 0 without samples.
pub fn median(mut samples: Vec<f64>) -> f64 {
    samples.sort_by(f64::total_cmp);
    percentile(&samples, 0.5).unwrap_or(0.0)
}

/// Mean with its 95 % confidence interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// Mean.
    pub mean: f64,
    /// Half of the interval's length.
    pub half: f64,
}

impl Interval {
    /// Creates the interval of independent runs, by Student's distribution. The interval of one run is infinite.
    pub fn of(runs: &[f64]) -> Self {
        let n = runs.len() as f64;
        let mean = runs.iter().sum::<f64>() / n.max(1.0);
        let Some(freedom) = runs.len().checked_sub(1).filter(|freedom| *freedom > 0) else {
            return Self {
                mean,
                half: f64::INFINITY,
            };
        };
        let variance = runs.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>() / freedom as f64;
        // Beyond the table, its last entry gives an interval that is slightly too wide.
        let student = STUDENT[freedom.min(STUDENT.len()) - 1];
        Self {
            mean,
            half: student * (variance / n).sqrt(),
        }
    }
}

impl fmt::Display for Interval {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let digits = f.precision().unwrap_or(4);
        write!(
            f,
            "{:.digits$} ({:.digits$} to {:.digits$})",
            self.mean,
            self.mean - self.half,
            self.mean + self.half
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn percentiles_are_those_of_the_sorted_times() {
        let all = percentiles_us((0..=1000).rev().map(|k| k * 1000));
        assert_eq!(
            all,
            Percentiles {
                p50: 500.0,
                p99: 990.0,
                p999: 999.0,
                max: 1000.0
            }
        );
        assert_eq!(percentiles_us([]), Percentiles::default());
        assert_eq!(percentile::<u8>(&[], 0.5), None);
        assert_eq!(median(vec![3.0, 1.0, 2.0]), 2.0);
        assert_eq!(median(vec![4.0, 3.0, 1.0, 2.0]), 2.0);
        assert_eq!(median(Vec::new()), 0.0);
    }

    #[test]
    fn the_interval_is_that_of_student() {
        // Mean 3, standard deviation sqrt(2.5), 4 degrees of freedom.
        let found = Interval::of(&[1.0, 2.0, 3.0, 4.0, 5.0]);
        assert!((found.mean - 3.0).abs() < 1e-12);
        assert!((found.half - 2.776 * (2.5_f64 / 5.0).sqrt()).abs() < 1e-9);
        assert_eq!(format!("{found:.1}"), "3.0 (1.0 to 5.0)");
        assert_eq!(Interval::of(&[2.0]).half, f64::INFINITY);
    }
}
