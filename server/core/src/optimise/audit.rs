//! A second opinion on the last problem of a tick, for `replay --audit` and the tests.

use super::{
    ContactSolver, Solution, SolveStatus, SolverKind, active_set::ActiveSet, clarabel::Clarabel,
};
use crate::math::{Vec3, fmax, norm};
use crate::{MAX_TOOLS, Scene, Workspace};

/// What the other solver says of a tick's last problem.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Verdict {
    /// Residual of the optimality conditions of the tick's own answer, relative
    /// ([`super::Problem::kkt_residual`]).
    pub kkt_residual: f64,
    /// Whether the other solver answered at all.
    pub judge_solved: bool,
    /// Largest distance between the two answers' working points, metres; 0 when the judge did not answer.
    pub pose_difference: f64,
}

/// Solves the last problem of `ws` again with the solver that the scene does *not* use. `None` when
/// the tick had no contact rows or no usable answer. Allocates; not for the tick.
pub fn audit(scene: &Scene, ws: &Workspace) -> Option<Verdict> {
    let (problem, own) = ws.last_problem(scene)?;
    if own.status != SolveStatus::Solved {
        return None;
    }
    let mut other = Solution::with_capacity(problem.rows.len());
    match scene.params.solver {
        SolverKind::ActiveSet => Clarabel.solve(&problem, &mut other),
        SolverKind::Clarabel => {
            ActiveSet::with_capacity(problem.rows.len()).solve(&problem, &mut other)
        }
    }
    let judge_solved = other.status == SolveStatus::Solved;
    let mut pose_difference = 0.0;
    if judge_solved {
        for t in 0..scene.tools.len().min(MAX_TOOLS) {
            let at = |y: &[f64]| Vec3::new(y[6 * t], y[6 * t + 1], y[6 * t + 2]);
            let root = scene.tools[t].stiffness_n_per_m.sqrt();
            pose_difference = fmax(pose_difference, norm(&(at(&own.y) - at(&other.y))) / root);
        }
    }
    Some(Verdict {
        kkt_residual: problem.kkt_residual(&own.lambda),
        judge_solved,
        pose_difference,
    })
}
