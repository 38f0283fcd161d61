//! One hand in a tick of the scheduler: read, exchange, send. Nothing here allocates, locks, logs or waits.

use std::sync::atomic::Ordering::Relaxed;

use sulcus_core::{Pose, Wrench};
use sulcus_haptics::port::HandPort;
use sulcus_haptics::{Stage, Trip, Unready};

use super::api::Handle;
use super::calibration::{Calibration, Step};
use super::errors::Class;
use super::frame::{Current, Frame};
use super::pose::pose;
use super::shared::{HandState, Order};
use super::sys::{self, ErrorInfo};

/// Number of ticks after the start, or after a calibration, before a pose counts. SOFA waits as long.
const SETTLE: u32 = 50;

/// Number of ticks without a refusal after which the output of force may be turned on again.
const COOL: u32 = 100;

/// Longest time between two ticks with a force, nanoseconds. The hardware cuts a force off about 20 ms after the last
/// tick, and the force must not return at once.
const LONGEST_GAP_NS: u64 = 15_000_000;

/// A hand and its device.
#[derive(Debug)]
pub struct Hand {
    /// End of the door.
    pub port: HandPort,
    /// Device of the library; `None` for a device that is lost.
    pub handle: Option<Handle>,
    /// Whether the device displays torque.
    pub has_torque: bool,
    /// Whether the output of force is on.
    pub output: bool,
    calibration: Calibration,
    /// Number of ticks with a valid calibration.
    age: u32,
    /// Number of ticks since the last refusal, while a refusal holds.
    refused: Option<u32>,
    last_ns: Option<u64>,
    sent: Wrench,
}

impl Hand {
    /// Hand of a device that is not in use yet.
    pub fn new(port: HandPort, has_torque: bool) -> Self {
        Self {
            port,
            handle: None,
            has_torque,
            output: false,
            calibration: Calibration::new(0),
            age: 0,
            refused: None,
            last_ns: None,
            sent: Wrench::ZERO,
        }
    }

    /// Takes a device into use. `output` tells whether its output of force is on, `styles` are its ways of calibration.
    /// A device that the hand has already keeps its state.
    pub fn take(&mut self, handle: Handle, styles: u32, output: bool) {
        self.output = output;
        self.last_ns = None;
        if self.handle.replace(handle) == Some(handle) {
            return;
        }
        self.calibration = Calibration::new(styles);
        (self.age, self.refused) = (0, None);
    }

    /// Performs a period without a device.
    pub fn absent(&mut self, now_ns: u64) {
        self.handle = None;
        self.last_ns = None;
        self.sent = self.port.exchange(now_ns, Err(Unready::Absent), 0);
    }

    /// Whether the newest wrench is zero.
    pub fn is_still(&self) -> bool {
        self.handle.is_none() || self.sent == Wrench::ZERO
    }

    /// Accounts for an error of the library about this device.
    pub fn note(&mut self, error: &ErrorInfo, state: &HandState) {
        match error.class() {
            Class::Force => {
                self.refused = Some(0);
                state.refused.store(error.code, Relaxed);
                state.refusals.fetch_add(1, Relaxed);
            }
            Class::Lost => state.lost.store(error.code, Relaxed),
            Class::Other => {
                state.other.store(error.code, Relaxed);
                state.others.fetch_add(1, Relaxed);
            }
        }
    }

    /// Performs a period in the open frame of the device.
    pub fn period(&mut self, frame: &Frame<'_>, now_ns: u64, order: Order, state: &HandState) {
        let device = frame.device();
        let buttons = device.integer(sys::CURRENT_BUTTONS) as u16;
        let pose = self.read(device, buttons != 0, state);
        let pose = if order == Order::Stop {
            Err(Unready::NoPose)
        } else {
            pose
        };
        self.watch_gap(now_ns, state);
        self.refuse();
        let wrench = self
            .port
            .exchange(now_ns, pose.as_ref().map_err(|unready| *unready), buttons);
        self.switch(device);
        self.sent = if self.output {
            finite(&wrench)
        } else {
            Wrench::ZERO
        };
        frame.set_force(self.sent.force.into());
        if self.has_torque {
            frame.set_torque(self.sent.torque.into());
        }
    }

    /// Reads the pose, and advances the calibration.
    fn read(
        &mut self,
        device: &Current<'_>,
        is_pressed: bool,
        state: &HandState,
    ) -> Result<Pose, Unready> {
        if self.calibration.is_due() {
            let found = device.calibration();
            let step = self.calibration.step(found, is_pressed);
            if let Step::Update(style) = step {
                device.update_calibration(style);
            }
            let shown = if step == Step::Ready { 0 } else { found.max(1) };
            state.uncalibrated.store(shown, Relaxed);
        }
        if !self.calibration.is_ready() {
            self.age = 0;
            return Err(Unready::Uncalibrated);
        }
        self.age = self.age.saturating_add(1);
        let transform = device.doubles(sys::CURRENT_TRANSFORM);
        let pose = pose(&transform).filter(|_| self.age > SETTLE);
        pose.ok_or(Unready::NoPose)
    }

    /// Trips after a gap between two ticks in which the hardware may have cut the force off.
    fn watch_gap(&mut self, now_ns: u64, state: &HandState) {
        let gap = self.last_ns.map_or(0, |last| now_ns.saturating_sub(last));
        self.last_ns = Some(now_ns);
        if gap > LONGEST_GAP_NS && self.sent != Wrench::ZERO {
            self.port.trip(Trip::Driver);
            state.gaps.fetch_add(1, Relaxed);
        }
    }

    /// Keeps the force away while the driver refuses force, and until the person has pressed a button after that.
    fn refuse(&mut self) {
        let Some(since) = self.refused else {
            return;
        };
        let stage = self.port.stage();
        if since >= COOL && !matches!(stage, Stage::Tripped(_)) {
            self.refused = None;
            return;
        }
        self.refused = Some(since.saturating_add(1));
        if since < COOL && stage != Stage::Tripped(Trip::Driver) {
            self.port.trip(Trip::Driver);
        }
    }

    /// Turns the device's output of force on or off.
    fn switch(&mut self, device: &Current<'_>) {
        let wanted = self.calibration.is_ready() && self.refused.is_none();
        if wanted != self.output {
            self.output = wanted;
            output(device, wanted);
        }
    }
}

/// Turns the output of force and its rise on, or the output off.
pub fn output(device: &Current<'_>, on: bool) {
    if on {
        device.enable(sys::FORCE_OUTPUT);
        device.enable(sys::FORCE_RAMPING);
    } else {
        device.disable(sys::FORCE_OUTPUT);
    }
}

/// Returns `wrench`, or zero for a number that is not finite.
fn finite(wrench: &Wrench) -> Wrench {
    let mut all = wrench.force.iter().chain(wrench.torque.iter());
    if all.all(|x| x.is_finite()) {
        *wrench
    } else {
        Wrench::ZERO
    }
}
