//! The kernel that couples the places of a gingiva: `C_ij = exp(-|x_i - x_j| / l) R_i R_j`, with the symmetric root
//! `R_i = D_i^1/2` of each place's own compliance. `exp(-distance / l)` is a positive-definite function in any dimension
//! (it is the Matern kernel of order 1/2), and `C = R (E x 1) R'` keeps that whatever the roots are; a product of clamped
//! direction cosines, the obvious way to write the paper's Eq. 14 as a matrix, does not.

use crate::math::{Vec3, norm};

/// Symmetric 3x3 matrix: xx, xy, xz, yy, yz, zz.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Root([f64; 6]);

impl Root {
    /// `a uu' + b vv' + c ww'` for an orthonormal basis `u, v, w`: the root whose squares are compliances along it.
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

    /// The matrix times `v`.
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

/// Places up to which all of `E` is kept.
const WHOLE: usize = 1024;
/// Rows of `E` that are kept where there are more places than that.
const KEPT: usize = 192;
/// No row.
const NONE: u32 = u32::MAX;

/// `E_ij = exp(-|x_i - x_j| / l)` between the rest centres of all places. Up to 1024 of them (8 MiB, level 3 has 512)
/// the whole matrix is kept; of more (134 MB at level 4) the rows of the places loaded lately, and an entry that is
/// in none of these is computed when it is asked for.
#[derive(Debug)]
pub struct Falloff {
    reach: f64,
    centres: Vec<Vec3>,
    rows: Vec<f64>,
    /// Where the row of each place is kept.
    slots: Vec<u32>,
    /// Whose row is kept there.
    holders: Vec<u32>,
    /// Slot that is given away next.
    next: usize,
}

impl Falloff {
    /// The falloff over `reach` (metres) between `centres` (metres).
    pub fn new(centres: Vec<Vec3>, reach: f64) -> Self {
        let n = centres.len();
        let kept = if n <= WHOLE { n } else { KEPT };
        let mut falloff = Self {
            reach,
            centres,
            rows: vec![0.0; kept * n],
            slots: vec![NONE; n],
            holders: vec![NONE; kept],
            next: 0,
        };
        if n <= WHOLE {
            for i in 0..n {
                falloff.keep(i);
            }
        }
        falloff
    }

    fn compute(&self, i: usize, j: usize) -> f64 {
        libm::exp(-norm(&(self.centres[i] - self.centres[j])) / self.reach)
    }

    /// Makes sure that the row of `i` is kept.
    fn keep(&mut self, i: usize) {
        if self.slots[i] != NONE {
            return;
        }
        let (slot, n) = (self.next, self.centres.len());
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

    /// Row `i`: the falloff from it to every place.
    pub fn row(&mut self, i: usize) -> &[f64] {
        self.keep(i);
        let (slot, n) = (self.slots[i] as usize, self.centres.len());
        &self.rows[slot * n..(slot + 1) * n]
    }

    /// Entries `(i, j)` for the one `i`, by `j`.
    #[inline]
    pub fn from(&self, i: usize) -> impl Fn(usize) -> f64 + '_ {
        let (slot, n) = (self.slots[i], self.centres.len());
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

    /// Number of places.
    pub fn len(&self) -> usize {
        self.centres.len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn places(n: usize) -> Vec<Vec3> {
        (0..n)
            .map(|k| {
                let t = k as f64;
                Vec3::new(libm::sin(t), libm::cos(1.7 * t), libm::sin(0.3 * t)) * 4e-3
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
            assert_eq!(whole[i], 1.0);
        }
        // More rows than are kept: early ones were given away and come back.
        for i in 0..WHOLE {
            assert_eq!(many.row(i)[i], 1.0);
        }
        assert_eq!(few.row(5)[17], many.row(5)[17]);
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
