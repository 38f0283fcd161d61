//! Comparisons of forces and torques with limits and slew limits.

use sulcus_core::{Vec3, Wrench};

use super::bounds::ROUNDING;

/// Whether a hand feels a wrench: force or torque above the tolerance.
pub(super) fn is_felt(wrench: &Wrench) -> bool {
    wrench.force.norm() > ROUNDING || wrench.torque.norm() > ROUNDING
}

/// Whether all six numbers of a wrench are finite.
pub(super) fn is_finite(wrench: &Wrench) -> bool {
    wrench
        .force
        .iter()
        .chain(wrench.torque.iter())
        .all(|x| x.is_finite())
}

/// Largest length of a vector that a slew limit permits on its way from `before` to targets of at most `limit`.
///
/// The result is `limit`, except after a fall of the limit. Outside the ball of the limit, let `w` be the length of the
/// tangent from `before` to the ball. A step towards any point of the ball reduces `w` by at least the step.
pub(super) fn ceiling(before: Vec3, limit: f64, step: f64) -> f64 {
    let tangent = (before.norm_squared() - limit * limit).max(0.0).sqrt();
    let left = (tangent - step).max(0.0);
    (limit * limit + left * left).sqrt()
}

/// Change of a vector that a slew limit bounds.
///
/// A reduction by the passivity controller acts at once: `may_shrink` then counts the growth alone. The growth is the
/// distance from the line between zero and `before`.
pub(super) fn change(before: Vec3, now: Vec3, may_shrink: bool) -> f64 {
    let square = before.norm_squared();
    let kept = if may_shrink && square > 0.0 {
        (now.dot(&before) / square).clamp(0.0, 1.0)
    } else {
        1.0
    };
    (now - before * kept).norm()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ceiling_falls_with_the_slew_limit() {
        assert_eq!(ceiling(Vec3::zeros(), 2.0, 0.5), 2.0);
        assert_eq!(ceiling(Vec3::new(2.0, 0.0, 0.0), 2.0, 0.5), 2.0);
        let (limit, step) = (1.0, 0.5);
        // The slowest way down: each step is along the tangent to the ball of the limit.
        let mut force = Vec3::new(3.0, 0.0, 0.0);
        for _ in 0..10 {
            let allowed = ceiling(force, limit, step);
            let tangent = (force.norm_squared() - limit * limit).max(0.0).sqrt();
            if tangent <= step {
                assert_eq!(allowed, limit);
                return;
            }
            let inward = -force / force.norm();
            let aside = Vec3::new(-inward.y, inward.x, 0.0);
            let cos = tangent / force.norm();
            force += (inward * cos + aside * (1.0 - cos * cos).sqrt()) * step;
            assert!(
                (force.norm() - allowed).abs() < 1e-9,
                "{} N, {allowed} N",
                force.norm()
            );
        }
        panic!("the force is still above the limit: {} N", force.norm());
    }

    #[test]
    fn a_reduction_is_no_growth() {
        let before = Vec3::new(3.0, 0.0, 0.0);
        assert_eq!(change(before, Vec3::new(1.0, 0.0, 0.0), false), 2.0);
        assert_eq!(change(before, Vec3::new(1.0, 0.0, 0.0), true), 0.0);
        assert_eq!(change(before, Vec3::new(1.0, 0.4, 0.0), true), 0.4);
        assert_eq!(change(before, Vec3::new(3.5, 0.0, 0.0), true), 0.5);
        assert_eq!(change(before, Vec3::new(-0.5, 0.0, 0.0), true), 0.5);
        assert_eq!(change(Vec3::zeros(), Vec3::new(0.0, 0.3, 0.0), true), 0.3);
    }
}
