//! How a blended surface bends inwards, which a pass has to know beside its slope.

use super::{ContactRow, Member};
use crate::contact::Contact;
use crate::math::{Mat3, fmax};

/// Sweeps of Jacobi's rotations: they converge quadratically, five end a 3x3 matrix.
const JACOBI_SWEEPS: usize = 5;
/// Share of the diagonal that may stand beside it at the end.
const NO_ANGLE: f64 = 1e-13;

/// How a blended gap bends inwards: the positive part of minus its second derivative by the tool
/// sphere's place, 1/m. The covariance of the normals over the blend length, less the
/// roundness of the spheres; not zero in grooves and pits only.
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

/// The positive semi-definite part of a symmetric matrix, by Jacobi's rotations.
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
