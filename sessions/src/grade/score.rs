//! Points: score of a metric, linear from 0 at `zero` to 100 at `target`; weighted total; critical errors.

use super::rubric::{Bound, Critical, Weighed};

/// Score of a value, 0 to 100.
pub fn score(value: f64, weighed: &Weighed) -> f64 {
    let part = match (weighed.target, weighed.zero) {
        (Bound::One(target), Bound::One(zero)) => (value - zero) / (target - zero),
        (Bound::Band([a, b]), Bound::Band([c, d])) => {
            if value < a {
                (value - c) / (a - c)
            } else if value > b {
                (d - value) / (d - b)
            } else {
                1.0
            }
        }
        // The reader of rubrics refuses a number with a band.
        _ => 0.0,
    };
    // A NaN scores 0.
    if part >= 1.0 {
        100.0
    } else if part > 0.0 {
        100.0 * part
    } else {
        0.0
    }
}

/// Weighted mean of scores, given as weight and score. None if the sum of the weights is 0.
pub fn total(scores: &[(f64, f64)]) -> Option<f64> {
    let weight: f64 = scores.iter().map(|(weight, _)| weight).sum();
    let sum: f64 = scores.iter().map(|(weight, score)| weight * score).sum();
    (weight > 0.0).then(|| sum / weight)
}

/// Whether a critical error occurred. A missing value of a metric that counts it as 0 is below any `below`.
pub fn happened(critical: &Critical, value: Option<f64>, missing_is_zero: bool) -> bool {
    let Some(value) = value else {
        return missing_is_zero && critical.below.is_some();
    };
    critical.above.is_some_and(|above| value > above)
        || critical.below.is_some_and(|below| value < below)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn weighed(target: Bound, zero: Bound) -> Weighed {
        Weighed {
            name: "time".into(),
            weight: 1.0,
            target,
            zero,
            pass: None,
            deduct: None,
            unit: None,
            definition: None,
            source: None,
        }
    }

    #[test]
    fn a_score_is_linear_between_zero_and_target() {
        let more = weighed(Bound::One(90.0), Bound::One(50.0));
        for (value, is) in [
            (0.0, 0.0),
            (50.0, 0.0),
            (60.0, 25.0),
            (90.0, 100.0),
            (100.0, 100.0),
        ] {
            assert_eq!(score(value, &more), is, "{value}");
        }
        let less = weighed(Bound::One(10.0), Bound::One(50.0));
        for (value, is) in [
            (0.0, 100.0),
            (10.0, 100.0),
            (20.0, 75.0),
            (50.0, 0.0),
            (99.0, 0.0),
        ] {
            assert_eq!(score(value, &less), is, "{value}");
        }
        let band = weighed(Bound::Band([-0.5, 0.5]), Bound::Band([-1.5, 2.5]));
        for (value, is) in [
            (-2.0, 0.0),
            (-1.0, 50.0),
            (0.0, 100.0),
            (0.5, 100.0),
            (1.0, 75.0),
            (3.0, 0.0),
        ] {
            assert_eq!(score(value, &band), is, "{value}");
        }
        assert_eq!(score(f64::NAN, &more), 0.0);
    }

    #[test]
    fn weights_share_out_the_total_and_critical_errors_are_found() {
        assert_eq!(total(&[(3.0, 100.0), (1.0, 0.0)]), Some(75.0));
        assert_eq!(total(&[(0.0, 100.0)]), None);
        let critical = |above, below| Critical {
            metric: "damage_events".into(),
            above,
            below,
            cap: None,
            why: "damage".into(),
        };
        assert!(happened(&critical(Some(0.0), None), Some(1.0), false));
        assert!(!happened(&critical(Some(0.0), None), Some(0.0), true));
        assert!(happened(&critical(None, Some(50.0)), Some(40.0), false));
        assert!(!happened(&critical(None, Some(50.0)), None, false));
        // A session without probing did not reach half of the floors.
        assert!(happened(&critical(None, Some(50.0)), None, true));
        assert!(!happened(&critical(Some(0.0), None), None, true));
    }
}
