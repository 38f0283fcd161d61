//! Period of one device: measure, exchange at the hand's door, send. Nothing here allocates, locks or logs.

use std::sync::atomic::Ordering::Relaxed;

use sulcus_core::{Pose, Wrench};
use sulcus_haptics::port::HandPort;
use sulcus_haptics::{Stage, Trip, Unready};

use super::api::{Code, Reading};
use super::axes;
use super::errors::{Class, Mode, mode};
use super::shared::HandState;
use super::unit::Unit;

/// Time between two looks at the status, nanoseconds.
const LOOK_NS: u64 = 1_000_000;

/// Time that the controller has to turn the force on, nanoseconds.
const GRACE_NS: u64 = 30_000_000;

/// Longest age of a pose, nanoseconds.
const OLD_NS: u64 = 5_000_000;

/// Time without a pose after which the device counts as lost, nanoseconds.
const LOST_NS: u64 = 1_000_000_000;

/// Number of commands in sequence that fail before the force is taken off.
const FAILURES: u32 = 4;

/// Time of zero force before the force is turned on at the start, nanoseconds.
const SETTLE_NS: u64 = 50_000_000;

/// Longest time between two commands with a force, nanoseconds: the controller takes the force off after 18 ms, and the
/// force must not return at once.
const LONGEST_GAP_NS: u64 = 15_000_000;

/// A hand at its open device.
pub struct Servo<'a> {
    unit: &'a Unit,
    port: &'a mut HandPort,
    state: &'a HandState,
    started_ns: u64,
    looked_ns: u64,
    is_asked: bool,
    mode: Mode,
    stage: Stage,
    /// Until when the controller may turn the force on.
    grace_ns: u64,
    /// Newest pose and its time.
    pose: Option<(Pose, u64)>,
    last_ns: u64,
    failures: u32,
    sent: Wrench,
}

impl<'a> Servo<'a> {
    /// Begins at `now_ns`.
    pub fn new(unit: &'a Unit, port: &'a mut HandPort, state: &'a HandState, now_ns: u64) -> Self {
        Self {
            unit,
            stage: port.stage(),
            port,
            state,
            started_ns: now_ns,
            looked_ns: 0,
            is_asked: false,
            mode: Mode::Off,
            grace_ns: 0,
            pose: None,
            last_ns: now_ns,
            failures: 0,
            sent: Wrench::ZERO,
        }
    }

    /// Whether the newest command is zero.
    pub fn is_still(&self) -> bool {
        self.sent == Wrench::ZERO
    }

    /// Performs a period. `is_ending` lets the force fall to zero. Returns false for a device that is lost.
    pub fn period(&mut self, now_ns: u64, is_ending: bool) -> bool {
        self.state.periods.fetch_add(1, Relaxed);
        let pose = self.read(now_ns);
        if self.mode == Mode::Lost {
            self.sent = self.port.exchange(now_ns, Err(Unready::Absent), 0);
            return false;
        }
        let pose = if is_ending {
            Err(Unready::NoPose)
        } else {
            pose
        };
        self.watch(now_ns);
        let buttons = self.unit.dhd.buttons(self.unit.id);
        let pose = pose.as_ref().map_err(|unready| *unready);
        let wrench = self.port.exchange(now_ns, pose, buttons);
        let mut all = wrench.force.iter().chain(wrench.torque.iter());
        let is_finite = all.all(|x| x.is_finite());
        self.sent = if is_finite { wrench } else { Wrench::ZERO };
        self.send()
    }

    /// Measures, and looks at the status once per millisecond.
    fn read(&mut self, now_ns: u64) -> Result<Pose, Unready> {
        let Unit { dhd, id, model, .. } = self.unit;
        match dhd.measure(*id, model.has_wrist) {
            Reading::New(measured) => match axes::pose(&measured) {
                Some(pose) => self.pose = Some((pose, now_ns)),
                None => self.pose = None,
            },
            Reading::TooSoon => {}
            Reading::Failed(code) => self.failed(code),
        }
        if now_ns.saturating_sub(self.looked_ns) >= LOOK_NS && self.mode != Mode::Lost {
            self.looked_ns = now_ns;
            match dhd.status(*id) {
                Ok(status) => self.mode = mode(&status),
                Err(code) => self.failed(code),
            }
        }
        let since = self.pose.map_or(self.started_ns, |(_, at)| at);
        if now_ns.saturating_sub(since) > LOST_NS
            && !matches!(self.mode, Mode::Reset | Mode::NoPower)
        {
            self.mode = Mode::Lost;
        }
        self.state.mode.store(self.mode as u32, Relaxed);
        match (self.mode, self.pose) {
            (Mode::Reset, _) => Err(Unready::Uncalibrated),
            (Mode::NoPower, _) => Err(Unready::NoPose),
            (_, Some((pose, at)))
                if now_ns.saturating_sub(at) <= OLD_NS
                    && now_ns.saturating_sub(self.started_ns) > SETTLE_NS =>
            {
                Ok(pose)
            }
            _ => Err(Unready::NoPose),
        }
    }

    /// Accounts for an error.
    fn failed(&mut self, code: Code) {
        self.state.error.store(code.0.unsigned_abs(), Relaxed);
        self.state.errors.fetch_add(1, Relaxed);
        if code.class() == Class::Lost {
            self.mode = Mode::Lost;
        }
    }

    /// Turns the controller's force on when the person starts the force, and trips when the controller has none.
    fn watch(&mut self, now_ns: u64) {
        let gap = now_ns.saturating_sub(self.last_ns);
        self.last_ns = now_ns;
        if gap > LONGEST_GAP_NS && self.sent != Wrench::ZERO {
            self.port.trip(Trip::Driver);
            self.state.gaps.fetch_add(1, Relaxed);
        }
        let was = std::mem::replace(&mut self.stage, self.port.stage());
        let has_force = |stage| matches!(stage, Stage::Rising | Stage::Live);
        if matches!(self.mode, Mode::Force | Mode::Reset | Mode::NoPower) {
            return;
        }
        let starts = has_force(self.stage) && !has_force(was);
        let is_first = !self.is_asked && now_ns.saturating_sub(self.started_ns) > SETTLE_NS / 2;
        if starts || is_first {
            self.is_asked = true;
            self.grace_ns = now_ns + GRACE_NS;
            if let Err(code) = self.unit.dhd.enable_force(self.unit.id, true) {
                self.failed(code);
            }
        } else if has_force(self.stage) && now_ns > self.grace_ns {
            self.port.trip(Trip::Driver);
        }
    }

    /// Sends the wrench. Returns false for a device that is lost.
    fn send(&mut self) -> bool {
        let Unit { dhd, id, model, .. } = self.unit;
        let torque = (model.torque_axes > 0).then(|| axes::from_base(&self.sent.torque));
        match dhd.display(*id, axes::from_base(&self.sent.force), torque) {
            Ok(is_saturated) => {
                self.failures = 0;
                self.state
                    .saturated
                    .fetch_add(u64::from(is_saturated), Relaxed);
            }
            // A device without calibration takes no command.
            Err(_) if self.mode == Mode::Reset => {}
            Err(code) => {
                self.failed(code);
                self.failures += 1;
                if self.failures >= FAILURES {
                    self.port.trip(Trip::Driver);
                }
            }
        }
        self.mode != Mode::Lost
    }
}
