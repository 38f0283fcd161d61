//! One device box: its time, its motors, its handle and what it shows on the board.

use crate::handle::{Handle, Load};
use crate::heat::Heat;
use crate::journal::Journal;
use crate::motors::{Motors, Output};
use crate::sensors::Sensors;
use std::collections::VecDeque;
use std::rc::Rc;
use std::sync::atomic::Ordering;
use sulcus_standins::board::{Calibration, Family, Mode, OffCause, Slot};
use sulcus_standins::log::{Cause, Event};
use sulcus_standins::pose::norm;
use sulcus_standins::setup::DeviceSetup;

/// Step of the mechanics in ns: 10 kHz.
pub const STEP: u64 = 100_000;

/// Standard gravity in m/s^2.
const G: f64 = 9.806_65;

/// One device box.
pub struct Device {
    pub index: usize,
    pub setup: DeviceSetup,
    pub slot: &'static Slot,
    pub journal: Rc<Journal>,
    /// Time of the box, ns.
    pub t: u64,
    pub motors: Motors,
    pub handle: Handle,
    pub sensors: Sensors,
    pub heat: Heat,
    pub calibration: Calibration,
    pub updates: u32,
    pub mode: Mode,
    pub cause: OffCause,
    pub lit: bool,
    pub gravity: bool,
    /// Mass in kg that gravity compensation carries.
    pub carried: f64,
    pub plugged: bool,
    pub buttons: u64,
    pub inkwell: bool,
    /// End of a running `drdAutoInit`, ns.
    pub auto_init: Option<u64>,
    pub commands: u64,
    pub recent: VecDeque<u64>,
    ticks: u64,
}

impl Device {
    /// A box that is switched on at `t`.
    pub fn new(
        index: usize,
        setup: DeviceSetup,
        slot: &'static Slot,
        journal: Rc<Journal>,
        t: u64,
    ) -> Self {
        let mode = match (setup.family, setup.calibration.state) {
            (Family::Hd, _) => Mode::Force,
            (Family::Dhd, Calibration::Ok) => Mode::Idle,
            (Family::Dhd, _) => Mode::Reset,
        };
        let mut device = Self {
            index,
            t,
            motors: Motors::default(),
            handle: Handle::new(setup.hand.clone()),
            sensors: Sensors::default(),
            heat: Heat::default(),
            calibration: setup.calibration.state,
            updates: 0,
            mode,
            cause: OffCause::None,
            lit: setup.lit,
            gravity: true,
            carried: setup.weight,
            plugged: true,
            buttons: 0,
            inkwell: false,
            auto_init: None,
            commands: 0,
            recent: VecDeque::new(),
            ticks: 0,
            setup,
            slot,
            journal,
        };
        device.identify();
        device.record();
        device.publish();
        device
    }

    fn identify(&self) {
        let (slot, setup) = (self.slot, &self.setup);
        slot.traits.store(setup.traits);
        slot.name.set(&setup.name);
        slot.model.set(&setup.model);
        slot.serial.set(&setup.serial);
        slot.firmware.set(&setup.firmware);
        slot.driver_version.set(&setup.driver_version);
        slot.vendor.set(&setup.vendor);
        slot.plugged.store(1, Ordering::Relaxed);
        slot.plugs.store(1, Ordering::Relaxed);
        slot.open_error.store(setup.open_error, Ordering::Relaxed);
        slot.family
            .store(setup.family as u32 + 1, Ordering::Release);
    }

    /// Adds an event of this moment to the log.
    pub fn note(&self, event: Event) {
        self.journal.add(self.t, Some(self.index), event);
    }

    /// Runs the box up to the time `to`.
    pub fn advance(&mut self, to: u64) {
        while self.t + STEP <= to {
            self.t += STEP;
            self.step();
        }
    }

    fn step(&mut self) {
        if self.motors.silent(&self.setup, self.t) {
            let silent = self.t - self.motors.last;
            self.note(Event::Watchdog { silent });
            self.motors.cut(Cause::Watchdog);
            if self.setup.family == Family::Dhd {
                self.set_mode(Mode::Brake, OffCause::Watchdog);
            }
        }
        self.finish_auto_init();
        self.drive();
        let dt = STEP as f64 * 1e-9;
        let load = self.load();
        self.handle.step(&self.setup, &load, dt);
        let (force, continuous) = (
            norm(self.motors.output.force),
            self.setup.traits.continuous_force,
        );
        if self
            .heat
            .step(force, continuous, self.setup.heat_budget, dt)
        {
            self.note(Event::Warm(self.heat.warm));
        }
        self.ticks += 1;
        if self.ticks.is_multiple_of(10) {
            self.record();
            self.check_speed();
        }
    }

    /// Sets the motors' output of this moment and notes a change of it.
    pub fn drive(&mut self) {
        let block = self.block();
        if self.motors.step(self.t, block) {
            let Output {
                force,
                torque,
                cause,
            } = self.motors.output;
            self.note(Event::Motors {
                force,
                torque,
                cause,
            });
        }
    }

    /// Why the motors are held at zero, whatever the command says.
    pub fn block(&self) -> Option<Cause> {
        if self.mode != Mode::Force {
            Some(Cause::Mode)
        } else if self.heat.warm {
            Some(Cause::Warm)
        } else {
            None
        }
    }

    fn load(&self) -> Load {
        let flows = self.mode == Mode::Force && self.motors.armed && self.gravity;
        let carried = if flows { self.carried } else { 0.0 };
        let braked = self.setup.family == Family::Dhd && self.mode == Mode::Brake;
        Load {
            force: self.motors.output.force,
            torque: self.motors.output.torque,
            droop: (self.setup.weight - carried) * G,
            brake: if braked { self.setup.brake } else { 0.0 },
        }
    }
}
