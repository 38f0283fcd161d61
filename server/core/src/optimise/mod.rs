//! The one small problem of a tick, and two solvers behind one interface.
//!
//! In G-scaled coordinates `y` (twelve: six per tool), relative to the unconstrained optimum:
//!
//! minimise `1/2 |y|^2 + 1/2 lambda' (C + eps I) lambda` subject to
//! `w = b + A y + (C + eps I) lambda >= 0`, whose dual is the linear complementarity problem
//!
//! `0 <= lambda  ⟂  w = H lambda + b >= 0`, `H = A A' + C + eps I`, `y = A' lambda`.
//!
//! `A` (m x 12) holds one row per sphere pair, `b` the gaps at the unconstrained optimum (metres),
//! `C` (m x m) the tissue's compliance along the normals (m/N), `eps` the contact compliance (m/N)
//! that keeps every row set feasible. Paper: Eq. 18 to 20, with the tissue inside.

pub mod active_set;
pub mod audit;
pub mod clarabel;
mod rigid;

use serde::{Deserialize, Serialize};

use crate::MAX_TOOLS;
use crate::math::{fmax, fmin};

/// Unknowns of the problem: six for each tool.
pub const UNKNOWNS: usize = 6 * MAX_TOOLS;

/// Which solver answers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SolverKind {
    /// Own dual active set: no allocation, deterministic, runs the tick.
    ActiveSet,
    /// Clarabel's interior point: the judge. Allocates, reads a clock for its own statistics.
    Clarabel,
}

/// One row of `A` with its bias.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProblemRow {
    /// Nonzero part of the row, in G-scaled coordinates: translation, then rotation.
    pub a: [f64; 6],
    /// Which tool's six unknowns it acts on.
    pub tool: u8,
    /// Gap at the unconstrained optimum, metres.
    pub bias: f64,
}

/// The problem of one collision pass.
#[derive(Clone, Copy, Debug)]
pub struct Problem<'a> {
    /// Rows, at most the capacity the solver was made for.
    pub rows: &'a [ProblemRow],
    /// `C`, row-major m x m, metres per newton; `None` when nothing touched yields.
    pub tissue: Option<&'a [f64]>,
    /// `eps`, metres per newton; positive.
    pub contact_compliance: f64,
    /// Rows that bore load when a problem like this was solved a moment ago: where a solver may begin. Does
    /// not change where it ends.
    pub warm_start: &'a [u32],
    /// Iteration cap.
    pub max_iterations: usize,
}

/// How a solve ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SolveStatus {
    /// The answer satisfies the conditions.
    Solved,
    /// The cap was reached: the iterate is infeasible and must not be applied.
    IterationLimit,
    /// Numbers broke down: nothing may be applied.
    NumericalError,
}

/// An answer. Usable only when the status says so.
#[derive(Clone, Debug)]
pub struct Solution {
    /// Multipliers, newtons, one per row (capacity: the solver's).
    pub lambda: Vec<f64>,
    /// `A' lambda`, the step relative to the unconstrained optimum, G-scaled.
    pub y: [f64; UNKNOWNS],
    /// How it ended.
    pub status: SolveStatus,
    /// Iterations used.
    pub iterations: u32,
}

impl Solution {
    /// Room for `capacity` rows.
    pub fn with_capacity(capacity: usize) -> Self {
        Self {
            lambda: Vec::with_capacity(capacity),
            y: [0.0; UNKNOWNS],
            status: SolveStatus::Solved,
            iterations: 0,
        }
    }
}

/// A solver of [`Problem`]s; holds its own scratch, nothing of which outlives a solve.
pub trait ContactSolver {
    /// Solves `problem` into `solution`.
    fn solve(&mut self, problem: &Problem<'_>, solution: &mut Solution);
}

impl Problem<'_> {
    /// `C_ij` of the tissue, 0 where nothing yields.
    #[inline]
    pub fn tissue_at(&self, i: usize, j: usize) -> f64 {
        self.tissue.map_or(0.0, |c| c[i * self.rows.len() + j])
    }

    /// `H_ij`.
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

    /// `w_i = b_i + a_i y + ((C + eps I) lambda)_i`, metres.
    #[inline]
    pub fn slack(&self, i: usize, lambda: &[f64], y: &[f64; UNKNOWNS]) -> f64 {
        let mut w = self.rigid_slack(i, lambda, y);
        if let Some(c) = self.tissue {
            let m = self.rows.len();
            w += dot(&c[i * m..(i + 1) * m], lambda);
        }
        w
    }

    /// The same without the tissue's part.
    #[inline]
    pub(crate) fn rigid_slack(&self, i: usize, lambda: &[f64], y: &[f64; UNKNOWNS]) -> f64 {
        let row = &self.rows[i];
        row.bias + dot6(&row.a, y_of(y, row.tool)) + self.contact_compliance * lambda[i]
    }

    /// `A' lambda`.
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

    /// Largest absolute bias, metres: the scale that tolerances refer to.
    pub fn scale(&self) -> f64 {
        self.rows
            .iter()
            .fold(0.0, |scale, row| fmax(scale, row.bias.abs()))
    }

    /// How far `lambda` is from a solution: `max_i |min(H_ii lambda_i, w_i)|` relative to the
    /// largest `|b_i|`. Zero exactly at the solution. `w` is evaluated from the rows, not from
    /// anything a solver kept.
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

#[inline]
fn y_of(y: &[f64; UNKNOWNS], tool: u8) -> &[f64] {
    &y[6 * usize::from(tool)..][..6]
}

/// Inner product of two lists of one length, in four sums at once.
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

/// Inner product of six numbers, in index order.
#[inline]
pub fn dot6(a: &[f64; 6], b: &[f64]) -> f64 {
    let b = &b[..6];
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3] + a[4] * b[4] + a[5] * b[5]
}
