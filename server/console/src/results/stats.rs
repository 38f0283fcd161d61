//! Statistics of readings: agreement, weighted kappa.

/// Largest probing depth that is told apart, mm; deeper ones count as this one.
const DEEPEST: usize = 15;
/// Tolerance of the comparison of prescribed depths with whole millimetres, mm.
const TIE: f64 = 1e-9;

/// Agreement of two raters of the same sites, or of a rater with the prescribed depths.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Agreement {
    /// Number of readings.
    pub readings: usize,
    /// Share of equal readings, 0 to 1. Against prescribed depths: at most 0.5 mm apart.
    pub exact: f64,
    /// Share of readings at most 1 mm apart, 0 to 1.
    pub within_1mm: f64,
    /// Mean of the second minus the first, mm: its sign tells who reads deeper.
    pub bias_mm: f64,
    /// Cohen's kappa with linear weights over whole millimetres; `None` where both raters gave one and the same value
    /// everywhere, because kappa is not defined there.
    pub kappa: Option<f64>,
}

/// Agreement of pairs of depths in mm: first rater or prescribed depth, second rater or called depth. `None` without a
/// pair.
pub fn agreement(pairs: &[(f64, f64)]) -> Option<Agreement> {
    let readings = pairs.len();
    if readings == 0 {
        return None;
    }
    let share = |within: f64| {
        let close = pairs
            .iter()
            .filter(|(first, second)| (second - first).abs() <= within + TIE);
        close.count() as f64 / readings as f64
    };
    let sum: f64 = pairs.iter().map(|(first, second)| second - first).sum();
    Some(Agreement {
        readings,
        exact: share(0.5),
        within_1mm: share(1.0),
        bias_mm: sum / readings as f64,
        kappa: weighted_kappa(pairs),
    })
}

/// Cohen's kappa with linear weights: 1 minus the mean distance over the distance expected by chance (Cohen 1968, doi
/// 10.1037/h0026256). Depths are rounded to whole millimetres.
fn weighted_kappa(pairs: &[(f64, f64)]) -> Option<f64> {
    let whole = |depth: f64| (depth.round().max(0.0) as usize).min(DEEPEST);
    let (mut first, mut second) = ([0.0; DEEPEST + 1], [0.0; DEEPEST + 1]);
    let mut observed = 0.0;
    for (a, b) in pairs {
        let (a, b) = (whole(*a), whole(*b));
        first[a] += 1.0;
        second[b] += 1.0;
        observed += a.abs_diff(b) as f64;
    }
    let count = pairs.len() as f64;
    let mut expected = 0.0;
    for (a, of_first) in first.iter().enumerate() {
        for (b, of_second) in second.iter().enumerate() {
            expected += of_first * of_second * a.abs_diff(b) as f64 / count;
        }
    }
    (expected > 0.0).then(|| 1.0 - observed / expected)
}

impl Agreement {
    /// Words for the kappa (Landis and Koch 1977, doi 10.2307/2529310).
    pub fn kappa_words(&self) -> &'static str {
        match self.kappa {
            None => "not defined",
            Some(k) if k > 0.8 => "almost perfect",
            Some(k) if k > 0.6 => "substantial",
            Some(k) if k > 0.4 => "moderate",
            Some(k) if k > 0.2 => "fair",
            Some(k) if k >= 0.0 => "slight",
            Some(_) => "poor",
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn close(found: Option<f64>, expected: f64) -> bool {
        found.is_some_and(|found| (found - expected).abs() < 1e-12)
    }

    #[test]
    fn kappa_of_a_table_by_hand() {
        // Three categories: diagonal 4, 3, 2; one pair (1, 2), one pair (3, 2), one pair (1, 3).
        let table = [
            (1, 1, 4),
            (2, 2, 3),
            (3, 3, 2),
            (1, 2, 1),
            (3, 2, 1),
            (1, 3, 1),
        ];
        let pairs: Vec<(f64, f64)> = table
            .iter()
            .flat_map(|(a, b, n)| vec![(f64::from(*a), f64::from(*b)); *n])
            .collect();
        // Marginals of 12: first 6, 3, 3; second 4, 5, 3. Observed distance 4. Expected: (6*5 + 6*3*2 + 3*4 + 3*3 +
        // 3*4*2 + 3*5) / 12 = 126 / 12.
        let found = agreement(&pairs).expect("pairs");
        assert!(close(found.kappa, 1.0 - 4.0 * 12.0 / 126.0), "{found:?}");
        assert_eq!((found.readings, found.exact), (12, 0.75));
        assert!((found.within_1mm - 11.0 / 12.0).abs() < 1e-12);
        assert!((found.bias_mm - 2.0 / 12.0).abs() < 1e-12);
    }

    #[test]
    fn kappa_is_undefined_without_variation_and_zero_by_chance() {
        assert_eq!(agreement(&[]), None);
        assert_eq!(agreement(&[(3.0, 3.0); 5]).and_then(|a| a.kappa), None);
        let chance: Vec<(f64, f64)> = [2.0, 4.0]
            .iter()
            .flat_map(|a| [2.0, 4.0].map(|b| (*a, b)))
            .collect();
        assert!(close(agreement(&chance).and_then(|a| a.kappa), 0.0));
    }

    #[test]
    fn a_prescribed_depth_of_half_a_millimetre_counts_as_equal_on_both_sides() {
        let found = agreement(&[(3.5, 3.0), (3.5, 4.0), (3.4, 4.4), (3.0, 4.1)]).expect("pairs");
        assert_eq!((found.exact, found.within_1mm), (0.5, 0.75));
    }

    proptest! {
        #[test]
        fn kappa_is_one_for_equal_raters_at_most_one_and_symmetric(
            pairs in prop::collection::vec((0.0..16.0f64, 0.0..16.0f64), 2..60),
        ) {
            let same: Vec<(f64, f64)> = pairs.iter().map(|(a, _)| (*a, *a)).collect();
            if let Some(kappa) = weighted_kappa(&same) {
                prop_assert!((kappa - 1.0).abs() < 1e-12);
            }
            let turned: Vec<(f64, f64)> = pairs.iter().map(|(a, b)| (*b, *a)).collect();
            let (one, other) = (weighted_kappa(&pairs), weighted_kappa(&turned));
            prop_assert_eq!(one.is_some(), other.is_some());
            if let (Some(one), Some(other)) = (one, other) {
                prop_assert!(one <= 1.0 + 1e-12 && (one - other).abs() < 1e-9);
            }
        }
    }
}
