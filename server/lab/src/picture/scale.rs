//! The scale of colours of an error, with a round end.

/// The error with full colour.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Scale {
    /// Millimetres.
    pub(crate) full_mm: f64,
}

impl Scale {
    /// The next 1, 2 or 5 times a power of ten that at least 99 % of the area does not exceed. From errors in
    /// millimetres, each with its area.
    pub(crate) fn fit(weighted_mm: &[(f64, f64)]) -> Self {
        let mut sizes: Vec<(f64, f64)> = weighted_mm.iter().map(|p| (p.0.abs(), p.1)).collect();
        sizes.sort_by(|a, b| a.0.total_cmp(&b.0));
        let total: f64 = sizes.iter().map(|p| p.1).sum();
        let mut passed = 0.0;
        let covered = sizes.iter().find(|p| {
            passed += p.1;
            passed >= 0.99 * total
        });
        Self {
            full_mm: round_up(covered.map_or(0.0, |p| p.0)),
        }
    }

    /// An error in millimetres as a share of full colour: from -1 to 1 within the scale.
    pub(crate) fn part(self, error_mm: f64) -> f64 {
        error_mm / self.full_mm
    }
}

/// The next 1, 2 or 5 times a power of ten, at least a tenth of a micrometre (in millimetres).
fn round_up(x: f64) -> f64 {
    for exponent in -4..6 {
        for digit in [1.0, 2.0, 5.0] {
            // Division keeps the decimals exact: 0.05, not 0.05000000000000001.
            let round = if exponent < 0 {
                digit / 10_f64.powi(-exponent)
            } else {
                digit * 10_f64.powi(exponent)
            };
            if round >= x {
                return round;
            }
        }
    }
    x
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scales_are_round_and_hold_all_but_a_percent_of_the_area() {
        assert_eq!(round_up(0.043), 0.05);
        assert_eq!(round_up(0.05), 0.05);
        assert_eq!(round_up(0.0), 0.0001);
        assert_eq!(round_up(13.0), 20.0);
        // One in two hundred far out does not make the rest look fine.
        let errors: Vec<(f64, f64)> = (0..200)
            .map(|k| (if k == 0 { -3.0 } else { 0.015 }, 1.0))
            .collect();
        assert_eq!(Scale::fit(&errors).full_mm, 0.02);
        let large = [(0.015, 1.0), (-3.0, 1.0)];
        assert_eq!(Scale::fit(&large).full_mm, 5.0);
        assert_eq!(Scale::fit(&large).part(-2.5), -0.5);
    }
}
