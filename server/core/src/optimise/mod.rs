//! Contact problem of a substep, and two solvers behind one interface.
//!
//! In G-scaled coordinates `y` (twelve unknowns, six per tool), relative to the unconstrained optimum:
//!
//! minimise `1/2 |y|^2 + 1/2 lambda' (C + eps I) lambda` subject to
//! `w = b + A y + (C + eps I) lambda >= 0`, whose dual is the linear complementarity problem
//!
//! `0 <= lambda  ⟂  w = H lambda + b >= 0`, `H = A A' + C + eps I`, `y = A' lambda`.
//!
//! - `A` (m x 12): one row per contact row.
//! - `b`: gaps at the unconstrained optimum, metres.
//! - `C` (m x m): compliance of the tissue along the normals, m/N.
//! - `eps`: contact compliance, m/N, which keeps every row set feasible.
//!
//! Source: Eq. 18 to 20 of the paper, with the tissue inside.

pub mod active_set;
pub mod audit;
pub mod clarabel;
mod rigid;

use serde::{Deserialize, Serialize};

use crate::MAX_TOOLS;
use crate::math::{fmax, fmin};

/// Number of unknowns of the problem: six for each tool.
pub const UNKNOWNS: usize = 6 * MAX_TOOLS;

/// Solver of the contact problem.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SolverKind {
    /// Dual active-set solver of this crate: no allocation, deterministic. Default in the tick.
    ActiveSet,
    /// Interior-point solver Clarabel, the reference in audits. Allocates, and reads a clock for its own statistics.
    Clarabel,
}

/// Problem row: one row of the matrix `A` with its bias `b`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProblemRow {
    /// Nonzero part of the row of `A`, m/sqrt(J): derivative of the gap by the six scaled unknowns of the tool,
    /// translation, then rotation. Scaled unknowns have the unit sqrt(J); in them the metric of the substep is the
    /// identity.
    pub a: [f64; 6],
    /// Slot of the tool whose six unknowns the row acts on.
    pub tool: u8,
    /// Linearised gap after the step that tool and tissue would make without contact, metres.
    pub bias: f64,
}

/// Contact problem of one substep: one inequality `w >= 0` per row, solved for one multiplier per row.
#[derive(Clone, Copy, Debug)]
pub struct Problem<'a> {
    /// Problem rows, at most the capacity of the solver.
    pub rows: &'a [ProblemRow],
    /// Compliance `C` of the tissue along the rows' normals, row-major m x m, metres per newton; `None` when no touched
    /// object yields.
    pub tissue: Option<&'a [f64]>,
    /// Contact compliance `eps`, added on the diagonal of every row, metres per newton; positive.
    pub contact_compliance: f64,
    /// Warm start: indices of the rows that bore load in the previous similar problem. Does not affect the solution.
    pub warm_start: &'a [u32],
    /// Maximum number of iterations of the active-set solver; Clarabel has its own limit.
    pub max_iterations: usize,
}

/// Result status of a solve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SolveStatus {
    /// The solution satisfies the optimality conditions.
    Solved,
    /// The iteration limit was reached. The iterate is infeasible and must not be applied.
    IterationLimit,
    /// The solve failed numerically. The iterate must not be applied.
    NumericalError,
}

/// Solution of a problem, usable only with [`SolveStatus::Solved`].
#[derive(Clone, Debug)]
pub struct Solution {
    /// Multipliers, newtons, one per row. The capacity is that of the solver.
    pub lambda: Vec<f64>,
    /// Step `A' lambda` relative to the step without contact, in scaled unknowns, sqrt(J): six per tool slot,
    /// translation, then rotation.
    pub y: [f64; UNKNOWNS],
    /// Result status.
    pub status: SolveStatus,
    /// Number of iterations.
    pub iterations: u32,
}

impl Solution {
    /// Returns an empty solution with capacity for `capacity` rows.
    pub fn with_capacity(capacity: usize) -> Self {
        Self {
            lambda: Vec::with_capacity(capacity),
            y: [0.0; UNKNOWNS],
            status: SolveStatus::Solved,
            iterations: 0,
        }
    }
}

/// Solver of [`Problem`]s with its own scratch. No content of the scratch outlives a solve.
pub trait ContactSolver {
    /// Solves `problem` and writes the result to `solution`.
    fn solve(&mut self, problem: &Problem<'_>, solution: &mut Solution);
}

impl Problem<'_> {
    /// Returns the compliance `C_ij` of the tissue between rows `i` and `j`, metres per newton; 0 without tissue.
    #[inline]
    pub fn tissue_at(&self, i: usize, j: usize) -> f64 {
        self.tissue.map_or(0.0, |c| c[i * self.rows.len() + j])
    }

    /// Returns the dual matrix `H_ij = a_i . a_j + C_ij + eps delta_ij` of rows `i` and `j`, metres per newton.
    #[inline]
    pub fn gram(&self, i: usize, j: usize) -> f64 {
        let (a, b) = (&self.rows[i], &self.rows[j]);
        let geometry = if a.tool == b.tool {
            dot6(&a.a, &b.a)
        } else {
            0.0
        };
        geometry + self.tissue_at(i, j) + if i == j { self.contact_compliance } else { 0.0 }
    }

    /// Returns the slack of row `i`, `w_i = b_i + a_i y + ((C + eps I) lambda)_i`, metres. Negative is a violation.
    /// `lambda` has the multipliers (newtons), `y` the scaled step (sqrt(J)).
    #[inline]
    pub fn slack(&self, i: usize, lambda: &[f64], y: &[f64; UNKNOWNS]) -> f64 {
        let mut w = self.rigid_slack(i, lambda, y);
        if let Some(c) = self.tissue {
            let m = self.rows.len();
            w += dot(&c[i * m..(i + 1) * m], lambda);
        }
        w
    }

    /// Returns the slack of row `i` without the part of the tissue, metres: `b_i + a_i y + eps lambda_i`.
    #[inline]
    pub(crate) fn rigid_slack(&self, i: usize, lambda: &[f64], y: &[f64; UNKNOWNS]) -> f64 {
        let row = &self.rows[i];
        row.bias + dot6(&row.a, y_of(y, row.tool)) + self.contact_compliance * lambda[i]
    }

    /// Returns the scaled step `y = A' lambda`, sqrt(J), for the multipliers `lambda` in newtons.
    #[inline]
    pub fn primal(&self, lambda: &[f64]) -> [f64; UNKNOWNS] {
        let mut y = [0.0; UNKNOWNS];
        for (row, load) in self.rows.iter().zip(lambda) {
            if *load != 0.0 {
                let base = 6 * usize::from(row.tool);
                for k in 0..6 {
                    y[base + k] += row.a[k] * load;
                }
            }
        }
        y
    }

    /// Returns the largest absolute bias, metres: the scale of the tolerances.
    pub fn scale(&self) -> f64 {
        self.rows
            .iter()
            .fold(0.0, |scale, row| fmax(scale, row.bias.abs()))
    }

    /// Returns the residual of the optimality conditions, `max_i |min(H_ii lambda_i, w_i)|` relative to the largest
    /// `|b_i|`. `lambda` has the multipliers, newtons; `w_i` is the slack.
    ///
    /// The residual is zero exactly at the solution. `w` is evaluated from the rows, not from values cached by a
    /// solver. Without a nonzero bias the residual is absolute, metres.
    pub fn kkt_residual(&self, lambda: &[f64]) -> f64 {
        let y = self.primal(lambda);
        let (mut worst, scale) = (0.0, self.scale());
        for (i, load) in lambda.iter().enumerate() {
            let force = self.gram(i, i) * load;
            worst = fmax(worst, fmin(force, self.slack(i, lambda, &y)).abs());
        }
        if scale > 0.0 { worst / scale } else { worst }
    }
}

/// Returns the six scaled unknowns of the tool slot `tool`.
#[inline]
fn y_of(y: &[f64; UNKNOWNS], tool: u8) -> &[f64] {
    &y[6 * usize::from(tool)..][..6]
}

/// Returns the inner product of two lists of equal length, accumulated in four parallel sums.
#[inline]
pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    debug_assert_eq!(a.len(), b.len());
    let ((a, a_rest), (b, b_rest)) = (a.as_chunks::<4>(), b.as_chunks::<4>());
    let mut sums = [0.0; 4];
    for (a, b) in a.iter().zip(b) {
        for k in 0..4 {
            sums[k] += a[k] * b[k];
        }
    }
    let rest = a_rest
        .iter()
        .zip(b_rest)
        .fold(0.0, |sum, (a, b)| sum + a * b);
    (sums[0] + sums[1]) + (sums[2] + sums[3]) + rest
}

/// Returns the inner product of `a` with the first six numbers of `b`, summed in index order.
#[inline]
pub fn dot6(a: &[f64; 6], b: &[f64]) -> f64 {
    let b = &b[..6];
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3] + a[4] * b[4] + a[5] * b[5]
}
