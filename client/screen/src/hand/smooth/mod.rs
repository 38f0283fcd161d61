//! Smooth pose at the rate of a device from targets that come in steps.
//!
//! Mouse events come at 60 to 1000 Hz, a device loop runs at 250 to 8000 Hz. The pose follows its target as a
//! critically damped oscillator with three axes of translation and three of rotation: `x'' = w^2 (t - x) - 2 w x'`.
//! Each period takes the exact solution for a constant target, which is stable for any period. The delay behind a
//! steady motion is `2 / w`.
//!
//! Measured at 50 mm/s in a loop of 1000 Hz. A step of 0.05 mm is that of an even motion.
//!
//! | mouse | largest step, mm | largest change between steps, mm | largest step of the mouse, mm |
//! |---|---|---|---|
//! | 60 Hz | 0.0544 | 0.0030 | 0.833 |
//! | 125 Hz | 0.0508 | 0.0010 | 0.400 |
//! | 1000 Hz | 0.0500 | 0.0000 | 0.050 |

use super::pose::{HandPose, at_most, turn, turned};
use crate::camera::Vector;

#[cfg(test)]
mod tests;

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
