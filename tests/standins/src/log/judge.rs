//! Numbers about a log that tests judge by.

use super::{Closed, CommandEntry, Entry, Event, Log};
use crate::clock::MS;
use crate::pose::{V3, norm, sub};
use crate::setup::Setup;

impl Log {
    /// Entries about a device.
    pub fn device(&self, device: usize) -> impl Iterator<Item = &Entry> {
        self.entries
            .iter()
            .filter(move |e| e.device == Some(device))
    }

    /// Commands for a device with their times in ns.
    pub fn commands(&self, device: usize) -> Vec<(u64, &CommandEntry)> {
        self.device(device)
            .filter_map(|e| match &e.event {
                Event::Command(c) => Some((e.t, c)),
                _ => None,
            })
            .collect()
    }

    /// Number of frames or commands of a device.
    pub fn frames(&self, device: usize) -> usize {
        self.commands(device).len()
    }

    /// Output of a device's motors: time in ns, force in N, torque in N m. Each holds until the next.
    pub fn motors(&self, device: usize) -> Vec<(u64, V3, V3)> {
        self.device(device)
            .filter_map(|e| match e.event {
                Event::Motors { force, torque, .. } => Some((e.t, force, torque)),
                _ => None,
            })
            .collect()
    }

    /// Codes of the errors that the driver reported about a device.
    pub fn errors(&self, device: usize) -> Vec<u32> {
        self.device(device)
            .filter_map(|e| match e.event {
                Event::Error { code, .. } => Some(code),
                _ => None,
            })
            .collect()
    }

    /// Times in ns at which the watchdog of a device fired.
    pub fn watchdogs(&self, device: usize) -> Vec<u64> {
        self.times(device, |event| matches!(event, Event::Watchdog { .. }))
    }

    /// Times in ns of the events of a device that `wanted` accepts.
    pub fn times(&self, device: usize, wanted: impl Fn(&Event) -> bool) -> Vec<u64> {
        self.device(device)
            .filter(|e| wanted(&e.event))
            .map(|e| e.t)
            .collect()
    }

    /// Time in ns at which the owner of a device died, if it did.
    pub fn death(&self, device: usize) -> Option<u64> {
        let died = |event: &Event| {
            matches!(
                event,
                Event::Close {
                    way: Closed::Died,
                    ..
                }
            )
        };
        self.times(device, died).last().copied()
    }

    /// Largest force in N that the client asked for; NaN when it asked for a number that is not finite.
    pub fn largest_asked(&self, device: usize) -> f64 {
        largest(self.commands(device).iter().map(|(_, c)| c.asked_force))
    }

    /// Largest force in N that the motors put out.
    pub fn largest_force(&self, device: usize) -> f64 {
        largest(self.motors(device).iter().map(|m| m.1))
    }

    /// Largest torque in N m that the motors put out.
    pub fn largest_torque(&self, device: usize) -> f64 {
        largest(self.motors(device).iter().map(|m| m.2))
    }

    /// Largest difference in N between two outputs of the motors at most 1 ms apart.
    /// Two commands of a late scheduler may fall into one such window.
    pub fn largest_change_per_ms(&self, device: usize) -> f64 {
        let motors = self.motors(device);
        let mut most = 0.0f64;
        for (k, (t, force, _)) in motors.iter().enumerate() {
            let mut reached = false;
            for (u, held, _) in motors[..k].iter().rev() {
                most = most.max(norm(sub(*force, *held)));
                reached = u + MS < *t;
                if reached {
                    break;
                }
            }
            if !reached {
                most = most.max(norm(*force));
            }
        }
        most
    }

    /// Largest difference in N between a command and the command before it, as the client asked for them.
    pub fn largest_step(&self, device: usize) -> f64 {
        let mut before = [0.0; 3];
        let mut most = 0.0f64;
        for (_, c) in self.commands(device) {
            most = most.max(norm(sub(c.asked_force, before)));
            before = c.asked_force;
        }
        most
    }

    /// Time in ns from the last command to the moment when the motors stay at zero; 0 when they were at zero already.
    /// None without a command, or when the motors still put out force.
    pub fn last_command_to_zero(&self, device: usize) -> Option<u64> {
        let (last, _) = *self.commands(device).last()?;
        let motors = self.motors(device);
        match motors.last() {
            None => Some(0),
            Some((t, force, torque)) if norm(*force) == 0.0 && norm(*torque) == 0.0 => {
                Some(t.saturating_sub(last))
            }
            Some(_) => None,
        }
    }

    /// Force and torque of the motors at the time `t` in ns.
    pub fn output_at(&self, device: usize, t: u64) -> (V3, V3) {
        self.motors(device)
            .iter()
            .rev()
            .find(|m| m.0 <= t)
            .map_or(([0.0; 3], [0.0; 3]), |m| (m.1, m.2))
    }

    /// Times in ns between the commands of a device.
    pub fn intervals(&self, device: usize) -> Vec<u64> {
        self.commands(device)
            .windows(2)
            .map(|pair| pair[1].0.saturating_sub(pair[0].0))
            .collect()
    }

    /// What makes the log incomplete or wrong; empty for a sound log.
    /// The check reads lost messages, frame numbers with gaps, times that go back and motors above the model's limits.
    pub fn flaws(&self, setup: &Setup) -> Vec<String> {
        let mut flaws = Vec::new();
        for entry in &self.entries {
            if let Event::Lost(count) = entry.event {
                flaws.push(format!("{count} messages were lost"));
            }
        }
        for (device, of) in setup.devices.iter().enumerate() {
            let mut frame = 0;
            let mut t = 0;
            for entry in self.device(device) {
                if entry.t < t {
                    flaws.push(format!("device {device}: time goes back at {}", entry.t));
                }
                t = entry.t;
                match &entry.event {
                    Event::Open { .. } => frame = 0,
                    Event::Command(c) if c.frame != frame + 1 => {
                        flaws.push(format!(
                            "device {device}: frame {} follows frame {frame}",
                            c.frame
                        ));
                        frame = c.frame;
                    }
                    Event::Command(c) => frame = c.frame,
                    _ => {}
                }
            }
            let force = self.largest_force(device);
            if force > of.traits.max_force * (1.0 + 1e-9) {
                flaws.push(format!("device {device}: the motors put out {force} N"));
            }
        }
        flaws
    }
}

/// Largest length; NaN when a length is NaN.
fn largest(vectors: impl Iterator<Item = V3>) -> f64 {
    vectors.map(norm).fold(0.0, |most: f64, length| {
        if most.is_nan() || length.is_nan() {
            f64::NAN
        } else {
            most.max(length)
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::log::Cause;

    /// A log of motor outputs along x: time in us, force in N.
    fn motors(outputs: &[(u64, f64)]) -> Log {
        let entry = |(us, x): &(u64, f64)| Entry {
            t: us * 1000,
            seen: us * 1000,
            device: Some(0),
            event: Event::Motors {
                force: [*x, 0.0, 0.0],
                torque: [0.0; 3],
                cause: Cause::Command,
            },
        };
        Log {
            entries: outputs.iter().map(entry).collect(),
        }
    }

    #[test]
    fn the_change_per_ms_reads_every_output_that_held_within_the_last_ms() {
        let change = |outputs: &[(u64, f64)]| motors(outputs).largest_change_per_ms(0);
        assert_eq!(change(&[]), 0.0);
        // The motors were at zero before the first entry.
        assert_eq!(change(&[(5000, 1.0)]), 1.0);
        // Two steps within one ms add up; two steps 2 ms apart do not.
        assert_eq!(change(&[(5000, 1.0), (5400, 2.0)]), 2.0);
        assert_eq!(change(&[(5000, 1.0), (7000, 2.0)]), 1.0);
        // An output that ended within the last ms counts, also in the middle of a log.
        assert_eq!(change(&[(1000, 1.0), (5000, -1.0), (5500, 1.5)]), 2.5);
        assert_eq!(change(&[(1000, 1.0), (3000, 2.0), (3500, 3.0)]), 2.0);
    }

    #[test]
    fn a_force_that_stays_on_has_no_time_to_zero() {
        let mut log = motors(&[(1000, 1.0), (21_000, 0.0)]);
        assert_eq!(log.last_command_to_zero(0), None, "no command");
        let command = CommandEntry {
            pid: 1,
            frame: 1,
            tick: 1,
            pose_stamp: 0,
            sets: 1,
            enabled: true,
            asked_force: [1.0, f64::NAN, 0.0],
            asked_torque: [0.0; 3],
            force: [0.0; 3],
            torque: [0.0; 3],
            ignored: None,
            position: [0.0; 3],
        };
        let first = Entry {
            event: Event::Command(command),
            ..log.entries[0].clone()
        };
        let text = serde_json::to_string(&first).expect("text");
        log.entries
            .insert(0, serde_json::from_str(&text).expect("an entry"));
        assert!(log.largest_asked(0).is_nan(), "NaN survives the file");
        assert_eq!(log.last_command_to_zero(0), Some(20_000_000));
        log.entries.pop();
        assert_eq!(log.last_command_to_zero(0), None, "the motors are on");
    }
}
