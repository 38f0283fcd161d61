//! Entries of a skeleton's matrices: the interaction of two nodes.

use std::fmt::Debug;

use crate::math::Vec3;

/// Vector of three numbers for the world's axes x, y and z, or the diagonal of a 3x3 matrix. The fourth lane is padding
/// and stays zero.
pub(super) type Axes = [f64; 4];

/// Computes `y += a x`, lane by lane.
#[inline(always)]
pub(super) fn add_product(y: &mut Axes, a: &Axes, x: &Axes) {
    for k in 0..4 {
        y[k] += a[k] * x[k];
    }
}

/// Computes `y -= a x`, lane by lane.
#[inline(always)]
pub(super) fn subtract_product(y: &mut Axes, a: &Axes, x: &Axes) {
    for k in 0..4 {
        y[k] -= a[k] * x[k];
    }
}

/// 3x3 matrix between two nodes of a skeleton, world axes: [`Axes`] for independent axes (the diagonal), [`Block`] for
/// coupled axes. The unit depends on the use: N/m in a stiffness, m/N in an inverse.
pub(super) trait Entry: Copy + Debug + Send + 'static {
    const ZERO: Self;
    /// Returns the symmetric matrix with the diagonal `stiffness` (x, y, z) and the entries `coupling` between y and z,
    /// z and x, x and y. Independent axes ignore `coupling`.
    fn of(stiffness: [f64; 3], coupling: [f64; 3]) -> Self;
    fn is_zero(&self) -> bool;
    /// Adds the number `own` to the three entries of the diagonal.
    fn add_diagonal(&mut self, own: f64);
    /// Adds the matrix `other` times `factor`.
    fn add_scaled(&mut self, factor: f64, other: &Self);
    /// Subtracts the matrix product `a b'`.
    fn subtract_outer(&mut self, a: &Self, b: &Self);
    /// Returns the matrix product `self other`.
    fn times(&self, other: &Self) -> Self;
    /// Returns the inverse of a symmetric, positive definite matrix.
    fn inverse(&self) -> Self;
    fn transposed(&self) -> Self;
    /// Returns the vector `self x` times `factor`.
    fn product(&self, factor: f64, x: &Axes) -> Axes;
    /// Computes `y -= self x` for vectors `x` and `y`.
    fn subtract_from(&self, y: &mut Axes, x: &Axes);
    /// Computes `y -= self' x` for vectors `x` and `y`.
    fn subtract_transposed_from(&self, y: &mut Axes, x: &Axes);
    /// Returns the row vector `a' self`.
    fn before(&self, a: &Vec3) -> Vec3;
    /// Returns the number `d' self d` for a vector `d`. With a stiffness (N/m) and a displacement (m) this is twice the
    /// energy, joules.
    fn quadratic(&self, d: &Axes) -> f64;
    /// Writes row `j` of the inverse of a symmetric matrix of entries to `row`, which must be zero before. `solve`
    /// turns a right-hand side, one vector per node, into the solution in place.
    fn inverse_row(j: usize, solve: &dyn Fn(&mut [Axes]), row: &mut [Self]);
    /// Returns the number at a row and a column.
    #[cfg(test)]
    fn at(&self, row: usize, column: usize) -> f64;
}

impl Entry for Axes {
    const ZERO: Self = [0.0; 4];

    fn of([x, y, z]: [f64; 3], _: [f64; 3]) -> Self {
        [x, y, z, 0.0]
    }

    fn is_zero(&self) -> bool {
        self.iter().all(|x| *x == 0.0)
    }

    fn add_diagonal(&mut self, own: f64) {
        self[..3].iter_mut().for_each(|x| *x += own);
    }

    #[inline(always)]
    fn add_scaled(&mut self, factor: f64, other: &Self) {
        add_product(self, &[factor; 4], other);
    }

    fn subtract_outer(&mut self, a: &Self, b: &Self) {
        subtract_product(self, a, b);
    }

    fn times(&self, other: &Self) -> Self {
        std::array::from_fn(|k| self[k] * other[k])
    }

    fn inverse(&self) -> Self {
        let [x, y, z, _] = *self;
        [1.0 / x, 1.0 / y, 1.0 / z, 0.0]
    }

    fn transposed(&self) -> Self {
        *self
    }

    #[inline(always)]
    fn product(&self, factor: f64, x: &Axes) -> Axes {
        std::array::from_fn(|k| factor * self[k] * x[k])
    }

    #[inline(always)]
    fn subtract_from(&self, y: &mut Axes, x: &Axes) {
        subtract_product(y, self, x);
    }

    #[inline(always)]
    fn subtract_transposed_from(&self, y: &mut Axes, x: &Axes) {
        subtract_product(y, self, x);
    }

    #[inline(always)]
    fn before(&self, a: &Vec3) -> Vec3 {
        Vec3::new(a.x * self[0], a.y * self[1], a.z * self[2])
    }

    #[inline(always)]
    fn quadratic(&self, d: &Axes) -> f64 {
        let mut sum = 0.0;
        for k in 0..4 {
            sum += self[k] * d[k] * d[k];
        }
        sum
    }

    fn inverse_row(j: usize, solve: &dyn Fn(&mut [Axes]), row: &mut [Self]) {
        row[j] = [1.0, 1.0, 1.0, 0.0];
        solve(row);
    }

    #[cfg(test)]
    fn at(&self, row: usize, column: usize) -> f64 {
        if row == column { self[row] } else { 0.0 }
    }
}

/// Full 3x3 matrix, column by column, each column padded with a zero.
pub(super) type Block = [Axes; 3];

impl Entry for Block {
    const ZERO: Self = [[0.0; 4]; 3];

    fn of([x, y, z]: [f64; 3], [yz, zx, xy]: [f64; 3]) -> Self {
        [[x, xy, zx, 0.0], [xy, y, yz, 0.0], [zx, yz, z, 0.0]]
    }

    fn is_zero(&self) -> bool {
        self.iter().flatten().all(|x| *x == 0.0)
    }

    fn add_diagonal(&mut self, own: f64) {
        let [x, y, z] = self;
        x[0] += own;
        y[1] += own;
        z[2] += own;
    }

    #[inline(always)]
    fn add_scaled(&mut self, factor: f64, other: &Self) {
        for (column, other) in self.iter_mut().zip(other) {
            add_product(column, &[factor; 4], other);
        }
    }

    fn subtract_outer(&mut self, a: &Self, b: &Self) {
        for (j, column) in self.iter_mut().enumerate() {
            for k in 0..3 {
                subtract_product(column, &a[k], &[b[k][j]; 4]);
            }
        }
    }

    fn times(&self, other: &Self) -> Self {
        other.map(|x| self.product(1.0, &x))
    }

    /// Inverse by `L D L'`: a positive definite matrix needs no pivoting.
    fn inverse(&self) -> Self {
        let (d0, a, b) = (self[0][0], self[0][1], self[0][2]);
        let (l, m) = (a / d0, b / d0);
        let d1 = self[1][1] - l * a;
        let c = self[1][2] - m * a;
        let n = c / d1;
        let d2 = self[2][2] - m * b - n * c;
        // The inverse of L has `-l`, `-n` and this number below its diagonal.
        let o = l * n - m;
        let (p, q, r) = (1.0 / d0, 1.0 / d1, 1.0 / d2);
        let (xy, zx, yz) = (-l * q - o * n * r, o * r, -n * r);
        [
            [p + l * l * q + o * o * r, xy, zx, 0.0],
            [xy, q + n * n * r, yz, 0.0],
            [zx, yz, r, 0.0],
        ]
    }

    fn transposed(&self) -> Self {
        let row = |k: usize| [self[0][k], self[1][k], self[2][k], 0.0];
        [row(0), row(1), row(2)]
    }

    #[inline(always)]
    fn product(&self, factor: f64, x: &Axes) -> Axes {
        let mut y = [0.0; 4];
        for k in 0..3 {
            add_product(&mut y, &self[k], &[factor * x[k]; 4]);
        }
        y
    }

    #[inline(always)]
    fn subtract_from(&self, y: &mut Axes, x: &Axes) {
        for k in 0..3 {
            subtract_product(y, &self[k], &[x[k]; 4]);
        }
    }

    #[inline(always)]
    fn subtract_transposed_from(&self, y: &mut Axes, x: &Axes) {
        for k in 0..3 {
            let column = &self[k];
            y[k] -= column[0] * x[0] + column[1] * x[1] + column[2] * x[2];
        }
    }

    #[inline(always)]
    fn before(&self, a: &Vec3) -> Vec3 {
        let along = |c: &Axes| a.x * c[0] + a.y * c[1] + a.z * c[2];
        Vec3::new(along(&self[0]), along(&self[1]), along(&self[2]))
    }

    #[inline(always)]
    fn quadratic(&self, d: &Axes) -> f64 {
        let moved = self.product(1.0, d);
        d[0] * moved[0] + d[1] * moved[1] + d[2] * moved[2]
    }

    fn inverse_row(j: usize, solve: &dyn Fn(&mut [Axes]), row: &mut [Self]) {
        let mut columns = vec![[0.0; 4]; row.len()];
        for k in 0..3 {
            columns.fill([0.0; 4]);
            columns[j][k] = 1.0;
            solve(&mut columns);
            // Column `k` at node `j` of a symmetric inverse equals row `k` there: displacement of `j` along `k` for
            // loads elsewhere.
            for (entry, column) in row.iter_mut().zip(&columns) {
                for axis in 0..3 {
                    entry[axis][k] = column[axis];
                }
            }
        }
    }

    #[cfg(test)]
    fn at(&self, row: usize, column: usize) -> f64 {
        self[column][row]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn difference(a: &Block, b: &Block) -> f64 {
        let pairs = a.iter().flatten().zip(b.iter().flatten());
        pairs.fold(0.0, |most, (a, b)| crate::math::fmax(most, (a - b).abs()))
    }

    #[test]
    fn blocks_compute_as_matrices_do() {
        let a = Block::of([3.0, 5.0, 4.0], [0.7, -1.1, 1.9]);
        let one = Block::of([1.0; 3], [0.0; 3]);
        assert!(difference(&a.times(&a.inverse()), &one) < 1e-15);
        assert_eq!(a.transposed(), a);
        // The blocks of a factor are not symmetric either.
        let b = a.times(&Block::of([1.0, 2.0, -1.0], [0.3, 0.2, -0.5]));
        assert!(difference(&b, &b.transposed()) > 0.1);
        let (x, y) = ([0.3, -0.8, 0.5, 0.0], Vec3::new(1.0, -2.0, 0.7));
        let bx = b.product(2.0, &x);
        let (mut minus, mut turned) = ([0.0; 4], [0.0; 4]);
        b.subtract_from(&mut minus, &x);
        b.transposed().subtract_transposed_from(&mut turned, &x);
        for k in 0..3 {
            let by_hand: f64 = (0..3).map(|j| b.at(k, j) * x[j]).sum();
            assert!((bx[k] - 2.0 * by_hand).abs() < 1e-15);
            assert!((minus[k] + by_hand).abs() < 1e-15 && (turned[k] + by_hand).abs() < 1e-15);
        }
        let before = b.before(&y);
        let both = 0.5 * (y.x * bx[0] + y.y * bx[1] + y.z * bx[2]);
        assert!((before.x * x[0] + before.y * x[1] + before.z * x[2] - both).abs() < 1e-14);
        let mut rest = one;
        rest.subtract_outer(&a, &b);
        let mut wanted = one;
        wanted.add_scaled(-1.0, &a.times(&b.transposed()));
        assert!(difference(&rest, &wanted) < 1e-14);
    }
}
