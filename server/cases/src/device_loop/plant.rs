//! A device in a hand: mass, viscous damping, Coulomb friction and the grip, in translation and rotation.

use sulcus_core::math::{exp_rotation, log_rotation, norm, normalised};
use sulcus_core::{Pose, Quat, Vec3, Wrench};

use super::figures::{Dynamics, GRIP_LEVER};

/// Number of integration steps in a period of the device, per wrench.
pub(super) const STEPS: u32 = 10;

/// Handle of a device in a hand, world axes.
#[derive(Clone, Debug)]
pub(super) struct Plant {
    dynamics: Dynamics,
    handle: Pose,
    velocity: Vec3,
    spin: Vec3,
    /// Orientation at the beginning, from which the encoders count.
    zero: Quat,
}

impl Plant {
    /// A handle at rest at `start`, `world_from_tool`.
    pub(super) fn new(dynamics: Dynamics, start: Pose) -> Self {
        Self {
            dynamics,
            handle: start,
            velocity: Vec3::zeros(),
            spin: Vec3::zeros(),
            zero: start.orientation,
        }
    }

    /// True pose of the handle.
    pub(super) fn handle(&self) -> Pose {
        self.handle
    }

    /// Pose as the encoders measure it, with steps along the axes of the base. `world_from_base` turns the base.
    pub(super) fn measured(&self, world_from_base: &Quat) -> Pose {
        let round = |v: Vec3, step: f64| v.map(|x| libm::round(x / step) * step);
        let in_base = world_from_base.inverse() * self.handle.position;
        let turned = log_rotation(&(self.handle.orientation * self.zero.inverse()));
        let turned = exp_rotation(&round(turned, self.dynamics.spin_resolution)) * self.zero;
        Pose::new(
            world_from_base * round(in_base, self.dynamics.resolution),
            normalised(turned.w, turned.i, turned.j, turned.k),
        )
    }

    /// Advances `dt` seconds towards `target`, which moves by `meant` (velocity and spin), under the wrench `felt`.
    pub(super) fn step(&mut self, dt: f64, target: &Pose, meant: &(Vec3, Vec3), felt: &Wrench) {
        let d = &self.dynamics;
        let lever = GRIP_LEVER.value * GRIP_LEVER.value;
        let way = target.position - self.handle.position;
        let pull = way * d.grip + meant.0 * d.grip_damping + felt.force;
        self.velocity = moved(
            &self.velocity,
            &pull,
            dt,
            (d.mass, d.damping + d.grip_damping, d.friction),
        );
        self.handle.position += self.velocity * dt;
        let turn = log_rotation(&(target.orientation * self.handle.orientation.inverse()));
        let grip_damping = d.grip_damping * lever;
        let pull = turn * (d.grip * lever) + meant.1 * grip_damping + felt.torque;
        self.spin = moved(
            &self.spin,
            &pull,
            dt,
            (d.inertia, d.spin_damping + grip_damping, d.spin_friction),
        );
        let q = exp_rotation(&(self.spin * dt)) * self.handle.orientation;
        self.handle.orientation = normalised(q.w, q.i, q.j, q.k);
    }
}

/// Velocity after `dt` under `pull`, with inertia, viscous damping and Coulomb friction. The damping acts at the new
/// velocity. Friction takes momentum up to standstill and never reverses a motion, so a stuck handle stays.
fn moved(
    velocity: &Vec3,
    pull: &Vec3,
    dt: f64,
    (inertia, damping, friction): (f64, f64, f64),
) -> Vec3 {
    let free = velocity + pull * (dt / inertia);
    let (speed, lost) = (norm(&free), friction * dt / inertia);
    if speed <= lost {
        return Vec3::zeros();
    }
    free * ((1.0 - lost / speed) / (1.0 + damping * dt / inertia))
}

#[cfg(test)]
mod tests {
    use super::super::figures::{Grip, Variation};
    use super::*;
    use sulcus_haptics::model::shipped_for;

    fn touch() -> Dynamics {
        let model = shipped_for("openhaptics", "Touch").expect("shipped");
        Dynamics::of(&model, &Variation::NOMINAL, Grip::Light)
    }

    fn settled(force: f64) -> f64 {
        let mut plant = Plant::new(touch(), Pose::identity());
        let felt = Wrench {
            force: Vec3::new(force, 0.0, 0.0),
            torque: Vec3::zeros(),
        };
        let still = (Vec3::zeros(), Vec3::zeros());
        for _ in 0..30_000 {
            plant.step(1e-4, &Pose::identity(), &still, &felt);
        }
        plant.handle().position.x
    }

    #[test]
    fn friction_holds_a_small_force_and_takes_its_share_of_a_large_one() {
        assert_eq!(settled(0.25), 0.0);
        // The handle creeps to the edge of the band of friction, 0.26 N, against the grip of 100 N/m.
        let at = settled(1.0);
        assert!((at - (1.0 - 0.26) / 100.0).abs() < 1e-5, "{at}");
    }

    #[test]
    fn encoders_count_in_steps_along_the_base() {
        let base = sulcus_haptics::Mapping::seat(9.0);
        let mut start = Pose::identity();
        start.position = base * Vec3::new(0.7 * 5.5e-5, 1.4 * 5.5e-5, 0.0);
        let measured = Plant::new(touch(), start).measured(&base);
        let steps = (base.inverse() * measured.position) / 5.5e-5;
        assert!(norm(&(steps - Vec3::new(1.0, 1.0, 0.0))) < 1e-9, "{steps}");
    }
}
