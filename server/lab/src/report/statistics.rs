//! What several runs of the same say together.

use std::fmt;

/// 97.5 % points of Student's distribution for 1 to 20 degrees of freedom.
const STUDENT: [f64; 20] = [
    12.706, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306, 2.262, 2.228, 2.201, 2.179, 2.160,
    2.145, 2.131, 2.120, 2.110, 2.101, 2.093, 2.086,
];

/// A mean with its 95 % confidence interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Interval {
    pub(crate) mean: f64,
    /// Half of the interval's length.
    pub(crate) half: f64,
}

impl Interval {
    /// Of independent runs, by Student's distribution. Infinitely wide for fewer than two.
    pub(crate) fn of(runs: &[f64]) -> Self {
        let n = runs.len() as f64;
        let mean = runs.iter().sum::<f64>() / n.max(1.0);
        let Some(freedom) = runs.len().checked_sub(1).filter(|freedom| *freedom > 0) else {
            return Self {
                mean,
                half: f64::INFINITY,
            };
        };
        let variance = runs.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>() / freedom as f64;
        // (Beyond the table its last entry is a little too wide: on the safe side.)
        let student = STUDENT[freedom.min(STUDENT.len()) - 1];
        Self {
            mean,
            half: student * (variance / n).sqrt(),
        }
    }

    pub(crate) fn low(&self) -> f64 {
        self.mean - self.half
    }

    pub(crate) fn high(&self) -> f64 {
        self.mean + self.half
    }
}

impl fmt::Display for Interval {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let digits = f.precision().unwrap_or(4);
        write!(
            f,
            "{:.digits$} ({:.digits$} to {:.digits$})",
            self.mean,
            self.low(),
            self.high()
        )
    }
}

/// Middle one of some numbers; 0 of none.
pub(crate) fn median(mut numbers: Vec<f64>) -> f64 {
    numbers.sort_by(f64::total_cmp);
    numbers.get(numbers.len() / 2).copied().unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_interval_is_that_of_student() {
        // Mean 3, standard deviation sqrt(2.5), 4 degrees of freedom.
        let found = Interval::of(&[1.0, 2.0, 3.0, 4.0, 5.0]);
        assert!((found.mean - 3.0).abs() < 1e-12);
        assert!((found.half - 2.776 * (2.5_f64 / 5.0).sqrt()).abs() < 1e-9);
        assert_eq!(format!("{found:.1}"), "3.0 (1.0 to 5.0)");
        assert_eq!(Interval::of(&[2.0]).half, f64::INFINITY);
        assert_eq!(median(vec![3.0, 1.0, 2.0]), 2.0);
    }
}
