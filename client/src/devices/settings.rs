//! Stored settings of the devices of a station: hand, seat, scale, limit, model file, handle.
//!
//! The identity of a device is its library with its serial number, never the order in which devices are found.

use std::path::{Path, PathBuf};

use anyhow::Context;
use serde::{Deserialize, Serialize};
use sulcus_program::PathText;

/// Hand of a person.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Hand {
    /// Left hand.
    Left,
    /// Right hand.
    Right,
}

impl Hand {
    /// Name on the command line and in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Left => "left",
            Self::Right => "right",
        }
    }

    /// Hand of a name.
    pub fn from_name(name: &str) -> Option<Self> {
        [Self::Left, Self::Right]
            .into_iter()
            .find(|hand| hand.name() == name)
    }

    /// Other hand.
    pub fn other(self) -> Self {
        match self {
            Self::Left => Self::Right,
            Self::Right => Self::Left,
        }
    }
}

/// Settings of one device.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DeviceSettings {
    /// Name of the back-end.
    pub library: String,
    /// Serial number, as the back-end reports it.
    pub serial: String,
    /// Hand that holds the device; absent until it is known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub hand: Option<Hand>,
    /// Seat of the person on the dental clock, hours, 6 to 12.
    #[serde(default = "seat")]
    pub seat_hour: f64,
    /// Length in the world per length at the device, 0.1 to 10.
    #[serde(default = "one")]
    pub scale: f64,
    /// Point of the world that shows the middle of the workspace, mm; absent: the resting place of the tool.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub origin_mm: Option<[f64; 3]>,
    /// Largest force that the person wants, N; absent: the limits of device and scene alone.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub force_limit_n: Option<f64>,
    /// Number of the button that holds the clutch, from 1 on; absent: no clutch.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub clutch_button: Option<u8>,
    /// Model file of `devices measure`; absent: the shipped model.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub model: Option<PathBuf>,
    /// Handle file of `devices handle`; absent: the device point is the centre of the gimbal.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub handle: Option<PathBuf>,
}

fn seat() -> f64 {
    10.5
}

fn one() -> f64 {
    1.0
}

impl DeviceSettings {
    /// Default settings of a device.
    pub fn new(library: &str, serial: &str) -> Self {
        Self {
            library: library.into(),
            serial: serial.into(),
            hand: None,
            seat_hour: seat(),
            scale: one(),
            origin_mm: None,
            force_limit_n: None,
            clutch_button: None,
            model: None,
            handle: None,
        }
    }

    /// Checks the numbers: field, value found, value expected.
    fn check(&self) -> anyhow::Result<()> {
        let ranged = |field: &str, found: f64, low: f64, high: f64| {
            // In this form a NaN is outside.
            anyhow::ensure!(
                found >= low && found <= high,
                "{field} of device {}:{} is {found}, expected {low} to {high}",
                self.library,
                self.serial
            );
            Ok(())
        };
        ranged("seat_hour", self.seat_hour, 6.0, 12.0)?;
        ranged("scale", self.scale, 0.1, 10.0)?;
        ranged(
            "force_limit_n",
            self.force_limit_n.unwrap_or(1.0),
            0.0,
            100.0,
        )?;
        ranged(
            "clutch_button",
            f64::from(self.clutch_button.unwrap_or(1)),
            1.0,
            16.0,
        )?;
        for x in self.origin_mm.unwrap_or_default() {
            ranged("origin_mm", x, -1000.0, 1000.0)?;
        }
        Ok(())
    }
}

/// Settings of all devices that this station has used.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Settings {
    /// Devices.
    #[serde(default, rename = "device")]
    pub devices: Vec<DeviceSettings>,
}

impl Settings {
    /// Default file: `devices.toml` in `SULCUS_STATE_DIR`, else in `XDG_STATE_HOME/sulcus`, else in
    /// `~/.local/state/sulcus`; on Windows in `LOCALAPPDATA\sulcus`. `None` without any of these.
    pub fn file() -> Option<PathBuf> {
        let set = |name: &str| {
            let value = std::env::var_os(name).filter(|value| !value.is_empty())?;
            Some(PathBuf::from(value))
        };
        let folder = set("SULCUS_STATE_DIR")
            .or_else(|| set("XDG_STATE_HOME").map(|dir| dir.join("sulcus")))
            .or_else(|| set("LOCALAPPDATA").map(|dir| dir.join("sulcus")))
            .or_else(|| set("HOME").map(|dir| dir.join(".local/state/sulcus")))?;
        Some(folder.join("devices.toml"))
    }

    /// Reads a file. A missing file has no devices.
    ///
    /// # Errors
    /// The file cannot be read, is no settings file, or has a number out of its range.
    pub fn read(file: &Path) -> anyhow::Result<Self> {
        let text = match std::fs::read_to_string(file) {
            Ok(text) => text,
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => {
                return Ok(Self::default());
            }
            Err(error) => {
                return Err(error).with_context(|| format!("{}: cannot read", file.shown()));
            }
        };
        let settings: Self = sulcus_haptics::exact::read(&text)
            .map_err(|why| anyhow::anyhow!("{}: not valid: {why}", file.shown()))?;
        for device in &settings.devices {
            device.check().with_context(|| file.shown().to_string())?;
        }
        Ok(settings)
    }

    /// Writes a file whole, or not at all. A missing folder is created.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn write(&self, file: &Path) -> anyhow::Result<()> {
        let write = || -> anyhow::Result<()> {
            let text = toml::to_string(self)?;
            if let Some(folder) = file.parent() {
                std::fs::create_dir_all(folder)?;
            }
            let part = file.with_extension("toml.part");
            std::fs::write(&part, text)?;
            std::fs::rename(&part, file)?;
            Ok(())
        };
        write().with_context(|| format!("{}: cannot write", file.shown()))
    }

    /// Settings of a device; defaults for a device that is not stored.
    pub fn of(&self, library: &str, serial: &str) -> DeviceSettings {
        let is = |device: &&DeviceSettings| device.library == library && device.serial == serial;
        self.devices
            .iter()
            .find(is)
            .cloned()
            .unwrap_or_else(|| DeviceSettings::new(library, serial))
    }

    /// Stores the settings of a device in place of older ones.
    pub fn store(&mut self, settings: DeviceSettings) {
        let is = |d: &DeviceSettings| d.library == settings.library && d.serial == settings.serial;
        self.devices.retain(|device| !is(device));
        self.devices.push(settings);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn settings_survive_their_file_and_a_missing_file_has_no_devices() {
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("state/devices.toml");
        assert_eq!(Settings::read(&file).expect("none"), Settings::default());
        let mut settings = Settings::default();
        let mut left = DeviceSettings::new("haply", "049D+61576");
        left.hand = Some(Hand::Left);
        left.origin_mm = Some([1.0, -2.0, 3.5]);
        settings.store(left.clone());
        settings.store(DeviceSettings::new("openhaptics", "Default Device"));
        settings.write(&file).expect("written");
        let read = Settings::read(&file).expect("read");
        assert_eq!(read, settings);
        assert_eq!(read.of("haply", "049D+61576"), left);
        // The same serial number of another library is another device.
        assert_eq!(read.of("openhaptics", "049D+61576").hand, None);
    }

    #[test]
    fn an_invalid_file_names_device_field_value_and_range() {
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("devices.toml");
        let refused = |text: &str| {
            std::fs::write(&file, text).expect("written");
            format!("{:#}", Settings::read(&file).expect_err("refused"))
        };
        let device = "[[device]]\nlibrary = \"haply\"\nserial = \"1\"\n";
        let text = refused(&format!("{device}scale = nan\n"));
        assert!(
            text.contains("scale of device haply:1 is NaN, expected 0.1 to 10"),
            "{text}"
        );
        assert!(refused(&format!("{device}sacle = 1.0\n")).contains("sacle"));
        assert!(refused("[[device]").contains("not valid"));
        let text = refused(&format!("{device}origin_mm = [1.0, 2.0, 3.0, 4.0]\n"));
        assert!(text.contains("origin_mm"), "{text}");
    }
}
