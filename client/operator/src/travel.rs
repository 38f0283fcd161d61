//! Path of a hand through the air: straight legs, each with rest at both ends.

use std::collections::VecDeque;

use sulcus_core::Pose;
use sulcus_core::math::{exp_rotation, log_rotation};

use crate::script::smoothstep;

/// Shortest duration of a leg, seconds.
const LEAST: f64 = 0.15;
/// Largest mean turning speed of a leg, rad/s.
const SPIN: f64 = 4.0;

/// Position of a hand on its path, and the remaining legs.
#[derive(Clone, Debug)]
pub(crate) struct Travel {
    from: Pose,
    /// Target pose and duration, seconds, of each remaining leg.
    legs: VecDeque<(Pose, f64)>,
    /// Time since the start of the first leg, seconds.
    time: f64,
}

impl Travel {
    /// A hand at rest at `pose`.
    pub fn at(pose: Pose) -> Self {
        Self {
            from: pose,
            legs: VecDeque::new(),
            time: 0.0,
        }
    }

    /// Appends a leg to `pose` with a mean speed of at most `speed`, m/s.
    pub fn then(&mut self, pose: Pose, speed: f64) {
        let before = self.legs.back().map_or(&self.from, |(pose, _)| pose);
        let way = (pose.position - before.position).norm();
        let turn = log_rotation(&(pose.orientation * before.orientation.inverse())).norm();
        let time = (way / speed).max(turn / SPIN).max(LEAST);
        self.legs.push_back((pose, time));
    }

    /// Advances by `dt` seconds. Returns whether all legs are finished.
    pub fn step(&mut self, dt: f64) -> bool {
        let Some((to, length)) = self.legs.front() else {
            return true;
        };
        self.time += dt;
        if self.time >= *length {
            self.from = *to;
            self.time = 0.0;
            self.legs.pop_front();
        }
        self.legs.is_empty()
    }

    /// Target pose of the hand.
    pub fn pose(&self) -> Pose {
        let Some((to, length)) = self.legs.front() else {
            return self.from;
        };
        let share = smoothstep(self.time / length);
        let turn = log_rotation(&(to.orientation * self.from.orientation.inverse()));
        Pose::new(
            self.from.position + (to.position - self.from.position) * share,
            exp_rotation(&(turn * share)) * self.from.orientation,
        )
    }
}
