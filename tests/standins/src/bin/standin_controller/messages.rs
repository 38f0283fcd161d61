//! Messages of the driver libraries to a device box.

use crate::device::Device;
use std::sync::atomic::Ordering;
use sulcus_standins::board::{Calibration, Call, Command, Family, Message, Mode, OffCause, Packet};
use sulcus_standins::log::{Cause, Closed, CommandEntry, Event};

/// HD calibration style with the stylus in its well.
const INKWELL: u32 = 4;

/// HD capability of force output.
const FORCE_OUTPUT: u32 = 0x4000;

impl Device {
    /// Handles a message. The box has run up to the time of the message.
    pub fn handle_message(&mut self, packet: &Packet) {
        let pid = packet.pid;
        match packet.message {
            Message::Open => self.note(Event::Open { pid }),
            Message::Refused(code) => self.note(Event::Refused { pid, code }),
            Message::Close(exit) => {
                let way = if exit { Closed::Exit } else { Closed::Call };
                self.note(Event::Close { pid, way });
                self.motors.cut(Cause::Closed);
                self.drive();
                if self.setup.family == Family::Dhd && self.mode == Mode::Force {
                    self.set_mode(Mode::Idle, OffCause::Software);
                }
            }
            Message::Command(command) => self.command(pid, &command),
            Message::Error(code) => self.note(Event::Error { code, pid }),
            Message::Call(call, value) => {
                self.note(Event::Call { call, value, pid });
                self.call(call, value);
            }
        }
        if packet.waits {
            self.publish();
            self.slot.handled.fetch_add(1, Ordering::AcqRel);
        }
    }

    fn command(&mut self, pid: u32, c: &Command) {
        let finite = c.force.iter().chain(&c.torque).all(|n| n.is_finite());
        let ignored = if !self.plugged {
            Some(Cause::Unplugged)
        } else if !finite {
            Some(Cause::NotFinite)
        } else if !c.enabled {
            Some(Cause::Disabled)
        } else {
            self.block()
        };
        self.note(Event::Command(CommandEntry {
            pid,
            frame: c.frame,
            tick: c.tick,
            pose_stamp: c.pose_stamp,
            sets: c.sets,
            enabled: c.enabled && self.mode == Mode::Force,
            asked_force: c.asked_force,
            asked_torque: c.asked_torque,
            force: c.force,
            torque: c.torque,
            ignored,
            position: self.handle.pose.position,
        }));
        self.commands += 1;
        if self.plugged {
            self.recent.push_back(self.t);
        }
        match ignored {
            Some(Cause::Unplugged | Cause::Mode) => return,
            Some(Cause::Disabled) => self.motors.cut(Cause::Disabled),
            Some(Cause::NotFinite) => self.motors.cut(Cause::NotFinite),
            _ => self.motors.command(&self.setup, self.t, c.force, c.torque),
        }
        self.drive();
    }

    fn call(&mut self, call: Call, value: f64) {
        let on = value != 0.0;
        match call {
            Call::UpdateCalibration => self.update_calibration(value as u32),
            Call::Disable if value as u32 == FORCE_OUTPUT => {
                self.motors.cut(Cause::Disabled);
                self.drive();
            }
            Call::EnableForce => self.enable_force(on),
            Call::Brakes => self.set_brakes(on),
            Call::Stop => self.set_brakes(true),
            Call::Watchdog => self.setup.watchdog_ms = value * 0.125,
            Call::Gravity => self.gravity = on,
            Call::EffectorMass => self.carried = value,
            Call::AutoInit => {
                self.auto_init = Some(self.t + (self.setup.traits.auto_init * 1e6) as u64)
            }
            Call::RegulationStop if !on => self.enable_force(false),
            _ => {}
        }
    }

    /// One update of the calibration by the driver. The inkwell style counts only while the stylus is in its well.
    fn update_calibration(&mut self, style: u32) {
        if self.calibration != Calibration::NeedsUpdate || (style == INKWELL && !self.inkwell) {
            return;
        }
        self.updates += 1;
        if self.updates >= self.setup.calibration.updates {
            self.updates = 0;
            self.calibrated();
        }
    }

    /// The owner of the device died. The motors stay on until the watchdog acts, because the hardware knows nothing.
    pub fn owner_died(&mut self, pid: u32) {
        let way = Closed::Died;
        self.note(Event::Close { pid, way });
        if self.setup.family == Family::Hd {
            self.slot.locked.store(1, Ordering::Release);
        }
        let asked = self.slot.asked.load(Ordering::Acquire);
        self.slot.handled.store(asked, Ordering::Release);
        self.slot.owner.store(0, Ordering::Release);
    }
}
