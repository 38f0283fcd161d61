//! List of the devices, without opening one: a device that is open here would be lost to a session elsewhere, and the
//! closing of some models ends the process. Names, models and serial numbers are those of the setup program's files.

use super::api::Hd;
use super::names::{self, Config, DEFAULT};
use super::{LIBRARY, errors, unit};
use crate::{Found, State};

/// Lists the devices.
pub fn list() -> Vec<Found> {
    let hd = match Hd::load() {
        Ok(hd) => hd,
        Err(error) => return vec![Found::nothing(LIBRARY, error.state(), error.to_string())],
    };
    let used = unit::used();
    // A call of the library could disturb a session that runs in this process.
    let version = if used.is_empty() {
        hd.version()
    } else {
        String::new()
    };
    if !errors::is_supported(&version) {
        let text = format!(
            "OpenHaptics {version} in {} is too old: 3.0 or newer is expected; install OpenHaptics 3.4",
            hd.path()
        );
        return vec![Found::nothing(LIBRARY, State::WrongVersion, text)];
    }
    let directories = names::directories();
    let configs = names::configs(&directories);
    if configs.is_empty() {
        let places: Vec<_> = directories
            .iter()
            .map(|path| path.display().to_string())
            .collect();
        let config = Config {
            name: DEFAULT.to_owned(),
            ..Config::default()
        };
        let text = format!(
            "no configuration in {}: a session opens the default device; run the setup program of the driver if that \
             fails",
            places.join(", ")
        );
        return vec![entry(&config, &used, text)];
    }
    let of = |config: &Config| {
        let text = format!(
            "configured as \"{}\": a session opens the device and tells whether it is connected",
            config.name
        );
        entry(config, &used, text)
    };
    configs.iter().map(of).collect()
}

fn entry(config: &Config, used: &[String], text: String) -> Found {
    let serial = if config.serial.is_empty() {
        &config.name
    } else {
        &config.serial
    };
    let is_used = used
        .iter()
        .any(|name| *name == config.name || name == serial);
    let has_torque = config.model.to_ascii_uppercase().contains("6DOF");
    Found {
        library: LIBRARY,
        model: config.model.clone(),
        serial: serial.clone(),
        hand: String::new(),
        motion_dof: 6,
        force_dof: if has_torque { 6 } else { 3 },
        state: if is_used { State::InUse } else { State::Ready },
        message: if is_used {
            "a session of this program uses the device".to_owned()
        } else {
            text
        },
    }
}
