//! Mean, percentile and maximum of weighted distances.

use serde::Serialize;

use super::largest::Largest;

/// Mean, 95th percentile and maximum of a set of distances, millimetres.
///
/// For an empty set they are NaN (`null` in JSON), which cannot be mistaken for a small error.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Spread {
    /// Mean, weighted by area.
    pub mean: f64,
    /// 95th percentile, weighted by area.
    pub p95: f64,
    /// Largest value found.
    pub max: f64,
    /// Proven upper bound; `None` if the maximum is that of the points only.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub max_at_most: Option<f64>,
}

impl Spread {
    /// Returns the spread of distances in metres with their areas.
    pub(super) fn new(mut values: Vec<(f64, f64)>) -> Self {
        values.sort_by(|a, b| a.0.total_cmp(&b.0));
        let total: f64 = values.iter().map(|value| value.1).sum();
        let Some(&(max, _)) = values.last() else {
            return Self {
                mean: f64::NAN,
                p95: f64::NAN,
                max: f64::NAN,
                max_at_most: None,
            };
        };
        if total <= 0.0 {
            return Self {
                max: 1e3 * max,
                ..Self::default()
            };
        }
        let sum: f64 = values.iter().map(|(value, area)| value * area).sum();
        let mut passed = 0.0;
        let p95 = values.iter().find(|(_, area)| {
            passed += area;
            passed >= 0.95 * total
        });
        Self {
            mean: 1e3 * sum / total,
            p95: 1e3 * p95.map_or(max, |value| value.0),
            max: 1e3 * max,
            max_at_most: None,
        }
    }

    /// Returns the spread with the maximum of a search.
    pub(super) fn with(self, largest: Largest) -> Self {
        Self {
            max: 1e3 * largest.attained,
            max_at_most: Some(1e3 * largest.at_most),
            ..self
        }
    }
}
