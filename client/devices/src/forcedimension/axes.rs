//! Axes of the library, x toward the person, y to the right, z up, and of the base, x to the right, y up, z toward the
//! person.

use sulcus_core::math::Mat3;
use sulcus_core::{Pose, Vec3};

use super::api::Measured;
use crate::openhaptics::pose::rotation;

/// Largest distance of a position from the base, metres.
const REACH_M: f64 = 3.0;

/// Pose of a measurement. `None` for numbers that are no pose.
pub fn pose((position, rows): &Measured) -> Option<Pose> {
    let position = to_base(position);
    let near = position.iter().all(|x| x.abs() <= REACH_M);
    // The axes of the handle have the names of the base's axes.
    let turned: [Vec3; 3] = [rows[1], rows[2], rows[0]].map(|row| to_base(&row));
    let matrix = Mat3::from_rows(&turned.map(|row| row.transpose()));
    let orientation = rotation(&matrix)?;
    near.then(|| Pose::new(position, orientation))
}

/// Vector of the library in base axes.
pub fn to_base(v: &[f64; 3]) -> Vec3 {
    Vec3::new(v[1], v[2], v[0])
}

/// Vector of the base in axes of the library.
pub fn from_base(v: &Vec3) -> [f64; 3] {
    [v.z, v.x, v.y]
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use sulcus_core::math::{exp_rotation, log_rotation, norm};

    use super::*;

    fn rows(turn: &Vec3) -> [[f64; 3]; 3] {
        let m = exp_rotation(turn).to_rotation_matrix();
        [0, 1, 2].map(|row| [0, 1, 2].map(|column| m[(row, column)]))
    }

    #[test]
    fn axes_and_their_inverse() {
        let [toward, right, up] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        assert_eq!(to_base(&right), Vec3::x());
        assert_eq!(to_base(&up), Vec3::y());
        assert_eq!(to_base(&toward), Vec3::z());
        assert_eq!(from_base(&to_base(&[1.0, 2.0, 3.0])), [1.0, 2.0, 3.0]);
    }

    proptest! {
        #[test]
        fn a_rotation_turns_about_the_same_line(x in -1.0..1.0f64, y in -1.0..1.0f64, z in -1.0..1.0f64) {
            let turn = Vec3::new(x, y, z);
            let pose = pose(&([0.01, 0.02, 0.03], rows(&turn))).expect("a pose");
            prop_assert!(norm(&(log_rotation(&pose.orientation) - to_base(&turn.into()))) < 1e-7);
            prop_assert!(norm(&(pose.position - Vec3::new(0.02, 0.03, 0.01))) < 1e-15);
        }

        #[test]
        fn no_numbers_give_an_invalid_pose(all in prop::array::uniform12(prop::num::f64::ANY)) {
            let row = |at: usize| [all[at], all[at + 1], all[at + 2]];
            if let Some(pose) = pose(&(row(0), [row(3), row(6), row(9)])) {
                prop_assert!(pose.position.iter().all(|x| x.is_finite()));
                prop_assert!((pose.orientation.as_ref().norm() - 1.0).abs() < 1e-9);
            }
        }
    }
}
