//! Active-set solver of the contact problem: no allocation, bounded, same bits everywhere.
//!
//! It works on the dual, which is quickest while few rows bear load, as nearly always. Where more than
//! a few dozen do and nothing yields (a flat tool on a flat face), it begins anew in the six unknowns
//! of each tool (`rigid`), whose cost does not grow with them. The answer is unique, so both ways
//! lead to the same.
//!
//! Goldfarb and Idnani (1983, doi:10.1007/BF02591962) with a unit Hessian is, on the dual, the
//! non-negative least-squares scheme of Lawson and Hanson (1974, chapter 23): rows enter by the
//! largest violation, `H_PP s = -b_P` is solved on the active set `P`, and rows whose multiplier
//! would turn negative leave. The Cholesky factor of `H_PP` grows by a row and shrinks by Givens
//! rotations. Until it ends an iterate violates rows, so only a `Solved` answer may be applied.
//!
//! Where something yields, rows enter in blocks: those that bore load in the tick's last pass first, then all
//! that are violated about as much as the worst. Every step goes downhill on the dual, so when a block
//! gained nothing the next row enters alone, which always does.

use super::rigid::RigidScratch;
use super::{ContactSolver, Problem, Solution, SolveStatus, dot, dot6};
use crate::math::fmax;

/// Active rows at which the six unknowns of a tool are the better place to work.
const MANY: usize = 32;
/// Share of the worst violation from which a row enters together with the worst.
const BLOCK: f64 = 0.5;
/// Rows enter while their violation exceeds this share of the problem's scale.
const ENTRY_TOLERANCE: f64 = 1e-11;
/// Head-room for rounding in `w`, per unit of the largest `H_ii lambda_i`.
const ROUNDING: f64 = 1e-14;

/// Scratch of the solver.
#[derive(Debug)]
pub struct ActiveSet {
    /// For problems without tissue.
    rigid: RigidScratch,
    /// Row indices in the order in which they entered.
    active: Vec<usize>,
    /// Whether a row is active, or barred until the active set changes.
    state: Vec<RowState>,
    /// Lower Cholesky factor of `H` over `active`, row-major with stride `capacity`.
    factor: Vec<f64>,
    /// Right-hand side and solution over `active`.
    work: Vec<f64>,
    /// Slack of every row.
    slack: Vec<f64>,
    /// Rows that enter together.
    block: Vec<usize>,
    capacity: usize,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum RowState {
    Free,
    Active,
    /// Entered and left at once through rounding: not tried again until something else changes.
    Barred,
}

impl ActiveSet {
    /// Room for problems of up to `capacity` rows, with tissue or without.
    pub fn with_capacity(capacity: usize) -> Self {
        Self {
            rigid: RigidScratch::with_capacity(capacity),
            ..Self::dense(capacity.max(MANY))
        }
    }

    /// Room for problems of up to `capacity` rows without tissue: a small factor is enough.
    pub fn rigid_only(capacity: usize) -> Self {
        Self {
            rigid: RigidScratch::with_capacity(capacity),
            state: Vec::with_capacity(capacity),
            slack: Vec::with_capacity(capacity),
            block: Vec::with_capacity(capacity),
            ..Self::dense(MANY)
        }
    }

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
        }
    }

    /// Appends row `p` to the factor. False when the matrix is not positive definite in
    /// these digits.
    fn append(&mut self, problem: &Problem<'_>, p: usize) -> bool {
        let n = self.active.len();
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
        // Exactly, the pivot is at least eps; rounding may eat some of it, not all.
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
        self.state[self.active[k]] = RowState::Free;
        self.active.remove(k);
        for row in k + 1..n {
            self.factor
                .copy_within(row * stride..row * stride + row + 1, (row - 1) * stride);
        }
        // Row j (old j + 1) now has one entry right of the diagonal: rotate it away.
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

    /// Removes all active rows that bear nothing and whose next multiplier, in `work`, is not positive: with
    /// them nothing can move.
    fn remove_idle(&mut self, solution: &Solution) {
        for k in (0..self.active.len()).rev() {
            if self.work[k] <= 0.0 && solution.lambda[self.active[k]] == 0.0 {
                self.remove(k);
            }
        }
    }

    /// Solves `H_PP s = work` in place.
    fn substitute(&mut self) {
        let (n, stride) = (self.active.len(), self.capacity);
        for i in 0..n {
            let row = &self.factor[i * stride..][..=i];
            self.work[i] = (self.work[i] - dot(&row[..i], &self.work[..i])) / row[i];
        }
        // Row by row here too: what is solved is taken out of all that comes after it at once.
        for i in (0..n).rev() {
            let row = &self.factor[i * stride..][..=i];
            let (before, rest) = self.work.split_at_mut(i);
            rest[0] /= row[i];
            for (x, l) in before.iter_mut().zip(row) {
                *x -= l * rest[0];
            }
        }
    }

    /// One step of iterative refinement on the active set: takes out what the factor's rounding
    /// left, which matters for nearly parallel rows.
    fn refine(&mut self, problem: &Problem<'_>, solution: &mut Solution) {
        let y = problem.primal(&solution.lambda);
        for (k, &i) in self.active.iter().enumerate() {
            self.work[k] = -problem.slack(i, &solution.lambda, &y);
        }
        self.substitute();
        for (k, &i) in self.active.iter().enumerate() {
            solution.lambda[i] = fmax(0.0, solution.lambda[i] + self.work[k]);
        }
    }

    /// The free row whose slack is the most negative, if it is under `-tolerance`.
    fn most_violated(
        &mut self,
        problem: &Problem<'_>,
        solution: &Solution,
        tolerance: f64,
    ) -> Option<usize> {
        let m = problem.rows.len();
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
            // Only active rows bear load; C is symmetric, so its rows are its columns.
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
            // Nothing is loaded: the slack is the bias.
            for (i, (row, _)) in free {
                look(i, row.bias);
            }
        } else {
            // The slack again, without asking every row for the tissue: this is where most of a solve goes.
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
        }
        loop {
            if self.block.is_empty() {
                let tolerance = base_tolerance + ROUNDING * largest;
                let Some(worst) = self.most_violated(problem, solution, tolerance) else {
                    // Refine, and look once more with the cleaner numbers.
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
                }
            }
            if problem.tissue.is_none() && self.active.len() == MANY {
                solution.lambda.fill(0.0);
                self.rigid.solve(problem, solution);
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
                // How far towards `work` before the first multiplier reaches zero.
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
            // Something moved: rows barred earlier may try again.
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
