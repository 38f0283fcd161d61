//! Kernel of the compliance between the places of a gingiva: `C_ij = E_ij R_i R_j`.
//!
//! - `R_i = D_i^1/2` is the symmetric root of the compliance of place i alone.
//! - `E_ij` is the falloff: the mean of `exp(-distance / l)` between the stretches of surface of the places i and j.
//!
//! `C` is positive semi-definite by construction. `exp(-distance / l)` is a positive-definite function in any
//! dimension, the Matern kernel of order 1/2. Means of the function stay positive definite, and so does `C = R (E x 1)
//! R'` for any roots. A product of clamped direction cosines, the obvious matrix form of the paper's Eq. 14, is not
//! positive definite.
//!
//! Means are necessary because a probe lies along the wall and loads n spheres, whose common compliance is the mean of
//! all `E_ij`. With points, `E_ii = 1` counts too much. The compliance of 3 mm of wall would be 5 % too large at level
//! 3 (spheres 0.5 mm apart). At level 4 the error would be 1 %.

use crate::math::{Vec3, exp_of_libm, norm};

/// Symmetric 3x3 root of a compliance, (m/N)^1/2, world axes, entries xx, xy, xz, yy, yz, zz.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Root([f64; 6]);

impl Root {
    /// Returns `a uu' + b vv' + c ww'` for an orthonormal basis `u, v, w` and factors `a, b, c` in (m/N)^1/2. This is
    /// the root of the compliances `a^2`, `b^2` and `c^2` along the basis.
    pub fn along(basis: [(f64, Vec3); 3]) -> Self {
        let mut root = [0.0; 6];
        for (size, v) in basis {
            let products = [
                v.x * v.x,
                v.x * v.y,
                v.x * v.z,
                v.y * v.y,
                v.y * v.z,
                v.z * v.z,
            ];
            for (sum, product) in root.iter_mut().zip(products) {
                *sum += size * product;
            }
        }
        Self(root)
    }

    /// Returns the root times the vector `v`.
    #[inline]
    pub fn times(&self, v: &Vec3) -> Vec3 {
        let [xx, xy, xz, yy, yz, zz] = self.0;
        Vec3::new(
            xx * v.x + xy * v.y + xz * v.z,
            xy * v.x + yy * v.y + yz * v.z,
            xz * v.x + yz * v.y + zz * v.z,
        )
    }
}

/// Largest number of places for which the whole falloff matrix is stored.
const WHOLE: usize = 1024;
/// Number of rows of the falloff matrix in the cache when there are more than `WHOLE` places.
const KEPT: usize = 192;
/// Marker of a place without a stored row, and of an empty cache slot.
const NONE: u32 = u32::MAX;

/// Stretch of surface along the tooth's axis, stored as its two Gauss points, world axes, metres.
#[derive(Clone, Copy, Debug)]
pub struct Stretch([Vec3; 2]);

impl Stretch {
    /// Returns the stretch of `length` (metres) about `middle` along the unit vector `axis`.
    pub fn new(middle: Vec3, axis: &Vec3, length: f64) -> Self {
        let half = axis * (length * 0.5 / 3.0_f64.sqrt());
        Self([middle - half, middle + half])
    }

    /// Returns the mean of `exp(-distance / reach)` over the four pairs of Gauss points of two stretches, 0 to 1.
    /// `reach` is in metres. The result has the same bits in both directions.
    #[inline]
    fn falloff(&self, other: &Self, reach: f64) -> f64 {
        let between = |a: usize, b: usize| exp_of_libm(-norm(&(self.0[a] - other.0[b])) / reach);
        0.25 * ((between(0, 0) + between(1, 1)) + (between(0, 1) + between(1, 0)))
    }
}

/// Falloff matrix `E` of the compliance between all places of a gingiva: entries 0 to 1, without unit. Up to 1024
/// places (8 MiB, enough for a patient's gingivae), the whole matrix is stored. For more places (134 MB at level 4), a
/// cache holds 192 rows of places loaded lately. Entries outside the cache are computed on demand.
#[derive(Debug)]
pub struct Falloff {
    reach: f64,
    places: Vec<Stretch>,
    rows: Vec<f64>,
    /// Slot of each place's row in `rows`, or `NONE`.
    slots: Vec<u32>,
    /// Place whose row each slot holds, or `NONE`.
    holders: Vec<u32>,
    /// Slot that is overwritten next.
    next: usize,
}

impl Falloff {
    /// Returns the falloff matrix of `places` with the length `reach` (metres) of the exponential.
    pub fn new(places: Vec<Stretch>, reach: f64) -> Self {
        let n = places.len();
        let kept = if n <= WHOLE { n } else { KEPT };
        let mut falloff = Self {
            reach,
            places,
            rows: vec![0.0; kept * n],
            slots: vec![NONE; n],
            holders: vec![NONE; kept],
            next: 0,
        };
        if n <= WHOLE {
            falloff.keep_all();
        }
        falloff
    }

    /// Fills the whole matrix. Each entry is computed once, so both triangles have the same bits.
    fn keep_all(&mut self) {
        let n = self.places.len();
        for i in 0..n {
            (self.slots[i], self.holders[i]) = (i as u32, i as u32);
            for j in i..n {
                let entry = self.compute(i, j);
                self.rows[i * n + j] = entry;
                self.rows[j * n + i] = entry;
            }
        }
    }

    fn compute(&self, i: usize, j: usize) -> f64 {
        self.places[i].falloff(&self.places[j], self.reach)
    }

    /// Computes and caches row `i`, unless the row is stored.
    fn keep(&mut self, i: usize) {
        if self.slots[i] != NONE {
            return;
        }
        let (slot, n) = (self.next, self.places.len());
        self.next = (slot + 1) % self.holders.len();
        let before = self.holders[slot];
        if before != NONE {
            self.slots[before as usize] = NONE;
        }
        self.holders[slot] = i as u32;
        self.slots[i] = slot as u32;
        for j in 0..n {
            self.rows[slot * n + j] = self.compute(i, j);
        }
    }

    /// Returns row `i`, the falloff from place `i` to every place. The row is stored if necessary.
    pub fn row(&mut self, i: usize) -> &[f64] {
        self.keep(i);
        let (slot, n) = (self.slots[i] as usize, self.places.len());
        &self.rows[slot * n..(slot + 1) * n]
    }

    /// Returns a function of `j` for the entries `(i, j)`, read from the stored row or computed.
    #[inline]
    pub fn from(&self, i: usize) -> impl Fn(usize) -> f64 + '_ {
        let (slot, n) = (self.slots[i], self.places.len());
        let row = if slot == NONE {
            &[][..]
        } else {
            &self.rows[slot as usize * n..(slot as usize + 1) * n]
        };
        move |j| match row.get(j) {
            Some(entry) => *entry,
            None => self.compute(i, j),
        }
    }

    /// Returns the number of places.
    pub fn len(&self) -> usize {
        self.places.len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn places(n: usize) -> Vec<Stretch> {
        (0..n)
            .map(|k| {
                let t = k as f64;
                let at = Vec3::new(libm::sin(t), libm::cos(1.7 * t), libm::sin(0.3 * t)) * 4e-3;
                Stretch::new(at, &Vec3::z(), 5e-4 * (t % 3.0))
            })
            .collect()
    }

    #[test]
    fn kept_or_computed_an_entry_is_the_same_bits() {
        let all = places(WHOLE + 300);
        let (mut few, mut many) = (
            Falloff::new(all[..600].to_vec(), 8.3e-4),
            Falloff::new(all.clone(), 8.3e-4),
        );
        assert_eq!((few.len(), many.len()), (600, WHOLE + 300));
        for i in (0..600).step_by(7).chain([3, 3, 0]) {
            let whole = few.row(i).to_vec();
            let lone: Vec<f64> = (0..600).map(many.from(i)).collect();
            assert_eq!(whole, lone);
            assert_eq!(whole, many.row(i)[..600]);
            let kept: Vec<f64> = (0..600).map(many.from(i)).collect();
            assert_eq!(whole, kept);
            assert!(i % 3 != 0 || whole[i] == 1.0);
        }
        // More rows than the cache holds: the first rows were overwritten and are computed again.
        for i in 0..WHOLE {
            let computed = many.compute(i, i);
            assert_eq!(many.row(i)[i], computed);
        }
        assert_eq!(few.row(5)[17], many.row(5)[17]);
    }

    #[test]
    fn a_line_of_places_is_as_soft_whatever_their_number() {
        let (reach, line): (f64, f64) = (8.3e-4, 3e-3);
        let x = line / reach;
        let exact = 2.0 / x - 2.0 / (x * x) * (1.0 - libm::exp(-x));
        let mean = |n: usize, spread: f64| {
            let h = line / n as f64;
            let at = |k: usize| Vec3::z() * (h * (k as f64 + 0.5));
            let places = (0..n).map(|k| Stretch::new(at(k), &Vec3::z(), spread * h));
            let mut all = Falloff::new(places.collect(), reach);
            let sum: f64 = (0..n).map(|i| all.row(i).iter().sum::<f64>()).sum();
            sum / (n * n) as f64 / exact - 1.0
        };
        // Points give too large a compliance, more so for few places. Stretches do not.
        assert!(mean(6, 0.0) > 0.04 && mean(12, 0.0) > 0.01);
        for n in [3, 6, 12, 24] {
            let error = mean(n, 1.0);
            let bound = if n < 6 { 0.05 } else { 0.012 };
            assert!(error.abs() < bound, "{n}: {error}");
        }
    }

    #[test]
    fn a_root_is_the_root_of_its_compliances() {
        let axis = Vec3::new(1.0, 2.0, -0.5).normalize();
        let side = axis.cross(&Vec3::x()).normalize();
        let third = axis.cross(&side);
        let root = Root::along([(0.2, axis), (0.5, side), (0.1, third)]);
        let v = Vec3::new(0.3, -0.7, 0.4);
        let twice = root.times(&root.times(&v));
        let wanted =
            axis * axis.dot(&v) * 0.04 + side * side.dot(&v) * 0.25 + third * third.dot(&v) * 0.01;
        assert!(norm(&(twice - wanted)) < 1e-15);
    }
}
