//! Mapping between a device and the world: axes, place, scale, handle.
//!
//! Axes of a device's base are x to the right, y up and z towards the person, right-handed. Each back-end turns the
//! axes of its library into these. The origin of the base is the middle of the workspace.

use std::f64::consts::PI;

use sulcus_core::math::exp_rotation;
use sulcus_core::{Pose, Quat, Vec3, Wrench};

/// Mapping of one hand.
#[derive(Clone, Debug, PartialEq)]
pub struct Mapping {
    /// Rotation from the base's to world axes.
    pub world_from_base: Quat,
    /// Point of the world that shows the origin of the base, metres.
    pub origin: Vec3,
    /// Length in the world per length at the device, above 0.
    pub scale: f64,
    /// Pose of the tool in the frame of the handle, `gimbal_from_tool`, metres. The origin of the handle's frame is the
    /// centre of the gimbal, at which the device displays its force.
    pub gimbal_from_tool: Pose,
}

impl Mapping {
    /// Returns the rotation from the base's to world axes for a person who sits at `hour` of the dental clock: 6 in
    /// front of the patient's face, 9 at the patient's right, 12 behind the head.
    ///
    /// World axes are x to the patient's front, y to the left, z up. In front of the face the person's right is the
    /// patient's left.
    pub fn seat(hour: f64) -> Quat {
        let about_z = exp_rotation(&Vec3::new(0.0, 0.0, (6.0 - hour) * PI / 6.0));
        // One third of a turn about the diagonal carries x to y, y to z and z to x.
        about_z * exp_rotation(&Vec3::repeat(2.0 * PI / 3.0 / 3.0_f64.sqrt()))
    }

    /// Returns the pose of the tool, `world_from_tool`, for a handle at `base_from_gimbal`.
    pub fn to_world(&self, base_from_gimbal: &Pose) -> Pose {
        let orientation = self.world_from_base * base_from_gimbal.orientation;
        let gimbal = self.origin + self.world_from_base * (base_from_gimbal.position * self.scale);
        Pose::new(
            gimbal + orientation * self.gimbal_from_tool.position,
            orientation * self.gimbal_from_tool.orientation,
        )
    }

    /// Returns the wrench about the centre of the gimbal, base axes, of `wrench` about the tool's device point, world
    /// axes. The force is not scaled.
    pub fn to_base(&self, wrench: &Wrench, base_from_gimbal: &Pose) -> Wrench {
        let back = self.world_from_base.inverse();
        let arm = base_from_gimbal.orientation * self.gimbal_from_tool.position;
        let force = back * wrench.force;
        Wrench {
            force,
            torque: back * wrench.torque + arm.cross(&force),
        }
    }

    /// Inverse of [`Mapping::to_base`].
    pub fn from_base(&self, wrench: &Wrench, base_from_gimbal: &Pose) -> Wrench {
        let arm = base_from_gimbal.orientation * self.gimbal_from_tool.position;
        Wrench {
            force: self.world_from_base * wrench.force,
            torque: self.world_from_base * (wrench.torque - arm.cross(&wrench.force)),
        }
    }
}

#[cfg(test)]
mod tests {
    use sulcus_core::math::norm;

    use super::*;

    fn mapping() -> Mapping {
        Mapping {
            world_from_base: Mapping::seat(10.5),
            origin: Vec3::new(0.01, -0.02, 0.03),
            scale: 1.0,
            gimbal_from_tool: Pose::new(
                Vec3::new(0.01, 0.02, -0.06),
                exp_rotation(&Vec3::new(0.3, -0.2, 0.5)),
            ),
        }
    }

    #[test]
    fn seats_have_the_axes_of_the_dental_clock() {
        let [right, up, towards] = [Vec3::x(), Vec3::y(), Vec3::z()];
        for (hour, of_right, of_towards) in [
            (6.0, Vec3::y(), Vec3::x()),
            (9.0, Vec3::x(), -Vec3::y()),
            (12.0, -Vec3::y(), -Vec3::x()),
        ] {
            let seat = Mapping::seat(hour);
            assert!(norm(&(seat * right - of_right)) < 1e-12, "{hour}");
            assert!(norm(&(seat * up - Vec3::z())) < 1e-12, "{hour}");
            assert!(norm(&(seat * towards - of_towards)) < 1e-12, "{hour}");
        }
    }

    /// Identity: a rigid mapping changes no work.
    #[test]
    fn the_work_at_the_gimbal_is_the_work_at_the_tool() {
        let mapping = mapping();
        let before = Pose::new(
            Vec3::new(0.03, -0.01, 0.02),
            exp_rotation(&Vec3::new(-0.4, 0.9, 0.1)),
        );
        let (way, turn) = (
            Vec3::new(2.0, -1.0, 3.0) * 1e-7,
            Vec3::new(-1.0, 4.0, 2.0) * 1e-6,
        );
        let after = Pose::new(
            before.position + way,
            exp_rotation(&turn) * before.orientation,
        );
        let wrench = Wrench {
            force: Vec3::new(0.5, -0.2, 0.9),
            torque: Vec3::new(0.01, 0.03, -0.02),
        };
        let [at, to] = [&before, &after].map(|pose| mapping.to_world(pose));
        let turned = sulcus_core::math::log_rotation(&(to.orientation * at.orientation.inverse()));
        let in_world = wrench.force.dot(&(to.position - at.position)) + wrench.torque.dot(&turned);
        let felt = mapping.to_base(&wrench, &before);
        let at_gimbal = felt.force.dot(&way) + felt.torque.dot(&turn);
        assert!(
            (in_world - at_gimbal).abs() < 1e-4 * in_world.abs(),
            "{in_world} {at_gimbal}"
        );
        let back = mapping.from_base(&felt, &before);
        assert!(norm(&(back.force - wrench.force)) < 1e-15);
        assert!(norm(&(back.torque - wrench.torque)) < 1e-15);
    }

    #[test]
    fn the_scale_enlarges_the_way_alone() {
        let doubled = Mapping {
            scale: 2.0,
            ..mapping()
        };
        let at = |x: f64| {
            let pose = Pose::new(Vec3::new(x, 0.0, 0.0), Quat::identity());
            doubled.to_world(&pose).position
        };
        assert!((norm(&(at(0.01) - at(0.0))) - 0.02).abs() < 1e-15);
    }
}
