//! Faults that a test causes.

use crate::device::Device;
use std::sync::atomic::Ordering;
use sulcus_standins::Fault;
use sulcus_standins::board::{Board, Calibration, Family, Mode, OffCause};
use sulcus_standins::log::{Cause, Event};
use sulcus_standins::pose::add;

impl Device {
    /// Causes a fault of this device or of the drivers.
    pub fn fault(&mut self, board: &Board, fault: Fault) {
        self.note(Event::Fault(fault.clone()));
        let driver = &board.driver;
        match fault {
            Fault::Unplug => self.unplug(),
            Fault::Replug => self.replug(),
            Fault::Warm => self.heat.value = self.setup.heat_budget,
            Fault::Cool => self.heat.value = 0.0,
            Fault::Stall(ms) => {
                driver.stall.store(ms, Ordering::Relaxed);
                driver.stalls.fetch_add(1, Ordering::Release);
            }
            Fault::Jitter(us) => driver.jitter.store(us, Ordering::Relaxed),
            Fault::Rate(hz) => driver.real_rate.store(hz, Ordering::Relaxed),
            Fault::Calibration(Calibration::Ok) => self.calibrated(),
            Fault::Calibration(state) => self.lose_calibration(state),
            Fault::PoseNan(nan) => self.sensors.nan = nan,
            Fault::Jump(by) => self.sensors.jump = add(self.sensors.jump, by, 1.0),
            Fault::Buttons(bits) => self.buttons = bits,
            Fault::Inkwell(inside) => self.inkwell = inside,
            Fault::ForceButton(lit) => self.press_force_button(lit),
            Fault::DeadMan if self.mode == Mode::Force => {
                self.set_mode(Mode::Brake, OffCause::DeadMan)
            }
            Fault::DeadMan => {}
            Fault::Error(code) => self.slot.error.store(code, Ordering::Release),
            Fault::OpenError(code) => self.slot.open_error.store(code, Ordering::Release),
            Fault::CrashOnDisable(on) => {
                driver.crash_on_disable.store(on.into(), Ordering::Relaxed)
            }
            Fault::Version(version) => driver.hd_version.set(&version),
            Fault::WatchdogMs(ms) => self.setup.watchdog_ms = ms,
            Fault::LatencyUs(us) => self.setup.latency_us = us,
        }
        self.drive();
        self.publish();
    }

    /// The box gets no command from now on; its watchdog turns the motors off.
    fn unplug(&mut self) {
        self.plugged = false;
        self.slot.plugged.store(0, Ordering::Release);
        if self.setup.family == Family::Dhd && self.mode == Mode::Force {
            self.set_mode(Mode::Brake, OffCause::UsbLost);
        }
    }

    fn replug(&mut self) {
        if !self.plugged {
            self.motors.cut(Cause::Unplugged);
        }
        self.plugged = true;
        self.slot.locked.store(0, Ordering::Release);
        self.slot.plugs.fetch_add(1, Ordering::AcqRel);
        self.slot.plugged.store(1, Ordering::Release);
    }

    fn lose_calibration(&mut self, state: Calibration) {
        self.calibration = state;
        self.updates = 0;
        if self.setup.family == Family::Dhd {
            self.set_mode(Mode::Reset, OffCause::None);
        }
    }
}
