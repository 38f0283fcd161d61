//! A hand that holds a device: a spring and a damper each in translation and rotation, a mass and a moment of inertia.

use sulcus_core::math::{exp_rotation, log_rotation, normalised};
use sulcus_core::scene::displayable::{DEVICE_DAMPING, DEVICE_SPIN_DAMPING};
use sulcus_core::{Pose, Vec3, Wrench};

use crate::tremor::Tremor;

/// Parameters of device and hand. The defaults are those of the prototype's closed loop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HandParams {
    /// Period of the device, seconds, equal to the tick of the simulation. Default 1e-3.
    pub period_s: f64,
    /// Moving mass of the device as the hand feels it, kg. Default 0.1.
    pub mass: f64,
    /// Moment of inertia about the device point, kg m2. Default 2e-4.
    pub inertia: f64,
    /// Damping of the device, N s/m. Default [`DEVICE_DAMPING`], which limits the stiffness of a displayable coupling.
    pub device_damping: f64,
    /// Damping of the device in rotation, N m s/rad. Default [`DEVICE_SPIN_DAMPING`].
    pub device_spin_damping: f64,
    /// Stiffness of the grip, N/m. Default 300.
    pub grip: f64,
    /// Damping of the grip, N s/m. Default 4.
    pub grip_damping: f64,
    /// Stiffness of the grip in rotation, N m/rad. Default 2.
    pub twist_grip: f64,
    /// Damping of the grip in rotation, N m s/rad. Default 0.02.
    pub twist_grip_damping: f64,
    /// Tremor, metres rms per axis. Default 5e-5.
    pub tremor: f64,
    /// Tremor, radians rms per axis. Default 5e-4.
    pub spin_tremor: f64,
}

impl Default for HandParams {
    fn default() -> Self {
        Self {
            period_s: 1e-3,
            mass: 0.1,
            inertia: 2e-4,
            device_damping: DEVICE_DAMPING,
            device_spin_damping: DEVICE_SPIN_DAMPING,
            grip: 300.0,
            grip_damping: 4.0,
            twist_grip: 2.0,
            twist_grip_damping: 0.02,
            tremor: 5e-5,
            spin_tremor: 5e-4,
        }
    }
}

/// Number of integration steps of the device in a period. The wrench is constant over the period.
const STEPS: u32 = 10;

/// One hand with its device.
#[derive(Clone, Debug)]
pub struct Hand {
    params: HandParams,
    device: Pose,
    velocity: Vec3,
    spin: Vec3,
    last_target: Pose,
    shake: Tremor,
    spin_shake: Tremor,
    time: f64,
}

impl Hand {
    /// A hand at rest with its device at `start` (`world_from_tool`). `seed` decides the tremor.
    pub fn new(params: HandParams, start: Pose, seed: u64) -> Self {
        Self {
            params,
            device: start,
            velocity: Vec3::zeros(),
            spin: Vec3::zeros(),
            last_target: start,
            shake: Tremor::new(params.tremor, seed),
            spin_shake: Tremor::new(params.spin_tremor, seed ^ 0x5eed),
            time: 0.0,
        }
    }

    /// Pose of the device, `world_from_tool`.
    pub fn device(&self) -> Pose {
        self.device
    }

    /// Whether this hand moves like `other`, bit for bit, under the same future targets and wrenches.
    ///
    /// Both hands must have the same seed, which is not compared. The time is compared only with a tremor.
    pub fn goes_on_as(&self, other: &Self) -> bool {
        let shakes = |p: &HandParams| p.tremor != 0.0 || p.spin_tremor != 0.0;
        let bits = |hand: &Self| {
            let [device, target] = [&hand.device, &hand.last_target].map(|pose| {
                let (p, q) = (&pose.position, &pose.orientation);
                [p.x, p.y, p.z, q.w, q.i, q.j, q.k].map(f64::to_bits)
            });
            let (v, w) = (&hand.velocity, &hand.spin);
            let speed = [v.x, v.y, v.z, w.x, w.y, w.z].map(f64::to_bits);
            let time = if shakes(&hand.params) { hand.time } else { 0.0 };
            (device, target, speed, time.to_bits())
        };
        self.params == other.params && bits(self) == bits(other)
    }

    /// Advances one period towards `target` (`world_from_tool`) under the wrench `felt`, about the device point, world
    /// axes. Returns the pose of the device.
    pub fn step(&mut self, target: &Pose, felt: &Wrench) -> Pose {
        let p = self.params;
        let period = p.period_s;
        let dt = period / f64::from(STEPS);
        let way = target.position - self.last_target.position;
        let turn = log_rotation(&(target.orientation * self.last_target.orientation.inverse()));
        let (meant_velocity, meant_spin) = (way / period, turn / period);
        for k in 1..=STEPS {
            let share = f64::from(k) / f64::from(STEPS);
            let t = self.time + share * period;
            let at = self.last_target.position + way * share + self.shake.at(t);
            let facing = exp_rotation(&(turn * share + self.spin_shake.at(t)))
                * self.last_target.orientation;
            // Semi-implicit Euler with the damping at the new velocity: every damping is stable.
            let pull =
                (at - self.device.position) * p.grip + meant_velocity * p.grip_damping + felt.force;
            let damping = p.device_damping + p.grip_damping;
            self.velocity = (self.velocity + pull * (dt / p.mass)) / (1.0 + damping * dt / p.mass);
            self.device.position += self.velocity * dt;
            let twist = log_rotation(&(facing * self.device.orientation.inverse()));
            let pull = twist * p.twist_grip + meant_spin * p.twist_grip_damping + felt.torque;
            let damping = p.device_spin_damping + p.twist_grip_damping;
            self.spin = (self.spin + pull * (dt / p.inertia)) / (1.0 + damping * dt / p.inertia);
            let q = exp_rotation(&(self.spin * dt)) * self.device.orientation;
            self.device.orientation = normalised(q.w, q.i, q.j, q.k);
        }
        self.time += period;
        self.last_target = *target;
        self.device
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_constant_force_moves_the_hand_by_its_grip() {
        let params = HandParams {
            tremor: 0.0,
            spin_tremor: 0.0,
            ..HandParams::default()
        };
        let mut hand = Hand::new(params, Pose::identity(), 1);
        let felt = Wrench {
            force: Vec3::new(0.6, 0.0, 0.0),
            torque: Vec3::new(0.0, 0.02, 0.0),
        };
        let mut pose = Pose::identity();
        for _ in 0..3000 {
            pose = hand.step(&Pose::identity(), &felt);
        }
        assert!((pose.position.x - 0.6 / 300.0).abs() < 1e-9);
        assert!((log_rotation(&pose.orientation).y - 0.01).abs() < 1e-9);
    }
}
