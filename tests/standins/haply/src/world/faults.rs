//! Requests of the test and faults, carried out on the devices and on the replies.

use serde_json::json;

use super::World;
use super::pending::Bad;
use crate::device::{Arm, Grip};
use crate::fault::Fault;
use crate::log::What;
use crate::request::{Request, RequestError};

impl World {
    /// Carries a request of the test out; faults of the sockets are the part of the caller.
    pub(crate) fn apply(&mut self, request: &Request) -> Result<(), RequestError> {
        let now = self.advance();
        match request {
            Request::Fault(fault) => {
                self.log.add(
                    now,
                    What::Fault {
                        fault: fault.clone(),
                    },
                );
                self.fault(fault)?;
            }
            Request::Hand { device, motion } => self.arm(device)?.set_motion(motion.clone(), now),
            Request::Turn { device, turn } => self.grip(device)?.set_turn(turn.clone(), now),
            Request::Buttons { device, buttons } => self.grip(device)?.buttons = *buttons,
            Request::Status { device, status } => self.arm(device)?.status = *status,
            Request::SecondSource { device, force } => self.arm(device)?.second = *force,
            Request::Now | Request::Quit => {}
        }
        self.log.flush();
        Ok(())
    }

    fn fault(&mut self, fault: &Fault) -> Result<(), RequestError> {
        match fault {
            Fault::DropConnections
            | Fault::DropEvents
            | Fault::Stall { .. }
            | Fault::RefuseConnections { .. } => {}
            Fault::CloseConnections => self.links.values_mut().for_each(|link| link.close = true),
            Fault::ForceScale { value } => self.forces.scale = *value,
            Fault::Version { version } => self.version = *version,
            Fault::Malformed { .. }
            | Fault::Truncated { .. }
            | Fault::BadNumber { .. }
            | Fault::Omit { .. }
            | Fault::TwiceReply { .. }
            | Fault::TwiceDevice { .. }
            | Fault::Silence { .. }
            | Fault::HttpError { .. } => self.reply_fault(fault),
            Fault::Safety { .. }
            | Fault::Event { .. }
            | Fault::Disconnect { .. }
            | Fault::Reconnect { .. }
            | Fault::Sleep { .. }
            | Fault::Wake { .. }
            | Fault::CalibrationLost { .. }
            | Fault::Calibrated { .. }
            | Fault::PowerOff { .. }
            | Fault::PowerOn { .. } => self.device_fault(fault)?,
        }
        Ok(())
    }

    fn reply_fault(&mut self, fault: &Fault) {
        let pending = &mut self.pending;
        match fault {
            Fault::Malformed { replies } => pending.malformed = *replies,
            Fault::Truncated { replies } => pending.truncated = *replies,
            Fault::TwiceReply { replies } => pending.twice_reply = *replies,
            Fault::TwiceDevice { replies } => pending.twice_device = *replies,
            Fault::Silence { messages } => pending.silence = *messages,
            Fault::HttpError { requests } => pending.http_error = *requests,
            Fault::Omit { what, replies } => pending.omit.push((what.clone(), *replies)),
            Fault::BadNumber {
                device,
                place,
                value,
                replies,
            } => {
                pending.bad.push(Bad {
                    device: device.clone(),
                    place: *place,
                    value: *value,
                    left: *replies,
                });
            }
            _ => {}
        }
    }

    fn device_fault(&mut self, fault: &Fault) -> Result<(), RequestError> {
        match fault {
            Fault::Safety { device, cause } => {
                let arm = self.arm(device)?;
                match cause {
                    crate::SafetyCause::EbrakeTriggered => arm.braked = true,
                    crate::SafetyCause::EbrakeReleased => arm.braked = false,
                    _ => {}
                }
                self.event(
                    "device-safety-triggered",
                    "error",
                    device,
                    json!({ "reason": cause.name() }),
                );
            }
            Fault::Event {
                name,
                level,
                device,
            } => self.event(name, level, device, json!({})),
            Fault::Disconnect { device } => {
                self.plug(device, false)?;
                self.event("device-disconnected", "warning", device, json!({}));
            }
            Fault::Reconnect { device } => {
                self.plug(device, true)?;
                self.event("device-connected", "info", device, json!({}));
            }
            Fault::Sleep { device } => {
                self.grip(device)?.awake = false;
                self.event("device-sleep", "info", device, json!({}));
            }
            Fault::Wake { device } => self.grip(device)?.awake = true,
            Fault::CalibrationLost { device } => {
                self.arm(device)?.status.calibrated = false;
                self.event("device-calibration-failed", "error", device, json!({}));
            }
            Fault::Calibrated { device } => self.arm(device)?.status.calibrated = true,
            Fault::PowerOff { device } => self.arm(device)?.status.power_supply = false,
            Fault::PowerOn { device } => self.arm(device)?.status.power_supply = true,
            _ => {}
        }
        Ok(())
    }

    fn plug(&mut self, id: &str, on: bool) -> Result<(), RequestError> {
        let mut found = false;
        let arms = self
            .arms
            .iter_mut()
            .map(|arm| (&arm.id, &mut arm.connected, &mut arm.generation));
        let grips = self
            .grips
            .iter_mut()
            .map(|grip| (&grip.id, &mut grip.connected, &mut grip.generation));
        for (_, connected, generation) in arms.chain(grips).filter(|(known, ..)| *known == id) {
            found = true;
            *generation += u64::from(on && !*connected);
            *connected = on;
        }
        if found {
            Ok(())
        } else {
            Err(RequestError::UnknownDevice(id.into()))
        }
    }

    fn arm(&mut self, id: &str) -> Result<&mut Arm, RequestError> {
        let arm = self.arms.iter_mut().find(|arm| arm.id == id);
        arm.ok_or_else(|| RequestError::UnknownDevice(id.into()))
    }

    fn grip(&mut self, id: &str) -> Result<&mut Grip, RequestError> {
        let grip = self.grips.iter_mut().find(|grip| grip.id == id);
        grip.ok_or_else(|| RequestError::UnknownDevice(id.into()))
    }
}
