//! Axes of the service and of a base.
//!
//! Axes of the service are x to the right, y forward and z up. Axes of a base are x to the right, y up and z towards
//! the person. A vector of the service (x, y, z) is the vector (x, z, -y) of the base.

use sulcus_core::math::normalised;
use sulcus_core::{Quat, Vec3};

/// Returns the vector of the base for a vector of the service.
pub(super) fn to_base(v: [f64; 3]) -> Vec3 {
    Vec3::new(v[0], v[2], -v[1])
}

/// Returns the vector of the service for a vector of the base.
pub(super) fn to_service(v: &Vec3) -> [f64; 3] {
    [v.x, -v.z, v.y]
}

/// Returns the orientation in the base for a quaternion w, x, y, z of the service.
pub(super) fn turn_to_base(q: [f64; 4]) -> Quat {
    let [w, x, y, z] = q;
    normalised(w, x, z, -y)
}

#[cfg(test)]
mod tests {
    use sulcus_core::math::{exp_rotation, norm};

    use super::*;

    #[test]
    fn axes_keep_their_meaning() {
        let [right, forward, up] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        assert_eq!(to_base(right), Vec3::x());
        assert_eq!(to_base(forward), -Vec3::z());
        assert_eq!(to_base(up), Vec3::y());
        for v in [right, forward, up] {
            assert_eq!(to_service(&to_base(v)), v);
        }
        let det = to_base(right).cross(&to_base(forward)).dot(&to_base(up));
        assert_eq!(det, 1.0);
    }

    /// A turned vector is the same in both axes.
    #[test]
    fn a_turn_turns_the_same_vector() {
        let turn = exp_rotation(&Vec3::new(0.4, -1.1, 0.7));
        let v = Vec3::new(0.3, -0.2, 0.9);
        let turned = turn * v;
        let base = turn_to_base([turn.w, turn.i, turn.j, turn.k]) * to_base(v.into());
        assert!(norm(&(base - to_base(turned.into()))) < 1e-12);
    }
}
