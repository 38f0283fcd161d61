//! Where the masters of an organ are, and how much each counts at a place.

use serde::{Deserialize, Serialize};

use crate::math::{Vec3, fmax, norm};

/// Masters that carry a sphere.
pub const SURFACE_CARRIERS: usize = 8;

/// Masters: those that move, then those that are held, which only make what is near them stay.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Masters {
    /// Where they are at rest, metres, the frame of the object.
    pub places: Vec<Vec3>,
    /// How many of them move; the first ones.
    pub moving: u16,
}

impl Masters {
    /// Those that move.
    #[inline]
    pub fn moving(&self) -> usize {
        usize::from(self.moving)
    }

    /// Whether enough of them are there to follow, all at finite places.
    pub fn are_sound(&self) -> bool {
        self.places.len() > SURFACE_CARRIERS
            && (1..=self.places.len()).contains(&self.moving())
            && self.places.iter().flatten().all(|x| x.is_finite())
    }

    /// The nearest ones to a place on the surface (metres), by number, weighted by `(1 - d/r)^2` with `r` the distance of the next:
    /// a weight has gone to zero, slope and all, where another takes its place, so what follows is smooth. Sums to 1.
    /// (They must be sound.)
    pub fn weights(&self, place: &Vec3) -> [(usize, f64); SURFACE_CARRIERS] {
        let away = |(k, p): (usize, &Vec3)| (norm(&(p - place)), k);
        let mut near: Vec<(f64, usize)> = self.places.iter().enumerate().map(away).collect();
        near.sort_unstable_by(|x, y| x.0.total_cmp(&y.0).then(x.1.cmp(&y.1)));
        let reach = fmax(near[SURFACE_CARRIERS].0, f64::MIN_POSITIVE);
        let weight = |d: f64| {
            let rest = fmax(1.0 - d / reach, 0.0);
            rest * rest
        };
        let nearest = &near[..SURFACE_CARRIERS];
        let sum: f64 = nearest.iter().map(|(d, _)| weight(*d)).sum();
        std::array::from_fn(|slot| {
            let (d, k) = nearest[slot];
            // All nine at one distance: each is as good as any.
            let even = 1.0 / SURFACE_CARRIERS as f64;
            (k, if sum > 0.0 { weight(d) / sum } else { even })
        })
    }
}
