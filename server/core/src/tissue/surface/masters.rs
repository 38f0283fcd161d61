//! Masters of an organ: their positions, and their weights at a place.

use serde::{Deserialize, Serialize};

use crate::math::{Vec3, fmax, norm};

/// Number of masters that carry a sphere.
pub const SURFACE_CARRIERS: usize = 8;

/// Masters of an organ: the moving masters, then the held masters. Held masters only keep the surface near them in
/// place.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Masters {
    /// Rest positions, metres, the frame of the object.
    pub places: Vec<Vec3>,
    /// Number of moving masters, which come first.
    pub moving: u16,
}

impl Masters {
    /// Returns the number of moving masters.
    #[inline]
    pub fn moving(&self) -> usize {
        usize::from(self.moving)
    }

    /// Returns whether there are more than [`SURFACE_CARRIERS`] masters, all at finite positions, and at least one
    /// moves.
    pub fn are_sound(&self) -> bool {
        self.places.len() > SURFACE_CARRIERS
            && (1..=self.places.len()).contains(&self.moving())
            && self.places.iter().flatten().all(|x| x.is_finite())
    }

    /// Returns the eight masters nearest to a place on the surface (metres), by index, with their weights.
    ///
    /// A weight is proportional to `(1 - d/r)^2`, with `r` the distance of the ninth master. The weights sum to 1. A
    /// weight and its slope are zero at the place of a change to another master, so the field is smooth. The masters
    /// must be sound ([`Masters::are_sound`]).
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
            // All nine masters are at one distance: equal weights.
            let even = 1.0 / SURFACE_CARRIERS as f64;
            (k, if sum > 0.0 { weight(d) / sum } else { even })
        })
    }
}
