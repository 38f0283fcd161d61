//! Faultless sequence of observations: a small model of server, network and device, written from the contracts.

mod pass;
mod step;

use std::collections::VecDeque;

use sulcus_core::{MAX_TOOLS, Vec3, Wrench};
use sulcus_proto::control::Command;

use crate::seen::{Facts, Newest, Seen, Side, Used};

/// Millisecond, nanoseconds.
pub const MS: u64 = 1_000_000;

/// Facts of the model: one tool, limits as shipped.
pub fn facts() -> Facts {
    Facts {
        tools: 1,
        tick_ns: MS,
        max_force_n: 3.3,
        max_torque_nm: 0.2,
        max_force_step_n: 0.5,
        max_torque_step_nm: 0.03,
        queue_rows: 64,
        plan_limit_n: 0.0,
    }
}

/// Events of one millisecond.
#[derive(Clone, Default)]
pub struct Turn {
    /// Orders, before the tick.
    pub orders: Vec<(Side, Command)>,
    /// Whether the connection is lost, before the tick.
    pub is_lost: bool,
    /// Whether the student returns, before the tick.
    pub is_back: bool,
    /// Whether the tick is skipped.
    pub is_skipped: bool,
    /// Whether the device's loop oversleeps its pass.
    pub is_overslept: bool,
    /// Whether the pose is lost.
    pub loses_pose: bool,
    /// Whether the wrench is lost.
    pub loses_wrench: bool,
    /// Delay of the wrench beyond 0.3 ms, nanoseconds.
    pub delay_ns: u64,
}

/// Faults of the model, for the claim that an invariant sees them.
#[derive(Clone, Copy, Default)]
pub struct Faulty {
    /// Whether each tick obeys the levels of the tick before.
    pub late_levels: bool,
    /// Whether the end of a pause begins no epoch.
    pub keeps_epoch: bool,
}

/// Model of a station and its student.
#[derive(Default)]
pub struct Play {
    faulty: Faulty,
    pub events: Vec<(u64, Seen)>,
    now_ms: u64,
    epoch: u32,
    is_attached: bool,
    pauses: [bool; 2],
    limits: [f64; 2],
    levels_before: (bool, f64),
    used: Option<Used>,
    number: u64,
    tick: u64,
    ticks: u64,
    skipped_now: u32,
    skipped: u64,
    strength: f64,
    sent_n: f64,
    on_the_way: VecDeque<(u64, Newest, f64)>,
    newest: Option<(Newest, f64)>,
    overslept: u64,
    gate: f64,
    rise_ms: f64,
    displayed_n: f64,
    gaps: u64,
    is_gap: bool,
}

impl Play {
    pub fn new(faulty: Faulty) -> Self {
        let mut play = Self {
            faulty,
            rise_ms: 500.0,
            ..Self::default()
        };
        play.begin();
        play
    }

    /// Plays milliseconds in which nothing happens.
    pub fn calm(&mut self, milliseconds: u64) {
        self.turns(milliseconds, &Turn::default());
    }

    /// Plays the same turn again and again.
    pub fn turns(&mut self, milliseconds: u64, turn: &Turn) {
        for _ in 0..milliseconds {
            self.turn(turn);
        }
    }

    /// Plays a turn with one order.
    pub fn order(&mut self, side: Side, command: Command) {
        self.turn(&Turn {
            orders: vec![(side, command)],
            ..Turn::default()
        });
    }

    /// Number of the observations so far.
    pub fn mark(&self) -> usize {
        self.events.len()
    }

    /// Plays one millisecond.
    pub fn turn(&mut self, turn: &Turn) {
        self.now_ms += 1;
        if turn.is_lost && self.is_attached {
            self.is_attached = false;
            self.used = None;
            self.on_the_way.clear();
            self.see(0, Seen::Gone);
        }
        if turn.is_back && !self.is_attached {
            self.begin();
        }
        for (side, command) in &turn.orders {
            self.obey(*side, *command);
        }
        if self.is_attached && !turn.loses_pose {
            self.number += 1;
            self.used = Some(Used {
                epoch: self.epoch,
                number: self.number,
                measured_ns: self.now_ms * MS - 900_000,
                arrived_ns: self.now_ms * MS - 400_000,
            });
        }
        if turn.is_skipped {
            self.skipped_now += 1;
        } else {
            self.step(turn);
        }
        if turn.is_overslept {
            self.overslept += 1;
        } else {
            self.pass();
        }
    }

    /// Ends the session and replays the recording.
    pub fn end(&mut self) {
        let (ticks, skipped) = (self.ticks, self.skipped);
        let finished = Seen::Finished {
            ticks,
            skipped,
            rows_dropped: 0,
            error: None,
        };
        self.see(0, finished);
        for _ in 0..60 {
            self.now_ms += 1;
            self.pass();
        }
        let replayed = Seen::Replayed {
            rows: ticks,
            is_equal: true,
            is_whole: true,
            gaps: self.gaps,
        };
        self.see(0, replayed);
    }

    fn see(&mut self, after_ns: u64, seen: Seen) {
        self.events.push((self.now_ms * MS + after_ns, seen));
    }

    fn begin(&mut self) {
        self.epoch += 1;
        self.is_attached = true;
        self.see(0, Seen::Epoch(self.epoch));
    }

    fn obey(&mut self, side: Side, command: Command) {
        let of = usize::from(side == Side::Student);
        self.see(0, Seen::Ordered(side, command));
        match command {
            Command::Pause => self.pauses[of] = true,
            Command::Resume => {
                let ends = std::mem::take(&mut self.pauses[of]);
                if ends && self.is_attached && !self.faulty.keeps_epoch {
                    self.begin();
                }
            }
            Command::ForceLimit(limit) => self.limits[of] = f64::from(limit),
        }
    }
}

/// Force of `x` newtons at the first hand, with a torque in proportion.
pub fn wrenches(x: f64) -> [Wrench; MAX_TOOLS] {
    let mut wrenches = [Wrench::ZERO; MAX_TOOLS];
    wrenches[0] = Wrench {
        force: Vec3::new(0.0, 0.0, x),
        torque: Vec3::new(0.05 * x, 0.0, 0.0),
    };
    wrenches
}

fn slewed(before: f64, target: f64) -> f64 {
    before + (target - before).clamp(-0.5, 0.5)
}
