//! An independent judge beside the replay.

use serde::Serialize;
use sulcus_core::optimise::audit::audit;
use sulcus_core::{Scene, Workspace};

/// What the judge says of one tick.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct AuditRow {
    /// Distance between the working point of the graphic tool by the tick's answer and by the
    /// judge's, millimetres; `None` when the judge found no answer.
    pub pose_error_mm: Option<f64>,
    /// How far the tick's answer is from satisfying the conditions of optimality, relative to the
    /// problem's largest bias. Needs no judge.
    pub kkt_residual: f64,
}

/// What the judge says of a session.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct AuditReport {
    /// Ticks that had a problem to judge.
    pub ticks: u64,
    /// Of them, ticks for which the judge itself found no answer.
    pub unjudged: u64,
    /// Largest [`AuditRow::pose_error_mm`].
    pub max_pose_error_mm: f64,
    /// The tick of it.
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
        // A residual that is not a number is the worst there can be.
        let residual = if row.kkt_residual.is_nan() {
            f64::MAX
        } else {
            row.kkt_residual
        };
        self.max_kkt_residual = self.max_kkt_residual.max(residual);
    }
}

/// Solves the last problem of `workspace` (the one its last tick ended with) again with the solver
/// that the scene does not use; `None` when that tick touched nothing.
pub fn audit_tick(scene: &Scene, workspace: &Workspace) -> Option<AuditRow> {
    let verdict = audit(scene, workspace)?;
    Some(AuditRow {
        pose_error_mm: verdict
            .judge_solved
            .then_some(verdict.pose_difference * 1e3),
        kkt_residual: verdict.kkt_residual,
    })
}
