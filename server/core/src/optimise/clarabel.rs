//! Reference solver: the contact problem through Clarabel's interior point (doi:10.48550/arXiv.2405.12762).
//!
//! The solver works in millimetres, where its default tolerances mean 5e-5 mm instead of 2e-3 mm. This module is the
//! one exception to the core's rules: it allocates, and reads a clock for its own statistics. No time limit is set, so
//! the clock affects no result. A tick uses this solver only if the scene selects it.

use clarabel::algebra::CscMatrix;
use clarabel::solver::{
    DefaultSettings, DefaultSolution, DefaultSolver, IPSolver, SolverStatus, SupportedConeT,
};

use super::{ContactSolver, Problem, ProblemRow, Solution, SolveStatus, UNKNOWNS};
use crate::math::fmax;

/// Clarabel behind the solver interface, with rows added when they are violated. Of hundreds of rows one or two dozen
/// bear load. With tissue the work of the interior point grows with the cube of the number of rows. The result is that
/// of [`AllRows`]. Stateless.
#[derive(Clone, Copy, Debug, Default)]
pub struct Clarabel;

/// Clarabel with all rows from the start.
#[derive(Clone, Copy, Debug, Default)]
pub struct AllRows;

/// Maximum number of rows added per round, the most violated first; the current number of rows if that is larger.
const BATCH: usize = 16;

/// Round from which open rows without load are no longer dropped. In exact arithmetic the cost of the solution grows
/// with each round, so no row set recurs. Rounding can break this rule, hence the limit.
const DROPPING: u32 = 20;
/// Load under which a row counts as unloaded, as a share of the largest load.
const NOTHING: f64 = 1e-9;
/// Slack (gap after the step) from which a row counts as open, metres.
const OPEN: f64 = 1e-8;

/// Tolerated violation of a left-out row, metres: a hundredth of the violation that a solution leaves in its own rows.
const VIOLATED: f64 = 1e-13;

/// Tolerances of Clarabel, tried in turn. A problem not solved at any of them has no solution.
///
/// - Clarabel's default, 1e-8, leaves 2e-2 mm on grossly infeasible sets.
/// - 1e-12 is out of Clarabel's reach.
/// - With opposed rows (`opposed-0`) one problem of a hundred ends in insufficient progress at 1e-11, and is solved at
///   1e-10.
const TOLERANCES: [f64; 3] = [1e-11, 1e-10, 1e-9];

/// Millimetres per metre.
const MM: f64 = 1e3;

impl ContactSolver for AllRows {
    fn solve(&mut self, problem: &Problem<'_>, solution: &mut Solution) {
        reset(solution, problem.rows.len());
        if is_finite(problem) {
            solve_as_it_is(problem, solution);
        }
    }
}

impl ContactSolver for Clarabel {
    fn solve(&mut self, problem: &Problem<'_>, solution: &mut Solution) {
        let m = problem.rows.len();
        reset(solution, m);
        if !is_finite(problem) {
            return;
        }
        let mut part = Part::default();
        let mut answer = Solution::with_capacity(BATCH);
        let (mut iterations, mut rounds) = (0, 0);
        loop {
            if !part.add_violated(problem, &solution.lambda, &solution.y) {
                solution.status = SolveStatus::Solved;
                solution.iterations = iterations;
                return;
            }
            let rows = part.problem(problem);
            reset(&mut answer, rows.rows.len());
            solve_as_it_is(&rows, &mut answer);
            iterations += answer.iterations;
            if answer.status != SolveStatus::Solved {
                // Open rows stabilise a problem: four ticks of `peg-in-hole` have a solution only with them.
                AllRows.solve(problem, solution);
                solution.iterations += iterations;
                return;
            }
            solution.y = answer.y;
            for (i, load) in part.of.iter().zip(&answer.lambda) {
                solution.lambda[*i] = *load;
            }
            rounds += 1;
            if rounds < DROPPING {
                part.drop_open(problem, solution);
            }
        }
    }
}

/// Subset of the rows of a problem: the rows that the interior point sees.
#[derive(Default)]
struct Part {
    /// Indices of the rows in the whole problem, in the order of entry.
    of: Vec<usize>,
    /// Rows of the subset, in the order of `of`.
    rows: Vec<ProblemRow>,
    /// Compliance of the tissue over `of`, row-major, m/N; empty without tissue.
    tissue: Vec<f64>,
}

impl Part {
    /// Adds the most violated rows at the multipliers `lambda` (newtons) and the scaled step `y` (sqrt(J)). Returns
    /// whether any row outside the subset was violated.
    fn add_violated(&mut self, problem: &Problem<'_>, lambda: &[f64], y: &[f64; UNKNOWNS]) -> bool {
        let mut violated: Vec<(f64, usize)> = (0..problem.rows.len())
            .filter(|i| !self.of.contains(i))
            .map(|i| (problem.slack(i, lambda, y), i))
            .filter(|(slack, _)| *slack < -VIOLATED)
            .collect();
        violated.sort_by(|(a, i), (b, j)| a.total_cmp(b).then(i.cmp(j)));
        violated.truncate(BATCH.max(self.of.len()));
        self.of.extend(violated.iter().map(|(_, i)| *i));
        !violated.is_empty()
    }

    /// Drops the rows that have a slack of at least [`OPEN`] and no load, and sets their multipliers to zero.
    fn drop_open(&mut self, problem: &Problem<'_>, solution: &mut Solution) {
        let most = solution.lambda.iter().fold(0.0, |most, x| fmax(most, *x));
        let bears = |i: usize| {
            let load = solution.lambda[i];
            load > NOTHING * most || problem.slack(i, &solution.lambda, &solution.y) < OPEN
        };
        self.of.retain(|i| bears(*i));
        let mut kept = vec![false; solution.lambda.len()];
        for i in &self.of {
            kept[*i] = true;
        }
        for (load, kept) in solution.lambda.iter_mut().zip(kept) {
            if !kept {
                *load = 0.0;
            }
        }
    }

    /// Returns the subset as a problem of its own.
    fn problem<'a>(&'a mut self, all: &Problem<'_>) -> Problem<'a> {
        self.rows.clear();
        self.rows.extend(self.of.iter().map(|i| all.rows[*i]));
        self.tissue.clear();
        if all.tissue.is_some() {
            for i in &self.of {
                let row = self.of.iter().map(|j| all.tissue_at(*i, *j));
                self.tissue.extend(row);
            }
        }
        Problem {
            rows: &self.rows,
            tissue: all.tissue.map(|_| &*self.tissue),
            warm_start: &[],
            ..*all
        }
    }
}

/// Whether every number of the problem is finite. Clarabel accepts a bias that is not finite as a wide open row.
fn is_finite(problem: &Problem<'_>) -> bool {
    let rows = problem.rows.iter().flat_map(|row| {
        let bias = std::iter::once(row.bias);
        bias.chain(row.a)
    });
    let tissue = problem.tissue.unwrap_or_default().iter().copied();
    rows.chain(tissue).all(f64::is_finite)
}

/// Sets the solution to zero for `rows` rows, with the status of a numerical error.
fn reset(solution: &mut Solution, rows: usize) {
    solution.lambda.clear();
    solution.lambda.resize(rows, 0.0);
    solution.y.fill(0.0);
    solution.iterations = 0;
    solution.status = SolveStatus::NumericalError;
}

/// Solves the problem with all of its rows. `solution` must be reset before the call.
///
/// Variables `x = (y, z)`: minimise `1/2 |y|^2 + 1/2 |z|^2` subject to `b + A y + L z >= 0`. `L` is the Cholesky factor
/// of `C + eps I`. The multipliers of the rows are lambda.
fn solve_as_it_is(problem: &Problem<'_>, solution: &mut Solution) {
    let m = problem.rows.len();
    if m == 0 {
        solution.status = SolveStatus::Solved;
        return;
    }
    let Some(factor) = compliance_factor(problem) else {
        return;
    };
    let n = UNKNOWNS + m;
    let a = constraint_matrix(problem, &factor, n);
    let b: Vec<f64> = problem.rows.iter().map(|row| row.bias * MM).collect();
    let tolerances = TOLERANCES.iter();
    let mut tried = tolerances.map_while(|tolerance| attempt((&a, &b), (n, m), *tolerance));
    let Some(mut found) = tried.next() else {
        return;
    };
    let mut iterations = found.iterations;
    while found.status != SolverStatus::Solved
        && let Some(next) = tried.next()
    {
        iterations += next.iterations;
        found = next;
    }
    solution.iterations = iterations;
    if found.x.iter().chain(&found.z).any(|x| !x.is_finite()) {
        return;
    }
    solution.status = match found.status {
        SolverStatus::Solved => SolveStatus::Solved,
        SolverStatus::MaxIterations => SolveStatus::IterationLimit,
        _ => SolveStatus::NumericalError,
    };
    let root = MM.sqrt();
    for (y, x) in solution.y.iter_mut().zip(&found.x) {
        // Adding +0.0 turns -0.0 into 0.0.
        *y = x / root + 0.0;
    }
    for (lambda, z) in solution.lambda.iter_mut().zip(&found.z) {
        *lambda = fmax(0.0, *z) + 0.0;
    }
}

/// Runs Clarabel once on the constraint matrix `a` and the biases `b` (millimetres), with `n` variables and `m` rows.
/// `tolerance` is that of gap and feasibility. Returns `None` when Clarabel refuses the problem.
fn attempt(
    (a, b): (&CscMatrix<f64>, &[f64]),
    (n, m): (usize, usize),
    tolerance: f64,
) -> Option<DefaultSolution<f64>> {
    let settings = DefaultSettings {
        verbose: false,
        max_iter: 200,
        direct_solve_method: "qdldl".to_owned(),
        presolve_enable: false,
        tol_gap_abs: tolerance,
        tol_gap_rel: tolerance,
        tol_feas: tolerance,
        ..DefaultSettings::default()
    };
    let cones = [SupportedConeT::NonnegativeConeT(m)];
    let (identity, zeros) = (CscMatrix::identity(n), vec![0.0; n]);
    let mut solver = DefaultSolver::new(&identity, &zeros, a, b, &cones, settings).ok()?;
    solver.solve();
    Some(solver.solution)
}

/// Returns the `m` x `n` matrix `[-A, -L]` in compressed columns, millimetres and newtons. `L` is the Cholesky factor
/// `factor` of `C + eps I`.
fn constraint_matrix(problem: &Problem<'_>, factor: &Factor, n: usize) -> CscMatrix<f64> {
    let m = problem.rows.len();
    // The unit of `y` is sqrt(J). Lengths scale by 1e3 and stiffness by 1e-3, so `a` scales by sqrt(1e3).
    let root = MM.sqrt();
    let (mut starts, mut rows, mut values) = (vec![0], Vec::new(), Vec::new());
    for column in 0..n {
        if column < UNKNOWNS {
            let (tool, k) = (column / 6, column % 6);
            for (i, row) in problem.rows.iter().enumerate() {
                if usize::from(row.tool) == tool && row.a[k] != 0.0 {
                    rows.push(i);
                    values.push(-row.a[k] * root);
                }
            }
        } else {
            let j = column - UNKNOWNS;
            match factor {
                Factor::Diagonal(eps) => {
                    rows.push(j);
                    values.push(-eps);
                }
                Factor::Dense(l) => {
                    for i in j..m {
                        rows.push(i);
                        values.push(-l[i * m + j]);
                    }
                }
            }
        }
        starts.push(rows.len());
    }
    CscMatrix::new(m, n, starts, rows, values)
}

/// Lower Cholesky factor of `C + eps I`, the compliance of tissue and contact, in sqrt(mm/N).
enum Factor {
    /// Diagonal with this value, without tissue.
    Diagonal(f64),
    /// Row-major m x m, with tissue.
    Dense(Vec<f64>),
}

/// Returns the Cholesky factor of `C + eps I`; `None` if the matrix is not positive definite.
fn compliance_factor(problem: &Problem<'_>) -> Option<Factor> {
    let eps = problem.contact_compliance * MM;
    let Some(c) = problem.tissue else {
        return Some(Factor::Diagonal(eps.sqrt()));
    };
    let m = problem.rows.len();
    let mut l = vec![0.0; m * m];
    for i in 0..m {
        for j in 0..=i {
            let mut entry = c[i * m + j] * MM + if i == j { eps } else { 0.0 };
            for k in 0..j {
                entry -= l[i * m + k] * l[j * m + k];
            }
            l[i * m + j] = if i == j {
                if entry.is_nan() || entry <= 0.0 {
                    return None;
                }
                entry.sqrt()
            } else {
                entry / l[j * m + j]
            };
        }
    }
    Some(Factor::Dense(l))
}
