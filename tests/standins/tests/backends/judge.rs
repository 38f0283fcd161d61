//! Judgements by the controller's log.

use sulcus_standins::Log;
use sulcus_standins::setup::Setup;

use crate::commands::{PEAK_N, SLEW};

/// Zero within this time after the last command or order, ns.
pub const ZERO_WITHIN: u64 = 50_000_000;

/// Asserts that every command is finite, within peak and slew, and that the log is whole.
pub fn sound(log: &Log, setup: &Setup) {
    assert_eq!(log.flaws(setup), Vec::<String>::new());
    for device in 0..setup.devices.len() {
        assert!(
            log.largest_asked(device) <= PEAK_N + 1e-9,
            "{}",
            log.largest_asked(device)
        );
        // A late tick may step as far as two periods of a millisecond.
        let step = log.largest_step_up(device);
        assert!(
            step <= 2.0 * SLEW + 1e-9,
            "device {device}: a step of {step} N"
        );
    }
}

/// Steps of commands.
pub trait Steps {
    /// Largest rise of the force from a command to the next, newtons.
    fn largest_step_up(&self, device: usize) -> f64;
    /// Median of the times between commands, ns.
    fn median_interval(&self, device: usize) -> u64;
    /// Largest components of the asked forces along each axis, newtons.
    fn largest_axes(&self, device: usize) -> [f64; 3];
    /// Time of the first command with a force after `t`.
    fn first_force_after(&self, device: usize, t: u64) -> Option<u64>;
    /// Time of the last command with a force.
    fn last_force(&self, device: usize) -> Option<u64>;
}

fn length(v: [f64; 3]) -> f64 {
    v.iter().map(|x| x * x).sum::<f64>().sqrt()
}

impl Steps for Log {
    fn largest_step_up(&self, device: usize) -> f64 {
        let mut before = [0.0; 3];
        let mut most = 0.0f64;
        for (_, command) in self.commands(device) {
            let force = command.asked_force;
            let step = length([0, 1, 2].map(|i| force[i] - before[i]));
            // The way to zero may be shorter.
            if length(force) > length(before) {
                most = most.max(step);
            }
            before = force;
        }
        most
    }

    fn median_interval(&self, device: usize) -> u64 {
        let mut intervals = self.intervals(device);
        intervals.sort_unstable();
        intervals.get(intervals.len() / 2).copied().unwrap_or(0)
    }

    fn largest_axes(&self, device: usize) -> [f64; 3] {
        self.commands(device)
            .iter()
            .fold([0.0; 3], |most, (_, command)| {
                [0, 1, 2].map(|i| most[i].max(command.asked_force[i].abs()))
            })
    }

    fn first_force_after(&self, device: usize, t: u64) -> Option<u64> {
        let commands = self.commands(device);
        commands
            .iter()
            .find(|(at, c)| *at > t && length(c.asked_force) > 0.0)
            .map(|(at, _)| *at)
    }

    fn last_force(&self, device: usize) -> Option<u64> {
        let commands = self.commands(device);
        commands
            .iter()
            .rev()
            .find(|(_, c)| length(c.asked_force) > 0.0)
            .map(|(at, _)| *at)
    }
}
