//! List of the devices. Each device is opened, read and closed, without a command to its motors.

use sulcus_haptics::device::HandInfo;

use super::LIBRARY;
use super::api::Dhd;
use super::errors::{self, Mode};
use super::unit::{self, Unit};
use crate::{Found, State};

/// Lists the devices.
pub fn list() -> Vec<Found> {
    let dhd = match Dhd::load() {
        Ok(dhd) => dhd,
        Err(error) => return vec![Found::nothing(LIBRARY, error.state(), error.to_string())],
    };
    if let Some(text) = too_old(&dhd) {
        return vec![Found::nothing(LIBRARY, State::WrongVersion, text)];
    }
    let used = unit::used();
    if !used.is_empty() {
        // The opening of another device would disturb a session of this process.
        let text = "a session of this program uses the device";
        return used
            .iter()
            .map(|info| entry(info, State::InUse, text))
            .collect();
    }
    let count = dhd.count();
    if count <= 0 {
        return vec![Found::nothing(
            LIBRARY,
            State::NoDevice,
            "Force Dimension SDK finds no device: connect a device, switch it on, and on Linux allow the access by a \
             udev rule for the vendor 1451",
        )];
    }
    (0..count).map(|index| of(dhd, index)).collect()
}

fn of(dhd: Dhd, index: i32) -> Found {
    let unit = match Unit::open_at(dhd, index) {
        Ok(unit) => unit,
        Err(refusal) => return Found::nothing(LIBRARY, refusal.state, refusal.text),
    };
    let mode = dhd
        .status(unit.id)
        .map_or(Mode::Lost, |status| errors::mode(&status));
    let (state, text) = match mode {
        Mode::Reset => (State::Uncalibrated, mode.remark(&unit.title())),
        Mode::NoPower => (State::Asleep, mode.remark(&unit.title())),
        Mode::Lost => (
            State::Error,
            Some("the device does not answer: unplug it and plug it in again".into()),
        ),
        _ => (State::Ready, None),
    };
    entry(&unit.info, state, &text.unwrap_or_else(|| "ready".into()))
}

fn entry(info: &HandInfo, state: State, text: &str) -> Found {
    Found {
        library: LIBRARY,
        model: info.model.clone(),
        serial: info.serial.clone(),
        hand: String::new(),
        motion_dof: info.motion_dof,
        force_dof: info.force_axes + info.torque_axes,
        state,
        message: text.to_owned(),
    }
}

/// Sentence about a library that is too old.
pub fn too_old(dhd: &Dhd) -> Option<String> {
    let version = dhd.version();
    (!errors::is_supported(version)).then(|| {
        let [a, b, c, d] = version;
        format!(
            "Force Dimension SDK {a}.{b}.{c}.{d} in {} is too old: 3.0 or newer is expected; install the SDK 3.17",
            dhd.path()
        )
    })
}
