//! Smooth pose at the rate of a device from targets that come in steps.
//!
//! Mouse events come at 60 to 1000 Hz, a device loop runs at 250 to 8000 Hz. The pose follows its target as a critically
//! damped oscillator with three axes of translation and three of rotation: `x'' = w^2 (t - x) - 2 w x'`. Each period
//! takes the exact solution for a constant target, which is stable for any period. The delay behind a steady motion is
//! `2 / w`.

use super::pose::{HandPose, at_most, turn, turned};
use crate::camera::Vector;

/// Numbers of a smoother.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SmootherRule {
    /// Natural frequency `w`, rad/s.
    pub frequency: f64,
    /// Greatest speed of the pivot, mm/s.
    pub speed_mm_s: f64,
    /// Greatest spin, rad/s.
    pub spin_rad_s: f64,
}

impl SmootherRule {
    /// Rule for a mouse of 60 Hz or faster: 80 rad/s, a delay of 25 ms. The bounds are those of a hand.
    pub fn mouse(speed_mm_s: f64, spin_rad_s: f64) -> Self {
        Self {
            frequency: 80.0,
            speed_mm_s,
            spin_rad_s,
        }
    }
}

/// Pose that follows a target.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Smoother {
    rule: SmootherRule,
    /// Pivot in the tool's frame, mm.
    pivot: Vector,
    pose: HandPose,
    /// Velocity of the pivot, mm/s, world axes.
    velocity: Vector,
    /// Angular velocity, rad/s, world axes.
    spin: Vector,
}

impl Smoother {
    /// Smoother at rest.
    pub fn new(rule: SmootherRule, pivot: Vector, pose: HandPose) -> Self {
        Self {
            rule,
            pivot,
            pose,
            velocity: Vector::zeros(),
            spin: Vector::zeros(),
        }
    }

    /// Present pose.
    pub fn pose(&self) -> HandPose {
        self.pose
    }

    /// Pose after a period of `seconds` towards `target`.
    pub fn next(&mut self, target: &HandPose, seconds: f64) -> HandPose {
        self.next_within(target, seconds, |pose| *pose)
    }

    /// Pose after a period of `seconds` towards `target`, within an allowed set. `allowed` gives the nearest allowed
    /// pose.
    ///
    /// The bounds of speed and spin hold in any case: a pose outside the set returns into it at these speeds.
    pub fn next_within(
        &mut self,
        target: &HandPose,
        seconds: f64,
        allowed: impl Fn(&HandPose) -> HandPose,
    ) -> HandPose {
        let (from, goal) = (self.pose.point(&self.pivot), target.point(&self.pivot));
        let (away, velocity) = self.settled(&(from - goal), &self.velocity, seconds);
        let twist = turned(&target.orientation, &self.pose.orientation);
        let (twist, spin) = self.settled(&twist, &self.spin, seconds);
        let free = HandPose::with_point_at(
            &self.pivot,
            &(goal + away),
            turn(&twist) * target.orientation,
        );
        let wanted = allowed(&free);
        let step = wanted.point(&self.pivot) - from;
        let shift = at_most(&step, self.rule.speed_mm_s * seconds);
        let by = turned(&self.pose.orientation, &wanted.orientation);
        let rotation = at_most(&by, self.rule.spin_rad_s * seconds);
        let mut orientation = turn(&rotation) * self.pose.orientation;
        orientation.renormalize();
        let next = HandPose::with_point_at(&self.pivot, &(from + shift), orientation);
        // A pose that was held back has the velocity of its real motion.
        let is_free = (next.point(&self.pivot) - free.point(&self.pivot)).norm() < 1e-9;
        self.velocity = if is_free { velocity } else { shift / seconds };
        let is_free = turned(&free.orientation, &next.orientation).norm() < 1e-9;
        self.spin = if is_free { spin } else { rotation / seconds };
        self.pose = next;
        next
    }

    /// Puts the pose at rest in another place.
    pub fn put(&mut self, pose: &HandPose) {
        *self = Self::new(self.rule, self.pivot, *pose);
    }

    /// Distance from the target and its rate after `seconds`.
    fn settled(&self, distance: &Vector, rate: &Vector, seconds: f64) -> (Vector, Vector) {
        let w = self.rule.frequency;
        let decay = (-w * seconds).exp();
        let slope = rate + distance * w;
        let left = (distance + slope * seconds) * decay;
        (left, (rate - slope * (w * seconds)) * decay)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hand::pose::Turn;
    use proptest::prelude::*;

    fn at(x: f64) -> HandPose {
        HandPose {
            position: Vector::new(x, 0.0, 0.0),
            orientation: Turn::identity(),
        }
    }

    fn smoother() -> Smoother {
        Smoother::new(SmootherRule::mouse(150.0, 4.0), Vector::zeros(), at(0.0))
    }

    /// Largest step of the output, and largest change between two steps, mm, for a mouse of `mouse_hz` that moves at
    /// `speed` mm/s, in a loop of `loop_hz`. The first quarter of a second is left out.
    fn steps(mouse_hz: f64, loop_hz: f64, speed: f64) -> (f64, f64) {
        let (mut smoother, period) = (smoother(), 1.0 / loop_hz);
        let (mut last, mut last_step, mut most) = (0.0, None, (0.0f64, 0.0f64));
        for k in 0..loop_hz as usize {
            let time = k as f64 * period;
            let target = (time * mouse_hz).floor() / mouse_hz * speed;
            let x = smoother.next(&at(target), period).position.x;
            let step = x - last;
            if time > 0.25 {
                most.0 = most.0.max(step);
                most.1 = most.1.max((step - last_step.unwrap_or(step)).abs());
            }
            (last, last_step) = (x, Some(step));
        }
        most
    }

    #[test]
    fn steps_of_a_mouse_become_a_smooth_motion() {
        // Without a smoother the largest step is 0.4 mm at 125 Hz and 0.833 mm at 60 Hz.
        for (mouse_hz, step_mm, change_mm) in [
            (60.0, 0.056, 0.0032),
            (125.0, 0.052, 0.0012),
            (1000.0, 0.0501, 0.0001),
        ] {
            let (step, change) = steps(mouse_hz, 1000.0, 50.0);
            assert!((0.0499..step_mm).contains(&step), "{mouse_hz} Hz: {step}");
            assert!(change < change_mm, "{mouse_hz} Hz: {change}");
        }
    }

    #[test]
    fn the_delay_is_two_over_the_frequency_at_any_rate() {
        for loop_hz in [250.0, 1000.0, 8000.0] {
            let (mut smoother, period) = (smoother(), 1.0 / loop_hz);
            for k in 0..=(loop_hz as usize) {
                smoother.next(&at(20.0 * k as f64 * period), period);
            }
            let delay = 1.0 - smoother.pose().position.x / 20.0;
            // The target of a period is constant: half a period of uncertainty on each side.
            assert!((delay - 0.025).abs() < period, "{loop_hz} Hz: {delay}");
        }
    }

    #[test]
    fn a_jump_is_followed_at_the_greatest_speed_and_without_overshoot() {
        let mut smoother = smoother();
        let (mut last, mut most) = (0.0, 0.0f64);
        for _ in 0..1000 {
            let x = smoother.next(&at(30.0), 1e-3).position.x;
            assert!(x >= last - 1e-12 && x <= 30.0 + 1e-9, "{x}");
            most = most.max(x - last);
            last = x;
        }
        assert!((most - 0.15).abs() < 1e-9, "{most}");
        assert!((last - 30.0).abs() < 1e-6);
    }

    #[test]
    fn an_allowed_set_holds_the_pose_back() {
        let mut smoother = smoother();
        let allowed = |pose: &HandPose| at(pose.position.x.min(2.0));
        for _ in 0..1000 {
            assert!(smoother.next_within(&at(10.0), 1e-3, allowed).position.x <= 2.0);
        }
        assert_eq!(smoother.pose().position.x, 2.0);
        // The pose leaves the bound at once when the target returns.
        smoother.next_within(&at(1.0), 1e-3, allowed);
        assert!(smoother.pose().position.x < 2.0 - 1e-3);
    }

    proptest! {
        #[test]
        fn steps_are_bounded_for_any_targets(
            targets in proptest::collection::vec(
                ([-200.0f64..200.0, -200.0..200.0, -200.0..200.0], [-3.0f64..3.0, -3.0..3.0, -3.0..3.0]), 1..60),
            loop_hz in 250.0f64..8000.0,
        ) {
            let (pivot, period) = (Vector::new(1.0, -2.0, 80.0), 1.0 / loop_hz);
            let mut smoother = Smoother::new(SmootherRule::mouse(150.0, 4.0), pivot, at(0.0));
            for (place, by) in targets {
                let target = HandPose::with_point_at(&pivot, &Vector::from(place), turn(&Vector::from(by)));
                for _ in 0..5 {
                    let before = smoother.pose();
                    let after = smoother.next(&target, period);
                    prop_assert!((after.point(&pivot) - before.point(&pivot)).norm() <= 150.0 * period + 1e-9);
                    prop_assert!(turned(&before.orientation, &after.orientation).norm() <= 4.0 * period + 1e-7);
                }
            }
        }
    }
}
