//! Solver of the problem without tissue, in the six unknowns of each tool instead of the multipliers.
//!
//! Without `C` the multipliers are `lambda_i = max(0, -g_i) / eps` with `g_i = b_i + a_i y`. Then `y` minimises the
//! convex, piecewise quadratic function
//!
//! `f(y) = 1/2 |y|^2 + 1/(2 eps) sum min(0, b_i + a_i y)^2`.
//!
//! Rows of different tools are independent. Newton's method on the active set `P = {g_i < 0}` solves
//! `(eps I + A_P' A_P) y = -A_P' b_P`. With an exact line search the method ends after finitely many steps
//! (Mangasarian, A finite Newton method for classification, Optimization Methods and Software 17, 2002).
//!
//! A step costs O(m), whatever the number of active rows. A flat tool on a flat face, with hundreds of loaded rows, is
//! no harder than a tip.

#![allow(
    clippy::needless_range_loop,
    reason = "matrix indices read as in the mathematics"
)]

use super::{Problem, Solution, SolveStatus, dot6};
use crate::math::fmax;

/// Scratch of the solver without tissue: gaps at the present `y`, and their rates along the step.
#[derive(Debug)]
pub(super) struct RigidScratch {
    /// Gap `b_i + a_i y` of each row, metres, negative for a violation; 0 for the rows of the other tool.
    gaps: Vec<f64>,
    /// Rate `a_i step` of each gap along the whole step, metres; 0 for the rows of the other tool.
    rates: Vec<f64>,
    /// Number of rows visited in the present solve.
    visited: u64,
}

/// Relative rounding error of a gap: a few units in the last place of its summands.
const GAP_ROUNDING: f64 = 1e-15;
/// Number of refinement steps of the final multipliers.
const REFINEMENTS: u32 = 2;
/// Maximum number of steps of the exact line search. Each step passes at least one kink or halves the bracket.
const LINE_SEARCH_STEPS: u32 = 64;

/// The six scaled unknowns of one tool, or numbers by them: translation, then rotation.
type Six = [f64; 6];

impl RigidScratch {
    pub fn with_capacity(capacity: usize) -> Self {
        Self {
            gaps: Vec::with_capacity(capacity),
            rates: Vec::with_capacity(capacity),
            visited: 0,
        }
    }

    /// Solves the problem of each tool. `solution.lambda` must hold one zero per row on entry. The status is
    /// [`SolveStatus::Solved`] only if all tools are solved. Returns the number of rows visited.
    pub fn solve(&mut self, problem: &Problem<'_>, solution: &mut Solution) -> u64 {
        self.visited = 0;
        solution.status = SolveStatus::Solved;
        for tool in 0..crate::MAX_TOOLS {
            if problem.rows.iter().any(|row| usize::from(row.tool) == tool) {
                solution.status = self.solve_tool(problem, tool, solution);
                if solution.status != SolveStatus::Solved {
                    return self.visited;
                }
            }
        }
        solution.y = problem.primal(&solution.lambda);
        self.visited
    }

    /// Solves the problem of the tool slot `tool` by Newton's method and writes the tool's multipliers. Returns the
    /// status.
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
            // A whole step without a change of sign in any row reaches the minimum of its piece, which is the global
            // minimum. The rest of the gradient is rounding.
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

    /// Computes gaps, gradient and Hessian of the objective at `y` (sqrt(J)), both derivatives times `eps`, for the
    /// rows of one tool. Compares the signs of the gaps with those of the previous point.
    fn at(&mut self, problem: &Problem<'_>, tool: usize, y: &Six) -> Local {
        let eps = problem.contact_compliance;
        let mut local = Local {
            gradient: y.map(|x| eps * x),
            hessian: [[0.0; 6]; 6],
            norm: 0.0,
            rounding: 0.0,
            changed: false,
        };
        // A row in violation takes about three times as long, and most rows are.
        self.visited += 3 * problem.rows.len() as u64;
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

    /// Computes the multipliers `lambda_i = -g_i / eps` (newtons) of the violated rows from their gaps `g_i`, and
    /// refines them. `g_i` is a small difference of large numbers. The solution of `(A A' + eps I) delta = residual`
    /// restores the lost digits (Woodbury, six by six). `factor` is that of [`factorise`].
    fn multipliers(
        &mut self,
        problem: &Problem<'_>,
        tool: usize,
        factor: &[Six; 6],
        solution: &mut Solution,
    ) {
        let eps = problem.contact_compliance;
        self.visited += 4 * u64::from(REFINEMENTS) * problem.rows.len() as u64;
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

    /// Returns the share of `step`, 0 to 1, at which the derivative of the objective along the step vanishes; 1 if the
    /// derivative stays negative. The derivative is piecewise linear and rising. Newton steps are kept inside a bracket
    /// of the root.
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
                // At a kink, rows that are about to be violated count.
                if at < 0.0 || (at == 0.0 && *rate < 0.0) {
                    slope += at * rate;
                    curvature += rate * rate;
                }
            }
            (slope, curvature)
        };
        let (mut low, mut high, mut t) = (0.0, 1.0, 1.0);
        for _ in 0..LINE_SEARCH_STEPS {
            self.visited += problem.rows.len() as u64;
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
            // A Newton step on a rising, piecewise linear function may leave the bracket at a kink: bisect.
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

/// Derivatives of the objective by the six unknowns of one tool at a point, both times `eps`.
struct Local {
    /// Gradient times `eps`.
    gradient: Six,
    /// Lower half of `A_P' A_P` over the violated rows `P`: the Hessian times `eps`, without `eps I`.
    hessian: [Six; 6],
    /// Largest absolute entry of the gradient.
    norm: f64,
    /// Estimate of the largest gradient entry, times `eps`, that rounding leaves at the solution.
    rounding: f64,
    /// Whether a row changed between violated and not violated since the previous point.
    changed: bool,
}

/// Returns the lower Cholesky factor of `eps I + l`, given the lower half of `l`; `None` when that matrix is not
/// positive definite.
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

/// Solves `L L' x = b` for the Cholesky factor `l`; `x` holds `b` on entry.
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
