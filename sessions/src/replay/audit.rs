//! Audit of a replay by an independent solver, the judge.

use serde::Serialize;
use sulcus_core::optimise::audit::audit;
use sulcus_core::{Scene, Workspace};

/// Result of the judge for one tick.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct AuditRow {
    /// Distance between the working points of the graphic tool by the tick's answer and by the judge's, millimetres;
    /// `None` if the judge has no answer.
    pub pose_error_mm: Option<f64>,
    /// Residual of the tick's answer in the conditions of optimality, relative to the problem's largest bias.
    /// Independent of the judge.
    pub kkt_residual: f64,
}

/// Result of the judge for a session.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct AuditReport {
    /// Ticks with a problem.
    pub ticks: u64,
    /// Ticks with a problem for which the judge has no answer.
    pub unjudged: u64,
    /// Largest [`AuditRow::pose_error_mm`].
    pub max_pose_error_mm: f64,
    /// Tick with that error.
    pub worst_tick: Option<u64>,
    /// Largest [`AuditRow::kkt_residual`].
    pub max_kkt_residual: f64,
}

impl AuditReport {
    pub(crate) fn add(&mut self, tick: u64, row: &AuditRow) {
        self.ticks += 1;
        match row.pose_error_mm {
            None => self.unjudged += 1,
            Some(error) if self.worst_tick.is_none() || error > self.max_pose_error_mm => {
                self.max_pose_error_mm = error;
                self.worst_tick = Some(tick);
            }
            Some(_) => {}
        }
        // A NaN counts as the largest residual.
        let residual = if row.kkt_residual.is_nan() {
            f64::MAX
        } else {
            row.kkt_residual
        };
        self.max_kkt_residual = self.max_kkt_residual.max(residual);
    }
}

/// Solves the problem of the workspace's last tick again with the solver that the scene does not use; `None` for a tick
/// without contact.
pub fn audit_tick(scene: &Scene, workspace: &Workspace) -> Option<AuditRow> {
    let verdict = audit(scene, workspace)?;
    Some(AuditRow {
        pose_error_mm: verdict
            .judge_solved
            .then_some(verdict.pose_difference * 1e3),
        kkt_residual: verdict.kkt_residual,
    })
}
