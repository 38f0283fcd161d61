//! Audit of the last problems of a tick by an independent solver, for `replay --audit` and the tests.

use super::{
    ContactSolver, Solution, SolveStatus, SolverKind, active_set::ActiveSet, clarabel::Clarabel,
};
use crate::math::{Vec3, fmax, norm};
use crate::{MAX_TOOLS, Scene, Workspace};

/// Verdict of the other solver on the last problems of a tick, the worst of all.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Verdict {
    /// Residual of the optimality conditions of the tick's own solution, relative to the largest bias
    /// ([`super::Problem::kkt_residual`]).
    pub kkt_residual: f64,
    /// Whether the other solver solved every problem.
    pub judge_solved: bool,
    /// Largest difference of the scaled translations of the two solutions over the root of the coupling stiffness,
    /// metres. Without curvature of blended surfaces this is the distance of the working points. 0 without a solution
    /// of the other solver.
    pub pose_difference: f64,
}

/// Solves the last problems of `ws` again with the solver that the scene does *not* use. There is one problem for each
/// tool, or one for both.
///
/// Returns the worst verdict, or `None` when the tick had no contact rows or no usable solution. Allocates; not for use
/// in a tick.
pub fn audit(scene: &Scene, ws: &Workspace) -> Option<Verdict> {
    let mut worst: Option<Verdict> = None;
    for (problem, own) in ws.last_problems(scene) {
        if own.status != SolveStatus::Solved {
            continue;
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
            for (t, tool) in scene.tools.iter().enumerate().take(MAX_TOOLS) {
                let at = |y: &[f64]| Vec3::new(y[6 * t], y[6 * t + 1], y[6 * t + 2]);
                let root = tool.stiffness_n_per_m.sqrt();
                pose_difference = fmax(pose_difference, norm(&(at(&own.y) - at(&other.y))) / root);
            }
        }
        let verdict = Verdict {
            kkt_residual: problem.kkt_residual(&own.lambda),
            judge_solved,
            pose_difference,
        };
        worst = Some(worst.map_or(verdict, |before| Verdict {
            kkt_residual: fmax(before.kkt_residual, verdict.kkt_residual),
            judge_solved: before.judge_solved && verdict.judge_solved,
            pose_difference: fmax(before.pose_difference, verdict.pose_difference),
        }));
    }
    worst
}
