//! The way of a hand through the air: straight legs, at rest at both ends of each.

use std::collections::VecDeque;

use sulcus_core::Pose;
use sulcus_core::math::{exp_rotation, log_rotation};

use crate::script::smoothstep;

/// Shortest time for a leg, seconds.
const LEAST: f64 = 0.15;
/// Fastest turn, rad/s.
const SPIN: f64 = 4.0;

/// Where the hand is on its way, and where it still goes.
#[derive(Clone, Debug)]
pub(crate) struct Travel {
    from: Pose,
    legs: VecDeque<(Pose, f64)>,
    /// Time into the first leg.
    time: f64,
}

impl Travel {
    /// At rest.
    pub fn at(pose: Pose) -> Self {
        Self {
            from: pose,
            legs: VecDeque::new(),
            time: 0.0,
        }
    }

    /// Goes on to `pose` at `speed`, m/s (the mean of the leg).
    pub fn then(&mut self, pose: Pose, speed: f64) {
        let before = self.legs.back().map_or(&self.from, |(pose, _)| pose);
        let way = (pose.position - before.position).norm();
        let turn = log_rotation(&(pose.orientation * before.orientation.inverse())).norm();
        let time = (way / speed).max(turn / SPIN).max(LEAST);
        self.legs.push_back((pose, time));
    }

    /// `dt` seconds on; whether it has arrived.
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

    /// Where the hand means to be.
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
