//! Hollowness: inward curvature of a blended surface, which a substep needs beside the slope.

use super::{ContactRow, Member};
use crate::contact::Contact;
use crate::math::{Mat3, fmax};

/// Maximum number of sweeps of Jacobi rotations. The convergence is quadratic; five sweeps diagonalise a 3x3 matrix.
const JACOBI_SWEEPS: usize = 5;
/// Tolerance of the Jacobi rotations: sum of the magnitudes above the diagonal, relative to the sum on the diagonal.
const NO_ANGLE: f64 = 1e-13;

/// Returns the hollowness of a blended gap, 1/m, world axes: the positive part of minus its second derivative by the
/// position of the tool sphere.
///
/// Minus the second derivative is the covariance of the member normals over the blend length, minus the curvature of
/// the spheres. The positive part is nonzero only in grooves and pits. `members` are those of the row `line`;
/// `contacts` is the contact list; `blend` is the blend length, metres.
pub(crate) fn hollowness(
    line: &ContactRow,
    members: &[Member],
    contacts: &[Contact],
    blend: f64,
) -> Mat3 {
    let mut bend = -(line.normal * line.normal.transpose()) / blend;
    for member in members {
        let n = &contacts[member.contact as usize].normal;
        let square = n * n.transpose();
        bend += square * (member.weight / blend)
            - (Mat3::identity() - square) * (member.weight / fmax(member.distance, 1e-9));
    }
    positive_part(bend)
}

/// Returns the positive semi-definite part of a symmetric matrix, by Jacobi rotations.
fn positive_part(mut m: Mat3) -> Mat3 {
    let mut axes = Mat3::identity();
    for _ in 0..JACOBI_SWEEPS {
        let beside = m[(0, 1)].abs() + m[(0, 2)].abs() + m[(1, 2)].abs();
        if beside <= NO_ANGLE * (m[(0, 0)].abs() + m[(1, 1)].abs() + m[(2, 2)].abs()) {
            break;
        }
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            if m[(p, q)] == 0.0 {
                continue;
            }
            let theta = (m[(q, q)] - m[(p, p)]) / (2.0 * m[(p, q)]);
            let t = 1.0 / (theta.abs() + (theta * theta + 1.0).sqrt());
            let t = if theta < 0.0 { -t } else { t };
            let c = 1.0 / (t * t + 1.0).sqrt();
            let s = t * c;
            let mut turn = Mat3::identity();
            (turn[(p, p)], turn[(q, q)]) = (c, c);
            (turn[(p, q)], turn[(q, p)]) = (s, -s);
            m = turn.transpose() * m * turn;
            axes *= turn;
        }
    }
    let mut part = Mat3::zeros();
    for k in 0..3 {
        let axis = axes.column(k).into_owned();
        part += axis * axis.transpose() * fmax(0.0, m[(k, k)]);
    }
    part
}
