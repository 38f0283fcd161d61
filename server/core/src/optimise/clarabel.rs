//! The judge: the same problem through Clarabel's interior point (doi:10.48550/arXiv.2405.12762).
//!
//! Works in millimetres, where its default tolerances mean 5e-5 mm instead of 2e-3. It allocates
//! and reads a clock for its own statistics (no time limit is set, so the clock decides nothing):
//! the one exception to the core's rules, never used in a tick unless the scene asks for it.

use clarabel::algebra::CscMatrix;
use clarabel::solver::{
    DefaultSettings, DefaultSolution, DefaultSolver, IPSolver, SolverStatus, SupportedConeT,
};

use super::{ContactSolver, Problem, Solution, SolveStatus, UNKNOWNS};
use crate::math::fmax;

/// Clarabel behind the solver interface. Stateless.
#[derive(Clone, Copy, Debug, Default)]
pub struct Clarabel;

/// Tolerances, tried in turn. Clarabel's defaults (1e-8) leave 2e-2 mm on grossly infeasible sets, 1e-12 is out of its reach;
/// and where rows oppose one another (`opposed-0`) one problem of a hundred ends in insufficient progress at 1e-11 and is
/// solved at 1e-10. What is not solved at any of them has no answer.
const TOLERANCES: [f64; 3] = [1e-11, 1e-10, 1e-9];

/// Millimetres per metre.
const MM: f64 = 1e3;

impl ContactSolver for Clarabel {
    /// Variables `x = (y, z)`: minimise `1/2 |y|^2 + 1/2 |z|^2` subject to `b + A y + L z >= 0`
    /// with `L L' = C + eps I`. The multipliers of the rows are lambda.
    fn solve(&mut self, problem: &Problem<'_>, solution: &mut Solution) {
        let m = problem.rows.len();
        solution.lambda.clear();
        solution.lambda.resize(m, 0.0);
        solution.y.fill(0.0);
        solution.iterations = 0;
        solution.status = SolveStatus::NumericalError;
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
        solution.status = match found.status {
            SolverStatus::Solved => SolveStatus::Solved,
            SolverStatus::MaxIterations => SolveStatus::IterationLimit,
            _ => SolveStatus::NumericalError,
        };
        if found.x.iter().chain(&found.z).any(|x| !x.is_finite()) {
            solution.status = SolveStatus::NumericalError;
            return;
        }
        let root = MM.sqrt();
        for (y, x) in solution.y.iter_mut().zip(&found.x) {
            // Adding +0.0 turns -0.0 into 0.0.
            *y = x / root + 0.0;
        }
        for (lambda, z) in solution.lambda.iter_mut().zip(&found.z) {
            *lambda = fmax(0.0, *z) + 0.0;
        }
    }
}

/// One run of the solver; none where it refuses the problem.
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

/// `[-A, -L]` in compressed columns, millimetres and newtons.
fn constraint_matrix(problem: &Problem<'_>, factor: &Factor, n: usize) -> CscMatrix<f64> {
    let m = problem.rows.len();
    // y is sqrt(J): lengths scale by 1e3 and stiffness by 1e-3, so a scales by sqrt(1e3).
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

/// Cholesky factor of `C + eps I`, mm/N.
enum Factor {
    Diagonal(f64),
    Dense(Vec<f64>),
}

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
