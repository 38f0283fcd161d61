//! Mechanics of a handle in a hand.

use crate::motion;
use sulcus_standins::pose::{Pose, V3, add, multiply, norm, scale, sub, turn_between, unit};
use sulcus_standins::setup::{DeviceSetup, Grip, Hand};

/// Forces on a handle besides the hand's.
#[derive(Clone, Copy, Default)]
pub struct Load {
    /// Force of the motors in N.
    pub force: V3,
    /// Torque of the motors in N m.
    pub torque: V3,
    /// Weight that nothing carries, in N along the last axis.
    pub droop: f64,
    /// Damping of the brakes in N s/m.
    pub brake: f64,
}

/// A handle in a hand.
pub struct Handle {
    hand: Hand,
    time: f64,
    target: Pose,
    /// True pose.
    pub pose: Pose,
    /// True velocity in m/s.
    pub velocity: V3,
    /// True angular velocity in rad/s.
    pub angular: V3,
}

impl Handle {
    /// A handle at rest at the start of the hand's motion.
    pub fn new(hand: Hand) -> Self {
        let pose = motion::at(&hand.motion, 0.0);
        Self {
            hand,
            time: 0.0,
            target: pose,
            pose,
            velocity: [0.0; 3],
            angular: [0.0; 3],
        }
    }

    /// Gives the handle to another hand. A hand with a grip takes the handle where it is.
    pub fn take(&mut self, hand: Hand) {
        self.target = motion::at(&hand.motion, 0.0);
        self.hand = hand;
        self.time = 0.0;
    }

    /// One step of `dt` s: semi-implicit Euler, friction after the other forces so that it holds a resting handle.
    pub fn step(&mut self, device: &DeviceSetup, load: &Load, dt: f64) {
        self.time += dt;
        let before = self.target;
        self.target = motion::at(&self.hand.motion, self.time);
        let speed = scale(sub(self.target.position, before.position), 1.0 / dt);
        let turning = scale(
            turn_between(before.rotation, self.target.rotation),
            1.0 / dt,
        );
        match self.hand.grip {
            None => {
                self.pose = self.target;
                self.velocity = speed;
                self.angular = turning;
            }
            Some(grip) => {
                self.push(device, &grip, load, speed, dt);
                self.twist(&grip, load, turning, dt);
            }
        }
    }

    fn push(&mut self, device: &DeviceSetup, grip: &Grip, load: &Load, speed: V3, dt: f64) {
        let mass = (grip.mass + device.mass).max(1e-3);
        let mut force = add(
            load.force,
            sub(self.target.position, self.pose.position),
            grip.stiffness,
        );
        force = add(force, sub(speed, self.velocity), grip.damping);
        force = add(force, self.velocity, -(device.damping + load.brake));
        force[2] -= load.droop;
        let mut velocity = add(self.velocity, force, dt / mass);
        let held = device.friction * dt / mass;
        let fast = norm(velocity);
        velocity = if fast <= held {
            [0.0; 3]
        } else {
            scale(velocity, 1.0 - held / fast)
        };
        self.velocity = velocity;
        self.pose.position = add(self.pose.position, velocity, dt);
    }

    fn twist(&mut self, grip: &Grip, load: &Load, turning: V3, dt: f64) {
        let away = turn_between(self.pose.rotation, self.target.rotation);
        let mut torque = add(load.torque, away, grip.turn_stiffness);
        torque = add(torque, sub(turning, self.angular), grip.turn_damping);
        self.angular = add(self.angular, torque, dt / grip.inertia.max(1e-6));
        let [x, y, z] = scale(self.angular, dt / 2.0);
        self.pose.rotation = unit(multiply([1.0, x, y, z], self.pose.rotation));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sulcus_standins::setup::Motion;

    fn held() -> Handle {
        Handle::new(Hand::held(Motion::Rest(Pose::default()), Grip::light()))
    }

    #[test]
    fn a_steady_force_moves_the_hand_by_force_less_friction_over_stiffness() {
        let device = DeviceSetup::touch("a", "1");
        let mut handle = held();
        let load = Load {
            force: [1.0, 0.0, 0.0],
            ..Load::default()
        };
        for _ in 0..20_000 {
            handle.step(&device, &load, 1e-4);
        }
        let x = handle.pose.position[0];
        // Friction keeps the handle within its band about the balance.
        assert!(
            x > (1.0 - 0.26) / 100.0 - 1e-6 && x < (1.0 + 0.26) / 100.0 + 1e-6,
            "{x} m"
        );
    }

    #[test]
    fn friction_holds_a_resting_handle_against_a_small_force() {
        let device = DeviceSetup::touch("a", "1");
        let mut handle = held();
        let load = Load {
            force: [0.2, 0.0, 0.0],
            ..Load::default()
        };
        for _ in 0..5000 {
            handle.step(&device, &load, 1e-4);
        }
        assert_eq!(handle.pose.position, [0.0; 3]);
    }

    #[test]
    fn a_steady_torque_turns_the_hand_by_torque_over_stiffness() {
        let device = DeviceSetup::premium("a", "1");
        let mut handle = held();
        let load = Load {
            torque: [0.0, 0.03, 0.0],
            ..Load::default()
        };
        for _ in 0..20_000 {
            handle.step(&device, &load, 1e-4);
        }
        let turn = turn_between([1.0, 0.0, 0.0, 0.0], handle.pose.rotation);
        assert!((turn[1] - 0.1).abs() < 1e-3, "{turn:?}");
    }
}
