//! A device of the library: opening, properties, closing.

use std::sync::{Mutex, PoisonError};

use sulcus_haptics::device::{HandInfo, Reported};

use super::api::{Handle, Hd};
use super::{LIBRARY, errors, sys};
use crate::State;

/// Environment variable that keeps devices open until the process ends. The closing of some FireWire models ends the
/// process.
pub const KEEP: &str = "SULCUS_HD_KEEP_DEVICE";

/// Devices that this process has open.
static OPEN: Mutex<Vec<Open>> = Mutex::new(Vec::new());

#[derive(Clone, Debug)]
struct Open {
    name: Option<String>,
    serial: String,
    handle: Handle,
    /// Whether a session uses the device. A device without a session is kept open by [`KEEP`].
    is_used: bool,
}

/// Device that a session uses.
#[derive(Debug)]
pub struct Unit {
    hd: Hd,
    /// Name with which the library opens the device; `None` for the default device.
    pub name: Option<String>,
    /// Properties.
    pub info: HandInfo,
    /// Handle; `None` for a device that is lost.
    pub handle: Option<Handle>,
    /// Ways of calibration, one bit each.
    pub styles: u32,
    /// Whether the device was calibrated when it was opened.
    pub is_calibrated: bool,
}

/// Reason why a device does not open.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Refusal {
    /// State for the list.
    pub state: State,
    /// Code of the library; 0 if the reason is none of the library's.
    pub code: u32,
    /// Sentence.
    pub text: String,
}

impl Unit {
    /// Opens the device of the name; `None` for the default device.
    pub fn open(hd: Hd, name: Option<&str>) -> Result<Self, Refusal> {
        let handle = init(&hd, name)?;
        let mut unit = Self {
            hd,
            name: name.map(str::to_owned),
            info: info(&hd, handle, name),
            handle: Some(handle),
            styles: 0,
            is_calibrated: false,
        };
        unit.calibration(handle);
        let version = hd.current(handle).string(sys::VERSION);
        hd.drain(|_| ());
        remember(&unit, handle);
        if !errors::is_supported(&version) {
            let text = format!(
                "OpenHaptics {version} in {} is too old: 3.0 or newer is expected; install OpenHaptics 3.4",
                hd.path()
            );
            unit.close();
            return Err(Refusal {
                state: State::WrongVersion,
                code: 0,
                text,
            });
        }
        Ok(unit)
    }

    /// Opens the device of the same name again.
    pub fn reopen(&mut self) -> Result<(), Refusal> {
        let handle = init(&self.hd, self.name.as_deref())?;
        let found = info(&self.hd, handle, self.name.as_deref());
        self.handle = Some(handle);
        remember(self, handle);
        if found.serial != self.info.serial {
            let text = format!(
                "{} has the serial number {} now and had {} before: end the session and choose the devices again",
                self.title(),
                found.serial,
                self.info.serial
            );
            self.close();
            return Err(Refusal {
                state: State::Error,
                code: 0,
                text,
            });
        }
        self.calibration(handle);
        Ok(())
    }

    /// Closes the device, unless the environment says to keep it open.
    pub fn close(&mut self) {
        let Some(handle) = self.handle.take() else {
            return;
        };
        let keep = is_kept();
        let mut open = OPEN.lock().unwrap_or_else(PoisonError::into_inner);
        for of in open.iter_mut().filter(|of| of.handle == handle) {
            of.is_used = false;
        }
        if !keep {
            open.retain(|of| of.handle != handle);
            drop(open);
            self.hd.close(handle);
        }
    }

    /// Name for messages.
    pub fn title(&self) -> String {
        format!("{} {}", self.info.model, self.info.serial)
    }

    fn calibration(&mut self, handle: Handle) {
        let device = self.hd.current(handle);
        self.styles = device.integer(sys::CALIBRATION_STYLE).max(0) as u32;
        self.is_calibrated = device.calibration() == sys::CALIBRATION_OK;
        self.hd.drain(|_| ());
    }
}

impl Drop for Unit {
    fn drop(&mut self) {
        self.close();
    }
}

/// Whether the environment says to keep devices open.
pub fn is_kept() -> bool {
    std::env::var_os(KEEP).is_some_and(|value| !value.is_empty() && value != "0")
}

/// Names and serial numbers of the devices that a session of this process uses.
pub fn used() -> Vec<String> {
    let open = OPEN.lock().unwrap_or_else(PoisonError::into_inner);
    let used = open.iter().filter(|of| of.is_used);
    used.flat_map(|of| [of.serial.clone(), of.name.clone().unwrap_or_default()])
        .collect()
}

/// Opens the device, or takes one that is kept open.
fn init(hd: &Hd, name: Option<&str>) -> Result<Handle, Refusal> {
    let kept = {
        let open = OPEN.lock().unwrap_or_else(PoisonError::into_inner);
        open.iter().find(|of| of.name.as_deref() == name).cloned()
    };
    match kept {
        Some(of) if !of.is_used => return Ok(of.handle),
        Some(_) => return Err(refusal(hd, name, 0x301)),
        None => {}
    }
    hd.init(name).map_err(|error| refusal(hd, name, error.code))
}

fn refusal(hd: &Hd, name: Option<&str>, code: u32) -> Refusal {
    Refusal {
        state: errors::state(code),
        code,
        text: errors::refusal(name.unwrap_or(""), code, &hd.error_text(code), &hd.path()),
    }
}

fn remember(unit: &Unit, handle: Handle) {
    let mut open = OPEN.lock().unwrap_or_else(PoisonError::into_inner);
    open.retain(|of| of.handle != handle);
    open.push(Open {
        name: unit.name.clone(),
        serial: unit.info.serial.clone(),
        handle,
        is_used: true,
    });
}

/// Reads the properties of a device.
fn info(hd: &Hd, handle: Handle, name: Option<&str>) -> HandInfo {
    let device = hd.current(handle);
    let text = |parameter| {
        let text = device.string(parameter);
        hd.drain(|_| ());
        text
    };
    let number = |parameter| {
        let value = device.doubles(parameter)[0];
        hd.drain(|_| ());
        Some(value).filter(|value| value.is_finite() && *value > 0.0)
    };
    let count = |parameter, otherwise: i32| {
        let found = device.integer(parameter);
        hd.drain(|_| ());
        u8::try_from(if found > 0 { found } else { otherwise }).unwrap_or(0)
    };
    let serial = Some(text(sys::DEVICE_SERIAL_NUMBER)).filter(|serial| !serial.is_empty());
    HandInfo {
        library: LIBRARY,
        model: text(sys::DEVICE_MODEL_TYPE),
        serial: serial.unwrap_or_else(|| name.unwrap_or(super::names::DEFAULT).to_owned()),
        motion_dof: count(sys::INPUT_DOF, 6).min(7),
        force_axes: 3,
        torque_axes: if count(sys::OUTPUT_DOF, 3) >= 6 { 3 } else { 0 },
        period_ns: 1_000_000,
        reported: Reported {
            peak_n: number(sys::NOMINAL_MAX_FORCE),
            continuous_n: number(sys::NOMINAL_MAX_CONTINUOUS_FORCE),
            stiffness_n_per_m: number(sys::NOMINAL_MAX_STIFFNESS).map(|k| k * 1e3),
        },
    }
}
