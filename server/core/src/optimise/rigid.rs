//! The problem without tissue, in the six unknowns of each tool rather than in its multipliers.
//!
//! Without `C` the multipliers are `lambda_i = max(0, -g_i) / eps` with `g_i = b_i + a_i y`, so `y`
//! minimises the convex, piecewise quadratic
//!
//! `f(y) = 1/2 |y|^2 + 1/(2 eps) sum min(0, b_i + a_i y)^2`,
//!
//! and rows of different tools share nothing. Newton's method on the active set `P = {g_i < 0}`
//! solves `(eps I + A_P' A_P) y = -A_P' b_P`; with an exact line search it ends after finitely many
//! steps (Mangasarian, A finite Newton method for classification, Optimization Methods and Software
//! 17, 2002). A step costs O(m), whatever the number of active
//! rows: a flat tool on a flat face, with hundreds of rows that bear load, is no harder than a tip.

#![allow(
    clippy::needless_range_loop,
    reason = "matrix indices read as in the mathematics"
)]

use super::{Problem, Solution, SolveStatus, dot6};
use crate::math::fmax;

/// Scratch: gaps at the present `y`, and their rates along the step.
#[derive(Debug)]
pub(super) struct RigidScratch {
    gaps: Vec<f64>,
    rates: Vec<f64>,
}

/// Rounding of a gap, per unit of what it is summed from: a few units in the last place.
const GAP_ROUNDING: f64 = 1e-15;
/// Rounds of refinement of the multipliers at the end.
const REFINEMENTS: u32 = 2;
/// Steps of the exact line search; each passes at least one kink or halves the bracket.
const LINE_SEARCH_STEPS: u32 = 64;

type Six = [f64; 6];

impl RigidScratch {
    pub fn with_capacity(capacity: usize) -> Self {
        Self {
            gaps: Vec::with_capacity(capacity),
            rates: Vec::with_capacity(capacity),
        }
    }

    /// Solves each tool's problem. `solution.lambda` has one zero per row on entry.
    pub fn solve(&mut self, problem: &Problem<'_>, solution: &mut Solution) {
        solution.status = SolveStatus::Solved;
        for tool in 0..crate::MAX_TOOLS {
            if problem.rows.iter().any(|row| usize::from(row.tool) == tool) {
                solution.status = self.solve_tool(problem, tool, solution);
                if solution.status != SolveStatus::Solved {
                    return;
                }
            }
        }
        solution.y = problem.primal(&solution.lambda);
    }

    fn solve_tool(
        &mut self,
        problem: &Problem<'_>,
        tool: usize,
        solution: &mut Solution,
    ) -> SolveStatus {
        let eps = problem.contact_compliance;
        let mut y = [0.0; 6];
        let mut local = self.at(problem, tool, &y);
        let mut whole_step = false;
        loop {
            if !local.norm.is_finite() {
                return SolveStatus::NumericalError;
            }
            let Some(factor) = factorise(local.hessian, eps) else {
                return SolveStatus::NumericalError;
            };
            // A whole step that changes no row's side lands on the minimum of its piece, which is the
            // minimum: what is left of the gradient is rounding.
            if local.norm <= local.rounding || (whole_step && !local.changed) {
                self.multipliers(problem, tool, &factor, solution);
                return SolveStatus::Solved;
            }
            solution.iterations += 1;
            if solution.iterations as usize > problem.max_iterations {
                return SolveStatus::IterationLimit;
            }
            let step = substitute(&factor, local.gradient.map(|g| -g));
            let share = self.line_search(problem, tool, &y, &step);
            for (x, s) in y.iter_mut().zip(&step) {
                *x += share * s;
            }
            whole_step = share == 1.0;
            local = self.at(problem, tool, &y);
        }
    }

    /// Gaps, gradient and Hessian (both times eps) at `y`; knows the gaps of the point before.
    fn at(&mut self, problem: &Problem<'_>, tool: usize, y: &Six) -> Local {
        let eps = problem.contact_compliance;
        let mut local = Local {
            gradient: y.map(|x| eps * x),
            hessian: [[0.0; 6]; 6],
            norm: 0.0,
            rounding: 0.0,
            changed: false,
        };
        self.gaps.resize(problem.rows.len(), 0.0);
        for (row, kept) in problem.rows.iter().zip(&mut self.gaps) {
            if usize::from(row.tool) != tool {
                *kept = 0.0;
                continue;
            }
            let gap = row.bias + dot6(&row.a, y);
            local.changed |= (gap < 0.0) != (*kept < 0.0);
            *kept = gap;
            if gap < 0.0 {
                let (mut size, mut lever) = (row.bias.abs(), 0.0);
                for i in 0..6 {
                    local.gradient[i] += gap * row.a[i];
                    size += (row.a[i] * y[i]).abs();
                    lever = fmax(lever, row.a[i].abs());
                    for j in 0..=i {
                        local.hessian[i][j] += row.a[i] * row.a[j];
                    }
                }
                local.rounding += GAP_ROUNDING * size * lever;
            }
        }
        local.norm =
            local.gradient.iter().fold(
                0.0,
                |most, x| if x.is_nan() { *x } else { fmax(most, x.abs()) },
            );
        local.rounding += y
            .iter()
            .fold(0.0, |most, x| fmax(most, GAP_ROUNDING * eps * x.abs()));
        local
    }

    /// `lambda_i = -g_i / eps` on the active set, refined: `g_i` is a small difference of large
    /// numbers, and `(A A' + eps I) delta = residual` takes out what it lost (Woodbury, six by six).
    fn multipliers(
        &self,
        problem: &Problem<'_>,
        tool: usize,
        factor: &[Six; 6],
        solution: &mut Solution,
    ) {
        let eps = problem.contact_compliance;
        let active = |i: usize| usize::from(problem.rows[i].tool) == tool && self.gaps[i] < 0.0;
        for i in 0..problem.rows.len() {
            if active(i) {
                solution.lambda[i] = -self.gaps[i] / eps;
            }
        }
        for _ in 0..REFINEMENTS {
            let y = problem.primal(&solution.lambda);
            let residual = |i: usize, lambda: &[f64]| -problem.slack(i, lambda, &y);
            let mut projected = [0.0; 6];
            for i in (0..problem.rows.len()).filter(|&i| active(i)) {
                let r = residual(i, &solution.lambda);
                for (sum, a) in projected.iter_mut().zip(&problem.rows[i].a) {
                    *sum += a * r;
                }
            }
            let t = substitute(factor, projected);
            for i in (0..problem.rows.len()).filter(|&i| active(i)) {
                let delta = (residual(i, &solution.lambda) - dot6(&problem.rows[i].a, &t)) / eps;
                solution.lambda[i] = fmax(0.0, solution.lambda[i] + delta);
            }
        }
    }

    /// Where the derivative of `f` along `step` vanishes, from 0 towards 1. The derivative is
    /// piecewise linear and rising, so secants from the right never overshoot to the left of the root's piece.
    fn line_search(
        &mut self,
        problem: &Problem<'_>,
        tool: usize,
        y: &[f64; 6],
        step: &[f64; 6],
    ) -> f64 {
        let eps = problem.contact_compliance;
        self.rates.clear();
        for row in problem.rows {
            self.rates.push(if usize::from(row.tool) == tool {
                dot6(&row.a, step)
            } else {
                0.0
            });
        }
        let along = |t: f64| {
            let (mut slope, mut curvature) = (0.0, 0.0);
            for k in 0..6 {
                slope += eps * (y[k] + t * step[k]) * step[k];
                curvature += eps * step[k] * step[k];
            }
            for (gap, rate) in self.gaps.iter().zip(&self.rates) {
                let at = gap + t * rate;
                // At a kink the rows that are about to be violated count.
                if at < 0.0 || (at == 0.0 && *rate < 0.0) {
                    slope += at * rate;
                    curvature += rate * rate;
                }
            }
            (slope, curvature)
        };
        let (mut low, mut high, mut t) = (0.0, 1.0, 1.0);
        for _ in 0..LINE_SEARCH_STEPS {
            let (slope, curvature) = along(t);
            if slope <= 0.0 {
                if t >= 1.0 {
                    return 1.0;
                }
                low = t;
            } else {
                high = t;
            }
            let next = t - slope / curvature;
            // Newton on a rising piecewise linear function may leave the bracket at a kink: halve.
            let next = if next > low && next < high {
                next
            } else {
                0.5 * (low + high)
            };
            if (next - t).abs() <= 1e-12 * high {
                return next;
            }
            t = next;
        }
        t
    }
}

/// Derivatives at a point, both times eps.
struct Local {
    gradient: Six,
    /// Lower half of `A_P' A_P`.
    hessian: [Six; 6],
    /// Largest entry of the gradient.
    norm: f64,
    /// What rounding can leave of it at the solution.
    rounding: f64,
    /// Whether a row changed sides since the point before.
    changed: bool,
}

/// Lower Cholesky factor of `eps I + hessian`.
fn factorise(mut l: [Six; 6], eps: f64) -> Option<[Six; 6]> {
    for i in 0..6 {
        l[i][i] += eps;
        for j in 0..=i {
            let mut entry = l[i][j];
            for k in 0..j {
                entry -= l[i][k] * l[j][k];
            }
            if i == j {
                if entry.is_nan() || entry <= 0.0 {
                    return None;
                }
                l[i][i] = entry.sqrt();
            } else {
                l[i][j] = entry / l[j][j];
            }
        }
    }
    Some(l)
}

/// Solves `L L' x = b`.
fn substitute(l: &[Six; 6], mut x: Six) -> Six {
    for i in 0..6 {
        for k in 0..i {
            x[i] -= l[i][k] * x[k];
        }
        x[i] /= l[i][i];
    }
    for i in (0..6).rev() {
        for k in i + 1..6 {
            x[i] -= l[k][i] * x[k];
        }
        x[i] /= l[i][i];
    }
    x
}
