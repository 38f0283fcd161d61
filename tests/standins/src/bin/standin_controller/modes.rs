//! Modes of a Force Dimension controller.

use crate::device::Device;
use sulcus_standins::board::{Calibration, Family, Mode, OffCause};
use sulcus_standins::log::{Cause, Event};
use sulcus_standins::pose::norm;

impl Device {
    /// Changes the mode and notes it.
    pub fn set_mode(&mut self, to: Mode, cause: OffCause) {
        let from = self.mode;
        if from == to && self.cause == cause {
            return;
        }
        (self.mode, self.cause) = (to, cause);
        self.note(Event::Mode { from, to, cause });
        if to == Mode::Force {
            self.motors.cut(Cause::Command);
            self.motors.last = self.t;
            self.motors.armed = true;
        } else {
            self.motors.cut(Cause::Mode);
        }
        self.drive();
    }

    /// The driver's call for force, on or off.
    pub fn enable_force(&mut self, on: bool) {
        match (self.mode, on) {
            (Mode::Reset, _) => {}
            (_, true) if !self.lit => self.set_mode(self.mode, OffCause::Button),
            (Mode::Force, true) => {}
            (_, true) => self.set_mode(Mode::Force, OffCause::None),
            (_, false) => self.set_mode(Mode::Idle, OffCause::Software),
        }
    }

    /// The driver's call for the brakes, on or off.
    pub fn set_brakes(&mut self, on: bool) {
        if self.mode == Mode::Reset {
            return;
        }
        let mode = if on { Mode::Brake } else { Mode::Idle };
        self.set_mode(mode, OffCause::Software);
    }

    /// The user pressed the FORCE button. A press that lights it lets a braked device have force again.
    pub fn press_force_button(&mut self, lit: bool) {
        self.lit = lit;
        match (self.mode, lit) {
            (Mode::Force, false) => self.set_mode(Mode::Brake, OffCause::Button),
            (Mode::Brake, true) => self.set_mode(Mode::Force, OffCause::None),
            _ => {}
        }
    }

    /// Brakes a device that is too fast.
    pub fn check_speed(&mut self) {
        let limit = self.setup.speed_trip;
        let trips = self.setup.family == Family::Dhd && self.mode == Mode::Force && limit > 0.0;
        if trips && norm(self.sensors.velocity) > limit {
            self.set_mode(Mode::Brake, OffCause::Velocity);
        }
    }

    /// Ends a running `drdAutoInit` when its time is over.
    pub fn finish_auto_init(&mut self) {
        if self.auto_init.is_some_and(|end| end <= self.t) {
            self.auto_init = None;
            self.calibrated();
        }
    }

    /// The calibration is right from now on.
    pub fn calibrated(&mut self) {
        self.calibration = Calibration::Ok;
        self.sensors.restart();
        self.note(Event::Calibrated);
        if self.mode == Mode::Reset {
            self.set_mode(Mode::Idle, OffCause::None);
        }
    }
}
