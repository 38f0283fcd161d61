//! What a device box shows: its state on the board, and its true state for the test.

use crate::device::Device;
use crate::sensors;
use std::sync::atomic::Ordering;
use sulcus_standins::Snapshot;
use sulcus_standins::board::{Calibration, State};

/// Time over which the rate of commands counts, in ns.
const RATE_WINDOW: u64 = 200_000_000;

impl Device {
    /// Error of the measured position in m: a calibration that is not right, or the motion of `drdAutoInit`.
    fn offset(&self) -> [f64; 3] {
        let mut offset = if self.calibration == Calibration::Ok {
            [0.0; 3]
        } else {
            self.setup.calibration.offset
        };
        if let Some(end) = self.auto_init {
            let length = self.setup.traits.auto_init * 1e6;
            let left = end.saturating_sub(self.t) as f64 / length.max(1.0);
            offset[2] += 0.02 * (std::f64::consts::PI * left).sin();
        }
        offset
    }

    /// Takes the position of this moment into the velocity window.
    pub fn record(&mut self) {
        let position = self
            .sensors
            .position(&self.setup, self.handle.pose.position, self.offset());
        self.sensors.record(position);
    }

    /// Shows the state of this moment on the board.
    pub fn publish(&mut self) {
        while self
            .recent
            .front()
            .is_some_and(|t| t + RATE_WINDOW < self.t)
        {
            self.recent.pop_front();
        }
        let pose = self.handle.pose;
        let position = self
            .sensors
            .position(&self.setup, pose.position, self.offset());
        let rotation = self.sensors.rotation(&self.setup, &pose);
        let gimbal = sensors::angles(&rotation);
        let joints = sensors::joints(position, &self.setup.traits);
        let count =
            |value: f64, step: f64| (value / if step > 0.0 { step } else { 1e-6 }).round() as i64;
        let [a, b, c] = position.map(|p| count(p, self.setup.step));
        let [d, e, f] = gimbal.map(|p| count(p, self.setup.angle_step));
        self.slot.state.store(State {
            stamp: self.t,
            position,
            rotation,
            velocity: self.sensors.velocity,
            angular: self.handle.angular,
            joints,
            gimbal,
            encoders: [a, b, c, d, e, f],
            buttons: self.buttons,
            inkwell: self.inkwell.into(),
            calibration: self.calibration as u64,
            warm: self.heat.warm.into(),
            temperature: self.heat.value / self.setup.heat_budget.max(1e-9),
            mode: self.mode as u64,
            cause: self.cause as u64,
            gravity: self.gravity.into(),
            rate: self.recent.len() as f64 / (RATE_WINDOW as f64 * 1e-9) / 1e3,
            lit: self.lit.into(),
            window: self.sensors.filled as u64,
        });
    }

    /// The true state of this moment.
    pub fn snapshot(&self) -> Snapshot {
        Snapshot {
            t: self.t,
            pose: self.handle.pose,
            velocity: self.handle.velocity,
            force: self.motors.output.force,
            torque: self.motors.output.torque,
            owner: self.slot.owner.load(Ordering::Acquire),
            locked: self.slot.locked.load(Ordering::Acquire) != 0,
            plugged: self.plugged,
            mode: self.mode,
            cause: self.cause,
            calibration: self.calibration,
            heat: self.heat.value / self.setup.heat_budget.max(1e-9),
            commands: self.commands,
        }
    }
}
