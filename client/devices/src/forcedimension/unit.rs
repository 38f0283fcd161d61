//! A device of the library: opening by serial number, properties, closing.

use std::sync::{Mutex, PoisonError};

use sulcus_haptics::device::{HandInfo, Reported};

use super::api::{Code, Dhd, Id};
use super::models::{self, Model};
use super::{LIBRARY, errors};
use crate::State;

/// Devices that this process has open.
static OPEN: Mutex<Vec<(Id, HandInfo)>> = Mutex::new(Vec::new());

/// Open device.
#[derive(Debug)]
pub struct Unit {
    /// The library.
    pub dhd: Dhd,
    /// Device of the library.
    pub id: Id,
    /// Properties of the model.
    pub model: Model,
    /// Properties for the session.
    pub info: HandInfo,
}

/// Reason why a device does not open.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Refusal {
    /// State for the list.
    pub state: State,
    /// Sentence.
    pub text: String,
}

impl Unit {
    /// Opens the device at a place of the library's list.
    pub fn open_at(dhd: Dhd, index: i32) -> Result<Self, Refusal> {
        // The lock keeps two threads from the same device.
        let mut open = OPEN.lock().unwrap_or_else(PoisonError::into_inner);
        let title = format!("device {}", index + 1);
        let refused = |code: Code| Refusal {
            state: code.state(),
            text: errors::refusal(&title, code, &dhd.error_text(code)),
        };
        let id = dhd.open(index).map_err(refused)?;
        // The library may give the id of a device that is open here; that device stays open.
        if open.iter().any(|(other, _)| *other == id) {
            return Err(refused(Code(20)));
        }
        let kind = dhd.kind(id);
        let model = models::model(kind, dhd.parts(id));
        let serial = dhd.serial(id).map_err(|code| {
            dhd.close(id);
            refused(code)
        })?;
        let name = Some(dhd.name(id)).filter(|name| !name.is_empty());
        let info = HandInfo {
            library: LIBRARY,
            model: name.unwrap_or_else(|| models::name(kind).to_owned()),
            serial: serial.to_string(),
            motion_dof: model.motion_dof,
            force_axes: 3,
            torque_axes: model.torque_axes,
            period_ns: model.period_ns,
            reported: Reported::default(),
        };
        open.push((id, info.clone()));
        Ok(Self {
            dhd,
            id,
            model,
            info,
        })
    }

    /// Opens the device with the serial number.
    pub fn open(dhd: Dhd, serial: &str) -> Result<Self, Refusal> {
        let mut found = Vec::new();
        let mut first = None;
        for index in 0..dhd.count() {
            match Self::open_at(dhd, index) {
                Ok(unit) if unit.info.serial == serial => return Ok(unit),
                Ok(unit) => found.push(unit.info.serial.clone()),
                Err(refusal) => first = first.or(Some(refusal)),
            }
        }
        Err(first.unwrap_or_else(|| {
            let known = if found.is_empty() { "none".to_owned() } else { found.join(", ") };
            Refusal {
                state: State::NoDevice,
                text: format!(
                    "Force Dimension SDK finds no device {serial}: the connected serial numbers are {known}; connect \
                     the device and switch it on"
                ),
            }
        }))
    }

    /// Name for messages.
    pub fn title(&self) -> String {
        title(&self.info)
    }
}

impl Drop for Unit {
    fn drop(&mut self) {
        let mut open = OPEN.lock().unwrap_or_else(PoisonError::into_inner);
        open.retain(|(id, _)| *id != self.id);
        self.dhd.close(self.id);
    }
}

/// Name of a device for messages.
pub fn title(info: &HandInfo) -> String {
    format!("{} {}", info.model, info.serial)
}

/// Devices that this process has open.
pub fn used() -> Vec<HandInfo> {
    let open = OPEN.lock().unwrap_or_else(PoisonError::into_inner);
    open.iter().map(|(_, info)| info.clone()).collect()
}
