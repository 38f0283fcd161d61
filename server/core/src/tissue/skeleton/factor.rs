//! Step matrix of a skeleton, factored once: sparse `L D L'` in an order that keeps fill small.
//!
//! Entries are the 3x3 blocks between nodes, or their diagonals for independent axes.

use super::entry::{Axes, Entry};

/// Symmetric positive definite matrix before the factorisation: `n` by `n` entries, one for each pair of nodes, dense,
/// row-major.
#[derive(Clone, Debug)]
pub(super) struct Matrix<E> {
    pub n: usize,
    pub entries: Vec<E>,
}

impl<E: Entry> Matrix<E> {
    pub fn zeros(n: usize) -> Self {
        Self {
            n,
            entries: vec![E::ZERO; n * n],
        }
    }

    pub fn at(&mut self, i: usize, j: usize) -> &mut E {
        &mut self.entries[i * self.n + j]
    }
}

/// Returns the elimination order of least degree for `n` nodes joined by `edges`: each step takes the node with the
/// fewest neighbours left.
pub(super) fn elimination_order(
    n: usize,
    edges: impl Iterator<Item = (usize, usize)>,
) -> Vec<usize> {
    let mut joined = vec![false; n * n];
    for (i, j) in edges {
        joined[i * n + j] = true;
        joined[j * n + i] = true;
    }
    let mut left: Vec<usize> = (0..n).collect();
    let mut order = Vec::with_capacity(n);
    while !left.is_empty() {
        let degree = |i: usize| left.iter().filter(|&&j| joined[i * n + j]).count();
        let mut best = (usize::MAX, 0);
        for (place, &i) in left.iter().enumerate() {
            let d = degree(i);
            if d < best.0 {
                best = (d, place);
            }
        }
        let gone = left.remove(best.1);
        let around: Vec<usize> = left
            .iter()
            .copied()
            .filter(|&j| joined[gone * n + j])
            .collect();
        for &i in &around {
            for &j in &around {
                joined[i * n + j] |= i != j;
            }
        }
        order.push(gone);
    }
    order
}

/// Factor `L D L'` of a matrix whose rows are in the order of elimination.
#[derive(Clone, Debug)]
pub(super) struct Factor<E> {
    /// Start of each column's entries, then the end of the last column.
    start: Vec<u32>,
    /// Rows of the entries below the diagonal, column by column.
    rows: Vec<u16>,
    entries: Vec<E>,
    /// Inverse of each entry of `D`, zero in the padding.
    inverse_diagonal: Vec<E>,
}

impl<E: Entry> Factor<E> {
    /// Factors `matrix`, of which the lower triangle is read. Its rows are in the order of elimination.
    pub fn new(mut matrix: Matrix<E>) -> Self {
        let n = matrix.n;
        // Pattern of the fill. A value that cancels to zero by chance still counts as an entry.
        let mut filled: Vec<bool> = matrix
            .entries
            .iter()
            .map(|entry| !entry.is_zero())
            .collect();
        let mut factor = Self {
            start: vec![0],
            rows: Vec::new(),
            entries: Vec::new(),
            inverse_diagonal: Vec::with_capacity(n),
        };
        for j in 0..n {
            let inverse = matrix.at(j, j).inverse();
            let below: Vec<usize> = (j + 1..n).filter(|&i| filled[i * n + j]).collect();
            for &i in &below {
                let l = matrix.at(i, j).times(&inverse);
                for &c in below.iter().take_while(|&&c| c <= i) {
                    let other = *matrix.at(c, j);
                    matrix.at(i, c).subtract_outer(&l, &other);
                    filled[i * n + c] = true;
                }
                factor.rows.push(i as u16);
                factor.entries.push(l);
            }
            factor.start.push(factor.rows.len() as u32);
            factor.inverse_diagonal.push(inverse);
        }
        factor
    }

    /// Solves the system in place: `x` is the right-hand side, then the solution.
    pub fn solve(&self, x: &mut [Axes]) {
        let columns = || self.start.windows(2).map(|w| w[0] as usize..w[1] as usize);
        for (j, column) in columns().enumerate() {
            let pivot = x[j];
            let below = self.rows[column.clone()].iter().zip(&self.entries[column]);
            for (&i, l) in below {
                l.subtract_from(&mut x[usize::from(i)], &pivot);
            }
            x[j] = self.inverse_diagonal[j].product(1.0, &pivot);
        }
        for (j, column) in columns().enumerate().rev() {
            let mut sum = x[j];
            let below = self.rows[column.clone()].iter().zip(&self.entries[column]);
            for (&i, l) in below {
                l.subtract_transposed_from(&mut sum, &x[usize::from(i)]);
            }
            x[j] = sum;
        }
    }

    /// Returns the dense inverse of the factored matrix, row by row. Blocks off the diagonal are exact transposes of
    /// each other. Blocks on the diagonal are symmetric to rounding.
    pub fn inverse(&self) -> Vec<E> {
        let n = self.inverse_diagonal.len();
        let mut all = vec![E::ZERO; n * n];
        for (j, row) in all.chunks_exact_mut(n).enumerate() {
            E::inverse_row(j, &|x| self.solve(x), row);
        }
        // The contact matrix must be symmetric whichever half is read, so both halves get the same bits.
        for i in 0..n {
            for j in 0..i {
                all[i * n + j] = all[j * n + i].transposed();
            }
        }
        all
    }

    /// Returns the number of entries below the diagonal.
    #[cfg(test)]
    pub fn fill(&self) -> usize {
        self.rows.len()
    }
}
