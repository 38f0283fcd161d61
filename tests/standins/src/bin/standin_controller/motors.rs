//! Commands on their way to the motors, and the hardware watchdog.

use std::collections::VecDeque;
use sulcus_standins::log::Cause;
use sulcus_standins::pose::{V3, clamp, norm};
use sulcus_standins::setup::DeviceSetup;

/// What the motors put out and why.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Output {
    /// Force in N.
    pub force: V3,
    /// Torque in N m.
    pub torque: V3,
    /// Why.
    pub cause: Cause,
}

impl Output {
    /// No force.
    pub fn zero(cause: Cause) -> Self {
        Self {
            force: [0.0; 3],
            torque: [0.0; 3],
            cause,
        }
    }
}

/// Motors of a device.
pub struct Motors {
    due: VecDeque<(u64, Output)>,
    /// Output that the last command in force asks for.
    wanted: Output,
    /// Output of the motors.
    pub output: Output,
    /// Time of the last command, or of the start of mode force; ns.
    pub last: u64,
    /// True while the watchdog waits for commands.
    pub armed: bool,
}

impl Default for Motors {
    fn default() -> Self {
        Self {
            due: VecDeque::new(),
            wanted: Output::zero(Cause::Disabled),
            output: Output::zero(Cause::Disabled),
            last: 0,
            armed: false,
        }
    }
}

impl Motors {
    /// Takes a command of the time `t`, with the motors' own limits.
    pub fn command(&mut self, device: &DeviceSetup, t: u64, force: V3, torque: V3) {
        let limits = &device.traits;
        let torque = if limits.max_torque > 0.0 {
            torque
        } else {
            [0.0; 3]
        };
        let saturated = norm(force) > limits.max_force || norm(torque) > limits.max_torque;
        let output = Output {
            force: clamp(force, limits.max_force),
            torque: clamp(torque, limits.max_torque),
            cause: if saturated {
                Cause::Saturated
            } else {
                Cause::Command
            },
        };
        self.due
            .push_back((t + (device.latency_us * 1e3) as u64, output));
        self.last = t;
        self.armed = true;
    }

    /// Takes everything back; the motors are at zero from the next step.
    pub fn cut(&mut self, cause: Cause) {
        self.due.clear();
        self.wanted = Output::zero(cause);
        self.armed = false;
    }

    /// True when the watchdog fires at `t`.
    pub fn silent(&self, device: &DeviceSetup, t: u64) -> bool {
        let limit = (device.watchdog_ms * 1e6) as u64;
        self.armed && limit > 0 && t.saturating_sub(self.last) > limit
    }

    /// Output at `t`; `block` holds the motors at zero. Returns true when force or torque changed.
    pub fn step(&mut self, t: u64, block: Option<Cause>) -> bool {
        while self.due.front().is_some_and(|d| d.0 <= t) {
            if let Some((_, output)) = self.due.pop_front() {
                self.wanted = output;
            }
        }
        let next = block.map_or(self.wanted, Output::zero);
        let changed = next.force != self.output.force || next.torque != self.output.torque;
        self.output = next;
        changed
    }
}
