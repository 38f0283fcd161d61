//! Measures of what a client sent to an arm.

use super::entry::{IdleCause, What};
use super::reader::Log;
use crate::Vector;
use crate::device::norm;

/// Time that a change is measured over, in ns.
const MILLISECOND_NS: u64 = 1_000_000;

/// A force that a client sent to an arm.
#[derive(Debug, Clone, PartialEq)]
pub struct Sent {
    /// Time of the message, in ns.
    pub t_ns: u64,
    /// Number of the connection.
    pub connection: u64,
    /// Field that the client used.
    pub field: Option<String>,
    /// Force in N; none where it was unreadable.
    pub force: Option<Vector>,
    /// Force that the arm displayed after the message, in N.
    pub displayed: Vector,
    /// True where the service carried the command out.
    pub done: bool,
}

impl Sent {
    /// Length of the force in N; zero where it was unreadable.
    #[must_use]
    pub fn norm(&self) -> f64 {
        self.force.map_or(0.0, norm)
    }
}

/// Idle state of an arm.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct IdleSpan {
    /// Time of the start of the idle state, in ns.
    pub t_ns: u64,
    /// Time of the last command before, in ns.
    pub last_command_ns: u64,
    /// Cause.
    pub cause: IdleCause,
}

impl IdleSpan {
    /// Time from the last command to the idle state, in ns.
    #[must_use]
    pub fn after_ns(&self) -> u64 {
        self.t_ns.saturating_sub(self.last_command_ns)
    }
}

impl Log {
    /// Forces that clients sent to an arm, in the order of time.
    #[must_use]
    pub fn forces(&self, device: &str) -> Vec<Sent> {
        let mut sent = Vec::new();
        for entry in &self.entries {
            let What::Message {
                connection,
                commands,
                ..
            } = &entry.what
            else {
                continue;
            };
            for command in commands {
                if command.device == device && command.name == "set_cursor_force" {
                    sent.push(Sent {
                        t_ns: entry.t_ns,
                        connection: *connection,
                        field: command.field.clone(),
                        force: command.force,
                        displayed: command.displayed.unwrap_or_default(),
                        done: command.done,
                    });
                }
            }
        }
        sent
    }

    /// Greatest force that a client sent to an arm, in N; zero without a command.
    #[must_use]
    pub fn largest_force(&self, device: &str) -> f64 {
        self.forces(device)
            .iter()
            .map(Sent::norm)
            .fold(0.0, f64::max)
    }

    /// Greatest force that an arm displayed right after a command, in N.
    #[must_use]
    pub fn largest_displayed(&self, device: &str) -> f64 {
        self.forces(device)
            .iter()
            .map(|sent| norm(sent.displayed))
            .fold(0.0, f64::max)
    }

    /// Greatest change between a force and the next, in N; from zero at the first command and after an idle state.
    #[must_use]
    pub fn largest_step(&self, device: &str) -> f64 {
        let runs = self.runs(device);
        let steps = runs
            .iter()
            .flat_map(|run| run.windows(2))
            .map(|pair| change(pair[0], pair[1]));
        steps.fold(0.0, f64::max)
    }

    /// Greatest change of the force, in N per ms, over every span up to 1 ms and between every force and the next.
    ///
    /// A span shorter than 1 ms counts as 1 ms. The force before the first command and after an idle state is zero.
    #[must_use]
    pub fn largest_change_per_ms(&self, device: &str) -> f64 {
        let mut largest: f64 = 0.0;
        for run in self.runs(device) {
            for (index, &new) in run.iter().enumerate() {
                for (back, &old) in run[..index].iter().rev().enumerate() {
                    let span_ns = new.0 - old.0;
                    if back > 0 && span_ns > MILLISECOND_NS {
                        break;
                    }
                    largest =
                        largest.max(change(old, new) / (span_ns.max(MILLISECOND_NS) as f64 * 1e-6));
                }
            }
        }
        largest
    }

    /// Idle states of an arm.
    #[must_use]
    pub fn idles(&self, wanted: &str) -> Vec<IdleSpan> {
        let mut spans = Vec::new();
        for entry in &self.entries {
            if let What::Idle {
                device,
                cause,
                last_command_ns,
            } = &entry.what
                && device == wanted
            {
                spans.push(IdleSpan {
                    t_ns: entry.t_ns,
                    last_command_ns: *last_command_ns,
                    cause: *cause,
                });
            }
        }
        spans
    }

    /// Time from `t_ns` to the last force greater than `newtons`, in ns; zero without such a force.
    #[must_use]
    pub fn quiet_after_ns(&self, device: &str, t_ns: u64, newtons: f64) -> u64 {
        let loud = self
            .forces(device)
            .into_iter()
            .rfind(|sent| sent.t_ns >= t_ns && sent.norm() > newtons);
        loud.map_or(0, |sent| sent.t_ns - t_ns)
    }

    /// Longest time between two messages of one connection, in ns; zero with fewer than two.
    #[must_use]
    pub fn longest_gap_ns(&self, wanted: u64) -> u64 {
        let mut last = None;
        let mut longest = 0;
        for entry in &self.entries {
            if matches!(entry.what, What::Message { connection, .. } if connection == wanted) {
                longest = longest.max(last.map_or(0, |t| entry.t_ns - t));
                last = Some(entry.t_ns);
            }
        }
        longest
    }

    /// Forces with their time in ns, in runs without an idle state; each run starts with zero 1 ms before.
    fn runs(&self, wanted: &str) -> Vec<Vec<(u64, Vector)>> {
        let mut runs: Vec<Vec<(u64, Vector)>> = vec![Vec::new()];
        for entry in &self.entries {
            match &entry.what {
                What::Idle { device, .. } if device == wanted => runs.push(Vec::new()),
                What::Message { commands, .. } => {
                    for command in commands.iter().filter(|command| command.device == wanted) {
                        let (Some(force), Some(run)) = (command.force, runs.last_mut()) else {
                            continue;
                        };
                        if run.is_empty() {
                            run.push((entry.t_ns.saturating_sub(MILLISECOND_NS), [0.0; 3]));
                        }
                        run.push((entry.t_ns, force));
                    }
                }
                _ => {}
            }
        }
        runs
    }
}

fn change(old: (u64, Vector), new: (u64, Vector)) -> f64 {
    norm(std::array::from_fn(|i| new.1[i] - old.1[i]))
}
