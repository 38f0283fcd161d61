//! Invariants of a station: what holds after each observation, whatever network, hands and disk do.
//!
//! The sources are the contracts alone: `SECURITY.md`, `CONTRIBUTING.md`, `server/README.md`, `DESIGN.md`, the crate
//! `sulcus-proto`, and the issues of the simulator and of the stations. The bounds were fixed before any run.
//! `bounds.rs` holds every number with its source.
//!
//! [`Watch`] takes the observations of one session in the order of virtual time. Each part below judges one idea.

mod bounds;
mod count;
mod display;
mod end;
mod gate;
mod levels;
mod memory;
mod newest;
mod poses;
mod quiet;
mod recording;
mod sent;
#[cfg(test)]
mod tests;
mod wrench;

use sulcus_core::{MAX_TOOLS, Wrench};

use crate::seen::{Facts, Pass, Seen, Tick};

/// Table of the invariants: number and sentence. The numbers are stable; a new invariant has a new number.
pub const INVARIANTS: [(u8, &str); 18] = [
    (
        1,
        "No force is displayed before the first wrench of the server.",
    ),
    (
        2,
        "Under a pause no force is sent or displayed, once the ramp is over.",
    ),
    (
        3,
        "No force or torque exceeds the smallest limit in force, once the slew limit has had its time.",
    ),
    (
        4,
        "No force is displayed after a silence of the server, once the gate is shut.",
    ),
    (
        5,
        "Sent and displayed force and torque change by at most the slew limit.",
    ),
    (6, "Every number is finite."),
    (
        7,
        "Tick numbers rise by 1 and the skipped grid points, and the sums at the end are those seen.",
    ),
    (
        8,
        "A tick uses only poses that came in their own epoch, in the order of sending, after their arrival.",
    ),
    (
        9,
        "A tool is present only with a pose, and after a lost connection only with a pose of a later epoch.",
    ),
    (
        10,
        "A pause stands until its owner lifts it: every tick obeys the accepted orders of both sides.",
    ),
    (
        11,
        "The recorder's queue keeps its bound, and every tick is a row or a counted loss.",
    ),
    (
        12,
        "The recording replays bit for bit, is whole, and names its gaps.",
    ),
    (13, "A finished session stays finished."),
    (
        14,
        "An epoch is newer than all before it, and no pose of an epoch is taken after the end of a pause in it.",
    ),
    (
        15,
        "An old pose is stale, and no force is sent on it or for an absent tool, once the ramp is over.",
    ),
    (16, "No force is displayed on a pose older than its limit."),
    (
        17,
        "The newest wrench of a device never goes back, and names pause and limit that its tick obeyed.",
    ),
    (
        18,
        "The displayed force grows no faster than the gate opens, after the begin and after a long silence.",
    ),
];

/// Invariant that an observation breaks.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Broken {
    /// Number in [`INVARIANTS`].
    pub number: u8,
    /// Values found and values expected, in one line.
    pub text: String,
}

/// Broken invariants of one observation.
#[derive(Default)]
struct Found(Vec<Broken>);

impl Found {
    /// Adds a broken invariant unless the condition holds.
    fn must(&mut self, holds: bool, number: u8, text: impl FnOnce() -> String) {
        if !holds {
            let text = text();
            self.0.push(Broken { number, text });
        }
    }
}

/// Observer of one session at one station, with its student.
pub struct Watch {
    bounds: bounds::Bounds,
    memory: memory::Memory,
    count: count::Count,
    levels: levels::Levels,
    poses: poses::Poses,
    idle: sent::Idle,
    gate: gate::Gate,
    quiet: quiet::Quiet,
    newest: newest::Newer,
    recording: recording::Recording,
    end: end::End,
    sent: [Wrench; MAX_TOOLS],
    displayed: [Wrench; MAX_TOOLS],
}

impl Watch {
    /// Creates an observer that has seen nothing.
    pub fn new(facts: Facts) -> Self {
        Self {
            count: count::Count::default(),
            memory: memory::Memory::default(),
            levels: levels::Levels::default(),
            poses: poses::Poses::default(),
            idle: sent::Idle::default(),
            gate: gate::Gate::default(),
            quiet: quiet::Quiet::default(),
            newest: newest::Newer::default(),
            recording: recording::Recording::default(),
            end: end::End::default(),
            sent: [Wrench::ZERO; MAX_TOOLS],
            displayed: [Wrench::ZERO; MAX_TOOLS],
            bounds: bounds::Bounds::new(facts),
        }
    }

    /// Takes an observation at a virtual time, nanoseconds, and returns the invariants that it breaks.
    ///
    /// The observations come in the order of time. A session without faults returns an empty list every time.
    pub fn see(&mut self, at_ns: u64, seen: &Seen) -> Vec<Broken> {
        let mut found = Found::default();
        self.end.see(seen, &mut found);
        match seen {
            Seen::Epoch(epoch) => {
                self.poses.begin(*epoch, at_ns, &mut found);
                self.recording.attach();
            }
            Seen::Gone => {
                self.poses.lose();
                self.recording.detach();
            }
            Seen::Ordered(side, command) => {
                if self.levels.order(*side, *command) {
                    self.poses.end_pause(at_ns);
                }
            }
            Seen::Tick(tick) => self.tick(at_ns, tick, &mut found),
            Seen::Queues { recorder } => recording::queue(&self.bounds, *recorder, &mut found),
            Seen::Pass(pass) => self.pass(at_ns, pass, &mut found),
            Seen::Finished {
                ticks,
                skipped,
                rows_dropped,
                error,
            } => {
                self.count.finish(*ticks, *skipped, &mut found);
                self.recording
                    .finish(*ticks, *rows_dropped, error.as_deref());
            }
            Seen::Replayed {
                rows,
                is_equal,
                is_whole,
                gaps,
            } => self
                .recording
                .replay(*rows, *is_equal, *is_whole, *gaps, &mut found),
        }
        found.0
    }

    fn tick(&mut self, at_ns: u64, tick: &Tick, found: &mut Found) {
        self.count.tick(tick, found);
        self.levels.tick(&self.bounds, tick, found);
        self.poses.tick(&self.bounds, at_ns, tick, found);
        self.recording.tick();
        self.memory.keep(tick);
        sent::limits(&self.bounds, &self.sent, tick, found);
        self.idle
            .tick(&self.bounds, at_ns, tick, self.memory.paused_ticks(), found);
        self.sent = tick.sent;
    }

    fn pass(&mut self, at_ns: u64, pass: &Pass, found: &mut Found) {
        self.newest.pass(
            &self.bounds,
            &self.memory,
            self.poses.epoch(),
            at_ns,
            pass,
            found,
        );
        let behind = pass.newest.and_then(|newest| self.memory.of(newest.tick));
        display::limits(&self.bounds, behind, &self.displayed, pass, found);
        self.gate
            .pass(&self.bounds, at_ns, &self.displayed, pass, found);
        self.quiet.pass(&self.bounds, at_ns, behind, pass, found);
        self.displayed = pass.displayed;
        if let Some(newest) = pass.newest {
            self.memory.forget_before(newest.tick);
        }
    }
}
