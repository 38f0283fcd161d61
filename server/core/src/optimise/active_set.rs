//! Active-set solver of the contact problem: no allocation, bounded work, bit-identical results on all machines.
//!
//! The solver works on the dual, which is fastest while few rows bear load. Few loaded rows are the normal case. A
//! problem without tissue can have many active rows, as with a flat tool on a flat face. At 32 active rows such a
//! problem restarts in the six unknowns of each tool (`rigid`). The cost of `rigid` does not grow with the number of
//! active rows. The solution is unique, so both methods give the same result.
//!
//! The method is that of Goldfarb and Idnani (1983, doi:10.1007/BF02591962) with a unit Hessian. On the dual this
//! method equals the non-negative least-squares scheme of Lawson and Hanson (1974, chapter 23):
//!
//! - The row with the largest violation enters.
//! - `H_PP s = -b_P` is solved on the active set `P`.
//! - Rows whose multiplier would turn negative leave.
//!
//! The Cholesky factor of `H_PP` grows by a row and shrinks by Givens rotations. Every iterate before the end violates
//! rows, so only a `Solved` result may be applied.
//!
//! With tissue, rows enter in blocks. The first block is the warm start: rows that bore load in the previous substep.
//! Each later block is the set of rows with at least half of the worst violation. Every step decreases the dual
//! objective. After a block without progress the next row enters alone. A single row always makes progress, apart from
//! rounding.

use super::rigid::RigidScratch;
use super::{ContactSolver, Problem, Solution, SolveStatus, dot, dot6};
use crate::math::fmax;

/// Number of active rows from which a problem without tissue is solved in the six unknowns of each tool.
const MANY: usize = 32;
/// Share of the worst violation from which a violated row enters in the same block.
const BLOCK: f64 = 0.5;
/// Number of rows that enter in one block with [`ActiveSet::entering_few`].
///
/// Without the limit a leap into tissue lets 200 rows enter at once, most of which leave again one by one. Measured
/// with the limit: the 99.9th percentile of a tick falls from 1.5 to 0.2 ms at leaps into a tongue, and from 3.2 to
/// 1.9 ms at random leaps in a pocket.
const FEW: usize = 16;
/// Number of rows up to which the warm start enters as one block with [`ActiveSet::entering_few`].
const FEW_WARM: usize = 64;
/// Entry tolerance, relative to [`Problem::scale`]: rows enter while their violation exceeds this share of the largest
/// `|b_i|`, plus the allowance [`ROUNDING`]. Rows of the warm start enter without this test.
const ENTRY_TOLERANCE: f64 = 1e-11;
/// Rounding allowance of the slack `w`, per unit of the largest `H_ii lambda_i`.
const ROUNDING: f64 = 1e-14;

/// Active-set solver with its scratch.
#[derive(Debug)]
pub struct ActiveSet {
    /// Scratch for problems without tissue.
    rigid: RigidScratch,
    /// Indices of the active rows, those that may bear load, in the order of entry.
    active: Vec<usize>,
    /// State of each row.
    state: Vec<RowState>,
    /// Lower Cholesky factor of the dual matrix `H` over `active`, row-major with stride `capacity`.
    factor: Vec<f64>,
    /// Right-hand side (metres) and solution (newtons) of a system over `active`, in its order.
    work: Vec<f64>,
    /// Slack of each row, metres, negative for a violation; in use with tissue only.
    slack: Vec<f64>,
    /// Indices of the rows that enter together.
    block: Vec<usize>,
    /// Largest number of active rows.
    capacity: usize,
    /// Largest number of rows in a block: that of the warm start, and that of violated rows.
    most_entering: (usize, usize),
    /// Products and rows of the last solve, by kind.
    pub(crate) effort: Effort,
}

/// Counts of one solve, the same on every machine.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Effort {
    /// Entries of the factor that were computed, changed or used.
    pub entries: u64,
    /// Rows whose slack or gap was computed.
    pub slacks: u64,
    /// Products of the tissue's compliance with a load.
    pub products: u64,
}

/// State of a row in a solve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum RowState {
    /// Not active: bears no load.
    Free,
    /// In the active set: may bear load.
    Active,
    /// Entered and left at once through rounding; excluded until another row makes progress.
    Barred,
}

impl ActiveSet {
    /// Returns a solver for problems of up to `capacity` rows, with or without tissue.
    pub fn with_capacity(capacity: usize) -> Self {
        Self {
            rigid: RigidScratch::with_capacity(capacity),
            ..Self::dense(capacity.max(MANY))
        }
    }

    /// Returns a solver for problems of up to `capacity` rows without tissue. A small factor is enough for them.
    pub fn rigid_only(capacity: usize) -> Self {
        Self {
            rigid: RigidScratch::with_capacity(capacity),
            state: Vec::with_capacity(capacity),
            slack: Vec::with_capacity(capacity),
            block: Vec::with_capacity(capacity),
            ..Self::dense(MANY)
        }
    }

    /// Returns a solver with a factor for `capacity` active rows, and empty scratch for problems without tissue.
    fn dense(capacity: usize) -> Self {
        Self {
            rigid: RigidScratch::with_capacity(0),
            active: Vec::with_capacity(capacity),
            state: Vec::with_capacity(capacity),
            factor: vec![0.0; capacity * capacity],
            work: vec![0.0; capacity],
            slack: Vec::with_capacity(capacity),
            block: Vec::with_capacity(capacity),
            capacity,
            most_entering: (usize::MAX, usize::MAX),
            effort: Effort::default(),
        }
    }

    /// Limits the number of rows that enter in one block. The solution is the same up to rounding.
    pub fn entering_few(self) -> Self {
        Self {
            most_entering: (FEW_WARM, FEW),
            ..self
        }
    }

    /// Reduces the block to its `most` worst violated rows.
    fn shorten_block(&mut self, most: usize) {
        if self.block.len() > most {
            let slack = &self.slack;
            // The order is total: ties are decided by the index.
            let by_slack = |a: &usize, b: &usize| slack[*a].total_cmp(&slack[*b]).then(a.cmp(b));
            self.block.select_nth_unstable_by(most, by_slack);
            self.block.truncate(most);
            self.block.sort_unstable();
        }
    }

    /// Appends row `p` to the active set and the factor. Returns false when the matrix is not numerically positive
    /// definite.
    fn append(&mut self, problem: &Problem<'_>, p: usize) -> bool {
        let n = self.active.len();
        self.effort.entries += (n * n / 2 + 8 * n) as u64;
        let mut pivot = problem.gram(p, p);
        for k in 0..n {
            let mut entry = problem.gram(p, self.active[k]);
            let (above, row) = self.factor.split_at_mut(n * self.capacity);
            let l_k = &above[k * self.capacity..][..=k];
            entry -= dot(&row[..k], &l_k[..k]);
            entry /= l_k[k];
            row[k] = entry;
            pivot -= entry * entry;
        }
        // In exact arithmetic the pivot is at least `eps`. Rounding normally removes only a part of it.
        if !(pivot > 0.0 && pivot.is_finite()) {
            return false;
        }
        self.factor[n * self.capacity + n] = pivot.sqrt();
        self.active.push(p);
        self.state[p] = RowState::Active;
        true
    }

    /// Removes the `k`-th active row from the factor by Givens rotations.
    fn remove(&mut self, k: usize) {
        let (n, stride) = (self.active.len(), self.capacity);
        self.effort.entries += (2 * (n - k) * (n - k)) as u64;
        self.state[self.active[k]] = RowState::Free;
        self.active.remove(k);
        for row in k + 1..n {
            self.factor
                .copy_within(row * stride..row * stride + row + 1, (row - 1) * stride);
        }
        // Row j, the former row j + 1, has one entry right of the diagonal, which a Givens rotation removes.
        for j in k..n - 1 {
            let (a, b) = (self.factor[j * stride + j], self.factor[j * stride + j + 1]);
            let r = (a * a + b * b).sqrt();
            let (c, s) = (a / r, b / r);
            for row in j..n - 1 {
                let at = row * stride + j;
                let (x, y) = (self.factor[at], self.factor[at + 1]);
                self.factor[at] = c * x + s * y;
                self.factor[at + 1] = c * y - s * x;
            }
        }
    }

    /// Removes all active rows without load whose next multiplier, in `work`, is not positive. Such rows limit every
    /// step to zero.
    fn remove_idle(&mut self, solution: &Solution) {
        for k in (0..self.active.len()).rev() {
            if self.work[k] <= 0.0 && solution.lambda[self.active[k]] == 0.0 {
                self.remove(k);
            }
        }
    }

    /// Solves `H_PP s = work` in place, with the dual matrix `H` over the active set `P`.
    fn substitute(&mut self) {
        let (n, stride) = (self.active.len(), self.capacity);
        self.effort.entries += (n * n + 8 * n) as u64;
        for i in 0..n {
            let row = &self.factor[i * stride..][..=i];
            self.work[i] = (self.work[i] - dot(&row[..i], &self.work[..i])) / row[i];
        }
        // Row by row here too: each solved entry is subtracted at once from all entries that are still to be solved.
        for i in (0..n).rev() {
            let row = &self.factor[i * stride..][..=i];
            let (before, rest) = self.work.split_at_mut(i);
            rest[0] /= row[i];
            for (x, l) in before.iter_mut().zip(row) {
                *x -= l * rest[0];
            }
        }
    }

    /// Performs one step of iterative refinement on the active set. The step removes the rounding error of the factor,
    /// which matters for nearly parallel rows.
    fn refine(&mut self, problem: &Problem<'_>, solution: &mut Solution) {
        let y = problem.primal(&solution.lambda);
        self.effort.slacks += self.active.len() as u64;
        if problem.tissue.is_some() {
            self.effort.products += (problem.rows.len() * self.active.len()) as u64;
        }
        for (k, &i) in self.active.iter().enumerate() {
            self.work[k] = -problem.slack(i, &solution.lambda, &y);
        }
        self.substitute();
        for (k, &i) in self.active.iter().enumerate() {
            solution.lambda[i] = fmax(0.0, solution.lambda[i] + self.work[k]);
        }
    }

    /// Returns the free row with the most negative slack, if this slack is under `-tolerance` (metres).
    fn most_violated(
        &mut self,
        problem: &Problem<'_>,
        solution: &Solution,
        tolerance: f64,
    ) -> Option<usize> {
        let m = problem.rows.len();
        self.effort.slacks += m as u64;
        if problem.tissue.is_some() {
            self.effort.products += (m * self.active.len()) as u64;
        }
        let mut worst = (None, -tolerance);
        let mut look = |i: usize, w: f64| {
            if w < worst.1 {
                worst = (Some(i), w);
            }
        };
        if let Some(c) = problem.tissue {
            self.slack.clear();
            self.slack
                .extend((0..m).map(|i| problem.rigid_slack(i, &solution.lambda, &solution.y)));
            // Only active rows bear load. `C` is symmetric, so its rows are its columns.
            for &j in &self.active {
                let load = solution.lambda[j];
                for (w, c_ij) in self.slack.iter_mut().zip(&c[j * m..(j + 1) * m]) {
                    *w += c_ij * load;
                }
            }
            for (i, (w, state)) in self.slack.iter().zip(&self.state).enumerate() {
                if *state == RowState::Free {
                    look(i, *w);
                }
            }
            return worst.0;
        }
        let loads = self.state.iter().zip(&solution.lambda);
        let rows = problem.rows.iter().zip(loads).enumerate();
        let free = rows.filter(|(_, (_, (state, _)))| **state == RowState::Free);
        if self.active.is_empty() {
            // Without load the slack is the bias.
            for (i, (row, _)) in free {
                look(i, row.bias);
            }
        } else {
            // Slack without the tissue check per row: most of the time of a solve is spent here.
            let (first, second) = solution.y.split_at(6);
            for (i, (row, (_, load))) in free {
                let y = if row.tool == 0 { first } else { second };
                let w = row.bias + dot6(&row.a, y) + problem.contact_compliance * load;
                look(i, w);
            }
        }
        worst.0
    }
}

impl ContactSolver for ActiveSet {
    fn solve(&mut self, problem: &Problem<'_>, solution: &mut Solution) {
        let m = problem.rows.len();
        self.effort = Effort {
            slacks: 2 * m as u64,
            ..Effort::default()
        };
        solution.lambda.clear();
        solution.lambda.resize(m, 0.0);
        solution.y.fill(0.0);
        solution.iterations = 0;
        solution.status = SolveStatus::NumericalError;
        if problem.rows.iter().any(|row| !row.bias.is_finite()) {
            return;
        }
        if problem.tissue.is_some() && m > self.capacity {
            return;
        }
        self.active.clear();
        self.state.clear();
        self.state.resize(m, RowState::Free);
        let base_tolerance = ENTRY_TOLERANCE * problem.scale();
        let mut largest = 0.0;
        let mut refinements = 0;
        let blocks = problem.tissue.is_some();
        let mut alone = !blocks;
        self.block.clear();
        if blocks {
            self.block
                .extend(problem.warm_start.iter().map(|&i| i as usize));
            if self.block.len() > self.most_entering.0 {
                // Too many rows touch to guess which will bear load.
                self.block.clear();
            }
        }
        loop {
            if self.block.is_empty() {
                let tolerance = base_tolerance + ROUNDING * largest;
                let Some(worst) = self.most_violated(problem, solution, tolerance) else {
                    // Refinement reduces the rounding error, which may reveal another violated row.
                    if refinements < 2 && !self.active.is_empty() {
                        refinements += 1;
                        self.refine(problem, solution);
                        solution.y = problem.primal(&solution.lambda);
                        continue;
                    }
                    solution.status = SolveStatus::Solved;
                    return;
                };
                if alone {
                    self.block.push(worst);
                } else {
                    let limit = BLOCK * self.slack[worst];
                    let violated = self.slack.iter().zip(&self.state).enumerate();
                    let near = violated
                        .filter(|(_, (w, state))| **state == RowState::Free && **w <= limit)
                        .map(|(i, _)| i);
                    self.block.extend(near);
                    self.shorten_block(self.most_entering.1);
                }
            }
            if problem.tissue.is_none() && self.active.len() == MANY {
                solution.lambda.fill(0.0);
                self.effort.slacks += self.rigid.solve(problem, solution);
                return;
            }
            for k in 0..self.block.len() {
                if !self.append(problem, self.block[k]) {
                    solution.status = SolveStatus::NumericalError;
                    return;
                }
            }
            loop {
                solution.iterations += 1;
                if solution.iterations as usize > problem.max_iterations {
                    solution.status = SolveStatus::IterationLimit;
                    return;
                }
                for (k, &i) in self.active.iter().enumerate() {
                    self.work[k] = -problem.rows[i].bias;
                }
                self.substitute();
                // Share of the way to `work` up to the first multiplier that reaches zero.
                let (mut share, mut leaving) = (1.0, None);
                for (k, &i) in self.active.iter().enumerate() {
                    let (now, next) = (solution.lambda[i], self.work[k]);
                    if next <= 0.0 {
                        let reach = if now > next { now / (now - next) } else { 0.0 };
                        if reach < share || leaving.is_none() {
                            (share, leaving) = (reach, Some(k));
                        }
                    }
                }
                largest = 0.0;
                for (k, &i) in self.active.iter().enumerate() {
                    let now = solution.lambda[i];
                    let moved = now + share * (self.work[k] - now);
                    solution.lambda[i] = fmax(0.0, moved);
                    largest = fmax(largest, problem.gram(i, i) * solution.lambda[i]);
                }
                let Some(k) = leaving else { break };
                let row = self.active[k];
                solution.lambda[row] = 0.0;
                if alone {
                    self.remove(k);
                    if self.block[0] == row {
                        self.state[row] = RowState::Barred;
                        break;
                    }
                } else {
                    self.remove_idle(solution);
                }
            }
            let gained = self
                .block
                .iter()
                .any(|&i| self.state[i] == RowState::Active);
            // After progress, barred rows become free again.
            if gained {
                for state in &mut self.state {
                    if *state == RowState::Barred {
                        *state = RowState::Free;
                    }
                }
            }
            alone = !(blocks && gained);
            self.block.clear();
            solution.y = problem.primal(&solution.lambda);
            refinements = 0;
        }
    }
}
