//! Pivot calibration: the tip of a handle from poses with the tip in one dimple.
//!
//! With the tip `t` in the frame of the handle and the dimple `q` in base axes, each pose `R, p` gives `R t + p = q`.
//! The mean over all poses eliminates `q`: `(R - mean R) t = mean p - p`. The least squares of these equations are
//! three normal equations for `t`.

use sulcus_core::math::{Mat3, norm};
use sulcus_core::{Pose, Vec3};

/// Least number of poses.
pub const LEAST_POSES: usize = 4;
/// Largest residual of a calibration, millimetres, root mean square over the poses.
pub const MOST_RESIDUAL_MM: f64 = 0.5;
/// Least spread of the orientations. An error of the positions reaches the tip divided by the spread and by the square
/// root of the number of poses. Tilts of 20 degrees to all sides give 0.24.
const LEAST_SPREAD: f64 = 0.15;

/// Result of a pivot calibration.
#[derive(Clone, Debug, PartialEq)]
pub struct Pivot {
    /// Position of the tip in the frame of the handle, metres.
    pub gimbal_from_tip: Vec3,
    /// Position of the dimple, base axes, metres.
    pub dimple: Vec3,
    /// Distance of the tip from the dimple, root mean square over the poses, metres.
    pub residual: f64,
    /// Distance of the tip from the dimple in each pose, metres.
    pub residuals: Vec<f64>,
    /// Spread of the orientations about their worst axis, 0 to about 1.
    pub spread: f64,
}

/// Error of a pivot calibration.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PivotError {
    /// Too few poses.
    #[error(
        "{found} poses, expected at least {LEAST_POSES}: touch the dimple once more with another tilt"
    )]
    TooFew {
        /// Number of poses.
        found: usize,
    },
    /// A number of a pose is not finite.
    #[error("pose {number} has a value that is not a number: repeat it")]
    NotFinite {
        /// Number of the pose, from 1.
        number: usize,
    },
    /// The orientations do not determine the tip.
    #[error(
        "the poses are too similar (spread {spread:.2}, expected at least {LEAST_SPREAD}): tilt the handle by 30 \
         degrees or more, to the left, to the right, forwards and backwards"
    )]
    TooSimilar {
        /// Spread found.
        spread: f64,
    },
    /// The tip was not in one place.
    #[error(
        "the tip was {residual_mm:.2} mm from the dimple, expected at most {MOST_RESIDUAL_MM}: repeat pose {number} \
         with the tip in the dimple"
    )]
    Moved {
        /// Residual, root mean square, millimetres.
        residual_mm: f64,
        /// Number of the pose that agrees least with the others, from 1.
        number: usize,
    },
}

/// Computes the tip from the poses `base_from_gimbal` of a handle whose tip stays in one dimple.
///
/// # Errors
/// Too few poses, poses too similar, or a residual above [`MOST_RESIDUAL_MM`].
pub fn pivot(poses: &[Pose]) -> Result<Pivot, PivotError> {
    if poses.len() < LEAST_POSES {
        return Err(PivotError::TooFew { found: poses.len() });
    }
    let finite = |pose: &Pose| {
        let numbers = pose
            .position
            .iter()
            .chain(pose.orientation.as_ref().coords.iter());
        numbers.into_iter().all(|x| x.is_finite())
    };
    if let Some(at) = poses.iter().position(|pose| !finite(pose)) {
        return Err(PivotError::NotFinite { number: at + 1 });
    }
    let all: Vec<&Pose> = poses.iter().collect();
    let (spread, found) = solved(&all);
    let Some(found) = found.filter(|_| spread >= LEAST_SPREAD) else {
        return Err(PivotError::TooSimilar { spread });
    };
    let residual_mm = found.residual * 1e3;
    if residual_mm > MOST_RESIDUAL_MM {
        let number = odd_one(&all, &found) + 1;
        return Err(PivotError::Moved {
            residual_mm,
            number,
        });
    }
    Ok(found)
}

/// Spread of the orientations, and the solution of the normal equations if they have one.
fn solved(poses: &[&Pose]) -> (f64, Option<Pivot>) {
    let count = poses.len() as f64;
    let matrices: Vec<Mat3> = poses
        .iter()
        .map(|pose| pose.orientation.to_rotation_matrix().into_inner())
        .collect();
    let mean_turn: Mat3 = matrices.iter().sum::<Mat3>() / count;
    let mean_place: Vec3 = poses.iter().map(|pose| pose.position).sum::<Vec3>() / count;
    let (mut normal, mut right) = (Mat3::zeros(), Vec3::zeros());
    for (pose, matrix) in poses.iter().zip(&matrices) {
        let turn = matrix - mean_turn;
        normal += turn.transpose() * turn;
        right += turn.transpose() * (mean_place - pose.position);
    }
    let least = normal.symmetric_eigenvalues().min();
    let spread = (least.max(0.0) / count).sqrt();
    let Some(inverse) = normal.try_inverse() else {
        return (spread, None);
    };
    let tip = inverse * right;
    let dimple = mean_turn * tip + mean_place;
    let off = |pose: &&Pose| norm(&(pose.transform(&tip) - dimple));
    let residuals: Vec<f64> = poses.iter().map(off).collect();
    let square: f64 = residuals.iter().map(|r| r * r).sum();
    let pivot = Pivot {
        gimbal_from_tip: tip,
        dimple,
        residual: (square / count).sqrt(),
        residuals,
        spread,
    };
    (spread, Some(pivot))
}

/// Index of the pose without which the others agree best. A pose alone with a large residual may be a good one: least
/// squares spread the error of one pose over all.
fn odd_one(poses: &[&Pose], found: &Pivot) -> usize {
    let without = |at: usize| {
        let mut others = poses.to_vec();
        others.remove(at);
        let (spread, rest) = solved(&others);
        // Three similar poses agree with any tip.
        rest.filter(|_| spread >= LEAST_SPREAD / 2.0)
            .map(|rest| rest.residual)
    };
    let largest = |at: usize| -found.residuals[at];
    (0..poses.len())
        .min_by(|&a, &b| match (without(a), without(b)) {
            (Some(of_a), Some(of_b)) => of_a.total_cmp(&of_b),
            (Some(_), None) => std::cmp::Ordering::Less,
            (None, Some(_)) => std::cmp::Ordering::Greater,
            (None, None) => largest(a).total_cmp(&largest(b)),
        })
        .unwrap_or(0)
}
