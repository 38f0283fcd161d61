//! Pose of the stylus from the library's matrix. The axes of the library are those of the base: x right, y up, z toward
//! the person.

use sulcus_core::math::{Mat3, normalised};
use sulcus_core::{Pose, Quat, Vec3};

/// Largest distance of a position from the base, metres: no device of the library reaches as far.
const REACH_M: f64 = 3.0;

/// Largest element of the difference between the matrix and a rotation. The library's own error is about 0.001.
const SKEW: f64 = 0.05;

/// Returns the pose of sixteen numbers by columns, translation in millimetres. `None` for numbers that are no pose.
pub fn pose(transform: &[f64; 16]) -> Option<Pose> {
    let position = Vec3::new(transform[12], transform[13], transform[14]) * 1e-3;
    let is_near = position.iter().all(|x| x.abs() <= REACH_M);
    let column = |at: usize| Vec3::new(transform[at], transform[at + 1], transform[at + 2]);
    let orientation = rotation(&Mat3::from_columns(&[column(0), column(4), column(8)]))?;
    is_near.then(|| Pose::new(position, orientation))
}

/// Returns the rotation nearest to `matrix`. `None` for a matrix that is not almost a rotation.
pub fn rotation(matrix: &Mat3) -> Option<Quat> {
    if !matrix.iter().all(|x| x.abs() <= 2.0) {
        return None;
    }
    let mut near = *matrix;
    // Newton's iteration of the polar decomposition: the error squares in each step.
    for _ in 0..4 {
        near = near * (Mat3::identity() * 3.0 - near.transpose() * near) * 0.5;
    }
    let is_near = (near - matrix).iter().all(|x| x.abs() <= SKEW);
    let is_right_handed = (near.determinant() - 1.0).abs() < 1e-6;
    (is_near && is_right_handed).then(|| quaternion(&near))
}

/// Quaternion of a rotation matrix, by its largest component.
fn quaternion(m: &Mat3) -> Quat {
    let [a, b, c] = [m[(0, 0)], m[(1, 1)], m[(2, 2)]];
    let trace = a + b + c;
    if trace > 0.0 {
        return normalised(
            1.0 + trace,
            m[(2, 1)] - m[(1, 2)],
            m[(0, 2)] - m[(2, 0)],
            m[(1, 0)] - m[(0, 1)],
        );
    }
    let largest = if a >= b && a >= c {
        0
    } else if b >= c {
        1
    } else {
        2
    };
    let (i, j, k) = (largest, (largest + 1) % 3, (largest + 2) % 3);
    let mut xyz = [0.0; 3];
    xyz[i] = 1.0 + m[(i, i)] - m[(j, j)] - m[(k, k)];
    xyz[j] = m[(j, i)] + m[(i, j)];
    xyz[k] = m[(k, i)] + m[(i, k)];
    normalised(m[(k, j)] - m[(j, k)], xyz[0], xyz[1], xyz[2])
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use sulcus_core::math::{exp_rotation, log_rotation, norm};

    use super::*;

    fn sixteen(turn: &Quat, position: [f64; 3], shear: f64) -> [f64; 16] {
        let m = turn.to_rotation_matrix();
        let mut all = [0.0; 16];
        for column in 0..3 {
            for row in 0..3 {
                all[4 * column + row] = m[(row, column)];
            }
            all[12 + column] = position[column];
        }
        all[0] += shear;
        all[6] -= shear;
        all[15] = 1.0;
        all
    }

    #[test]
    fn columns_and_millimetres() {
        let turn = exp_rotation(&Vec3::new(0.3, -1.2, 0.7));
        let pose = pose(&sixteen(&turn, [10.0, -20.0, 30.0], 1e-3)).expect("a pose");
        assert!(norm(&(pose.position - Vec3::new(0.01, -0.02, 0.03))) < 1e-15);
        assert!(norm(&log_rotation(&(pose.orientation * turn.inverse()))) < 2e-3);
        assert!((pose.orientation.as_ref().norm() - 1.0).abs() < 1e-12);
    }

    #[test]
    fn what_is_no_pose() {
        let good = sixteen(&Quat::identity(), [0.0; 3], 0.0);
        assert!(pose(&good).is_some());
        assert_eq!(pose(&[0.0; 16]), None);
        for at in 0..15 {
            for bad in [f64::NAN, f64::INFINITY, 1e6, -1e300] {
                let mut all = good;
                all[at] = bad;
                // The last row of the matrix has no meaning.
                assert_eq!(pose(&all).is_none(), at % 4 != 3, "{at} {bad}");
            }
        }
        let mut mirrored = good;
        mirrored[0] = -1.0;
        assert_eq!(pose(&mirrored), None);
    }

    proptest! {
        #[test]
        fn every_rotation_returns(x in -4.0..4.0f64, y in -4.0..4.0f64, z in -4.0..4.0f64) {
            let turn = exp_rotation(&Vec3::new(x, y, z));
            let found = pose(&sixteen(&turn, [0.0; 3], 0.0)).expect("a pose");
            prop_assert!(norm(&log_rotation(&(found.orientation * turn.inverse()))) < 1e-7);
        }

        #[test]
        fn no_numbers_give_an_invalid_pose(all in prop::array::uniform16(prop::num::f64::ANY)) {
            if let Some(pose) = pose(&all) {
                prop_assert!(pose.position.iter().all(|x| x.is_finite()));
                prop_assert!((pose.orientation.as_ref().norm() - 1.0).abs() < 1e-9);
            }
        }
    }
}
