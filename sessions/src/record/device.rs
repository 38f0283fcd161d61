//! Devices of a session, and the limits in force at its beginning, as fields of the header.

use std::fmt;

use serde::{Deserialize, Serialize};
use serde_json::json;
use sulcus_core::{Coupling, MAX_TOOLS};

use crate::record::occurrence::Occurrence;
use crate::record::sane::{above_zero, no_less_than_zero, text_of};

/// Kind: a student is back with other devices. Data: `devices`, as in the header.
pub const DEVICES_CHANGED: &str = "devices_changed";

/// Haptic device in a slot, as its client described it.
///
/// Recordings of format 6 have the fields `tool` to `force_dof` only. The other fields then have their defaults.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DeviceFacts {
    /// Slot of the tool, 0 or 1.
    pub tool: u8,
    /// Name of the kind of device.
    pub name: String,
    /// Period of the device's loop, nanoseconds; 0 if unknown.
    pub period_ns: u64,
    /// Metres in the world for a metre of the device.
    pub workspace_scale: f64,
    /// Largest force that the device displays, newtons; 0 for a device without force.
    pub max_force_n: f64,
    /// Largest torque that the device displays, newton-metres; 0 for a device without torque.
    pub max_torque_nm: f64,
    /// Degrees of freedom in which the device displays force or torque, 0 to 6.
    pub force_dof: u8,
    /// Library that drives the device, such as `openhaptics`, `simulated` or `mouse`. Empty for a device that is not
    /// described: then the other fields below say nothing.
    #[serde(default)]
    pub library: String,
    /// Serial number; may be empty.
    #[serde(default)]
    pub serial: String,
    /// BLAKE3 of the model file, hexadecimal; empty without a model file.
    #[serde(default)]
    pub model_hash: String,
    /// Trust of the model's figures: `measured`, `vendor` or `guess`; empty if unknown.
    #[serde(default)]
    pub figures: String,
    /// Measured delay of the loop from a pose to the wrench that answers it, microseconds; 0 if unknown.
    #[serde(default)]
    pub delay_us: u32,
    /// Coulomb friction in free space, newtons; 0 if unknown.
    #[serde(default)]
    pub friction_n: f64,
    /// Number of axes whose motion the device measures, 0 to 6.
    #[serde(default)]
    pub motion_axes: u8,
    /// Number of translational axes with force, 0 to 3.
    #[serde(default)]
    pub force_axes: u8,
    /// Number of rotational axes with torque, 0 to 3.
    #[serde(default)]
    pub torque_axes: u8,
    /// Stiffest coupling that the device can display; null if unknown. 0 in translation or rotation for a device
    /// without force or torque.
    #[serde(default)]
    pub coupling: Option<Coupling>,
}

impl Default for DeviceFacts {
    fn default() -> Self {
        Self {
            tool: 0,
            name: String::new(),
            period_ns: 0,
            workspace_scale: 1.0,
            max_force_n: 0.0,
            max_torque_nm: 0.0,
            force_dof: 0,
            library: String::new(),
            serial: String::new(),
            model_hash: String::new(),
            figures: String::new(),
            delay_us: 0,
            friction_n: 0.0,
            motion_axes: 0,
            force_axes: 0,
            torque_axes: 0,
            coupling: None,
        }
    }
}

/// Limits of the wrench that the station sends, as the client was told them.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Limits {
    /// Largest force, newtons.
    pub max_force_n: f64,
    /// Largest torque, newton-metres.
    pub max_torque_nm: f64,
    /// Largest change of the force per millisecond, newtons.
    pub max_force_step_n: f64,
    /// Largest change of the torque per millisecond, newton-metres.
    pub max_torque_step_nm: f64,
}

impl DeviceFacts {
    /// Checks every value: field, value found, value expected.
    pub(crate) fn check(&self) -> Result<(), String> {
        if usize::from(self.tool) >= MAX_TOOLS {
            return Err(format!("device tool is {}, expected 0 or 1", self.tool));
        }
        text_of("device name", &self.name)?;
        above_zero("device workspace_scale", self.workspace_scale)?;
        no_less_than_zero("device max_force_n", self.max_force_n)?;
        no_less_than_zero("device max_torque_nm", self.max_torque_nm)?;
        for (field, text) in [
            ("device library", &self.library),
            ("device serial", &self.serial),
            ("device model_hash", &self.model_hash),
            ("device figures", &self.figures),
        ] {
            text_of(field, text)?;
        }
        no_less_than_zero("device friction_n", self.friction_n)?;
        if let Some(coupling) = &self.coupling {
            no_less_than_zero("device coupling n_per_m", coupling.n_per_m)?;
            no_less_than_zero("device coupling nm_per_rad", coupling.nm_per_rad)?;
        }
        for (field, found, most) in [
            ("force_dof", self.force_dof, 6),
            ("motion_axes", self.motion_axes, 6),
            ("force_axes", self.force_axes, 3),
            ("torque_axes", self.torque_axes, 3),
        ] {
            if found > most {
                return Err(format!("device {field} is {found}, expected 0 to {most}"));
            }
        }
        Ok(())
    }

    /// Whether the client described what the device can display.
    pub fn is_described(&self) -> bool {
        !self.library.is_empty()
    }

    /// Devices in a line of the log, by which a student is back; `None` for any other line and for invalid devices.
    pub(crate) fn hear(text: &str) -> Option<Vec<Self>> {
        let said = Occurrence::parse(text).filter(|said| said.kind == DEVICES_CHANGED)?;
        let devices: Vec<Self> = serde_json::from_value(said.data.get("devices")?.clone()).ok()?;
        let valid = devices.iter().all(|device| device.check().is_ok());
        valid.then_some(devices)
    }
}

impl Occurrence {
    /// Event [`DEVICES_CHANGED`]: a student is back with these devices.
    pub fn devices_changed(tick: u64, devices: &[DeviceFacts]) -> Self {
        Self {
            kind: DEVICES_CHANGED.into(),
            tick,
            data: json!({ "devices": devices }),
        }
    }
}

impl Limits {
    /// Checks every value, as by [`DeviceFacts::check`].
    pub(crate) fn check(&self) -> Result<(), String> {
        no_less_than_zero("limits max_force_n", self.max_force_n)?;
        no_less_than_zero("limits max_torque_nm", self.max_torque_nm)?;
        no_less_than_zero("limits max_force_step_n", self.max_force_step_n)?;
        no_less_than_zero("limits max_torque_step_nm", self.max_torque_step_nm)
    }
}

impl fmt::Display for DeviceFacts {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "tool {}: {}", self.tool, self.name.escape_debug())?;
        if self.period_ns > 0 {
            write!(f, ", {:.0} Hz", 1e9 / self.period_ns as f64)?;
        }
        write!(
            f,
            ", workspace scale {}, up to {} N and {} N m in {} degrees of freedom",
            self.workspace_scale, self.max_force_n, self.max_torque_nm, self.force_dof
        )?;
        if !self.is_described() {
            return Ok(());
        }
        let safe = |text: &str| text.escape_debug().to_string();
        write!(f, "; library {}", safe(&self.library))?;
        for (name, text) in [("serial", &self.serial), ("figures", &self.figures)] {
            if !text.is_empty() {
                write!(f, ", {name} {}", safe(text))?;
            }
        }
        if !self.model_hash.is_empty() {
            let hash: String = self.model_hash.chars().take(12).collect();
            write!(f, ", model {}", safe(&hash))?;
        }
        write!(
            f,
            ", axes: {} of motion, {} of force, {} of torque",
            self.motion_axes, self.force_axes, self.torque_axes
        )?;
        if self.friction_n > 0.0 {
            write!(f, ", friction {} N", self.friction_n)?;
        }
        if self.delay_us > 0 {
            write!(f, ", delay {} us", self.delay_us)?;
        }
        if let Some(coupling) = &self.coupling {
            write!(
                f,
                ", couplings up to {} N/m and {} N m/rad",
                coupling.n_per_m, coupling.nm_per_rad
            )?;
        }
        Ok(())
    }
}

impl fmt::Display for Limits {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{} N, {} N m; per millisecond {} N, {} N m",
            self.max_force_n, self.max_torque_nm, self.max_force_step_n, self.max_torque_step_nm
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn devices_of_a_return_survive_the_log_and_invalid_ones_are_ignored() {
        let device = DeviceFacts {
            name: "stylus".into(),
            library: "haply".into(),
            friction_n: 0.26,
            force_axes: 3,
            coupling: Some(Coupling {
                n_per_m: 400.0,
                nm_per_rad: 0.0,
            }),
            ..DeviceFacts::default()
        };
        let line = |device: &DeviceFacts| {
            let all = std::slice::from_ref(device);
            Occurrence::devices_changed(7, all).to_string()
        };
        assert_eq!(
            DeviceFacts::hear(&line(&device)),
            Some(vec![device.clone()])
        );
        let invalid = DeviceFacts {
            torque_axes: 9,
            ..device
        };
        assert_eq!(DeviceFacts::hear(&line(&invalid)), None);
        for other in [
            "devices_changed at tick 7: {}",
            "x at tick 7: {\"devices\":[]}",
        ] {
            assert_eq!(DeviceFacts::hear(other), None);
        }
    }
}
