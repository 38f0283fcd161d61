//! Tolerance of a migration: the largest difference between a record and its replay on which a grade may rest.

use super::deviation::Deviation;

/// Tolerance of a migration.
///
/// The grade is measured in the replay by the present tick. The tolerance says that the learner felt what is graded.
/// Both numbers were chosen well below what a grade tells apart: 0.05 N at a floor, and 1 mm of depth.
/// A single tick may differ more, because a force may have been in its ramp.
pub const CLOSE: Close = Close {
    rms_force_n: 0.01,
    pose_mm: 0.1,
};

/// Largest differences between a record and its replay.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Close {
    /// Root mean square of the difference in force under load, in any stretch between snapshots, newtons.
    pub rms_force_n: f64,
    /// Difference in the place of a graphic tool at snapshots, millimetres.
    pub pose_mm: f64,
}

impl Close {
    /// Whether a deviation is within the tolerance, and every row and snapshot is of the expected tick.
    pub fn holds(&self, found: &Deviation) -> bool {
        found.out_of_step == 0
            && found.rms_force_n <= self.rms_force_n
            && found.max_pose_mm.unwrap_or_default() <= self.pose_mm
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn close_is_close_in_the_mean_and_in_place() {
        let far = |rms_force_n, max_pose_mm| Deviation {
            rms_force_n,
            max_pose_mm,
            max_force_n: 1.0,
            ..Deviation::default()
        };
        assert!(CLOSE.holds(&far(0.01, None)));
        assert!(CLOSE.holds(&far(0.0, Some(0.1))));
        assert!(!CLOSE.holds(&far(0.011, None)));
        assert!(!CLOSE.holds(&far(0.0, Some(0.11))));
        assert!(!CLOSE.holds(&far(f64::NAN, None)));
        let out_of_step = Deviation {
            out_of_step: 1,
            ..Deviation::default()
        };
        assert!(!CLOSE.holds(&out_of_step));
    }
}
