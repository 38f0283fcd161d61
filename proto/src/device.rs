//! Description of a haptic device: what the device can display, and how well its figures are known.

use serde::{Deserialize, Serialize};

use crate::limits::NAME_BYTES;

/// Kind of a client's event about the stage and the counters of a device.
pub const DEVICE_EVENT: &str = "device";
/// Kind of a client's event about the phase of its poses against the server's ticks.
pub const PHASE_EVENT: &str = "phase";

/// Trust of the figures of a device's model, from the best to the worst.
pub const FIGURES: [&str; 3] = ["measured", "vendor", "guess"];

/// Stiffest coupling that a device can display.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct DeviceCoupling {
    /// Stiffness in translation, N/m, range [`DeviceCoupling::N_PER_M`]. 0 for a device without force: no limit.
    pub n_per_m: f32,
    /// Stiffness in rotation, N m/rad, range [`DeviceCoupling::NM_PER_RAD`]. 0 for a device without torque: no limit.
    pub nm_per_rad: f32,
}

impl DeviceCoupling {
    /// Smallest and largest stiffness in translation, N/m: the range of a scene.
    pub const N_PER_M: [f32; 2] = [1.0, 1e5];
    /// Smallest and largest stiffness in rotation, N m/rad: the range of a scene.
    pub const NM_PER_RAD: [f32; 2] = [1e-4, 1e3];
}

/// Haptic device of a client, as fields of the recording.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct DeviceInfo {
    /// Name of the device or of its kind; empty for a slot without a device.
    pub name: String,
    /// Library that drives the device: `openhaptics`, `haply`, `forcedimension`, `simulated`, `mouse`. Empty for a
    /// device that is not described: then all figures are unknown.
    pub library: String,
    /// Serial number of the device; may be empty.
    pub serial: String,
    /// BLAKE3 of the model file, 64 lower-case hexadecimal digits; empty without a model file.
    pub model_hash: String,
    /// Trust of the model's figures, one of [`FIGURES`]; empty if unknown.
    pub figures: String,
    /// Period of the device's loop, nanoseconds; 0 if unknown.
    pub period_ns: u64,
    /// Measured delay of the loop from a pose to the wrench that answers it, microseconds; 0 if unknown.
    pub delay_us: u32,
    /// Length in the world per length at the device, above 0.
    pub workspace_scale: f32,
    /// Largest force that the device displays, newtons; 0 if unknown.
    pub max_force_n: f32,
    /// Largest torque that the device displays, newton-metres; 0 for a device without torque.
    pub max_torque_nm: f32,
    /// Coulomb friction in free space, newtons; 0 if unknown.
    pub friction_n: f32,
    /// Number of axes whose motion the device measures, 0 to 6.
    pub motion_axes: u8,
    /// Number of translational axes with force, 0 to 3.
    pub force_axes: u8,
    /// Number of rotational axes with torque, 0 to 3.
    pub torque_axes: u8,
    /// Stiffest coupling that the device can display; `None` if unknown.
    pub coupling: Option<DeviceCoupling>,
}

impl Default for DeviceInfo {
    fn default() -> Self {
        Self {
            name: String::new(),
            library: String::new(),
            serial: String::new(),
            model_hash: String::new(),
            figures: String::new(),
            period_ns: 0,
            delay_us: 0,
            workspace_scale: 1.0,
            max_force_n: 0.0,
            max_torque_nm: 0.0,
            friction_n: 0.0,
            motion_axes: 0,
            force_axes: 0,
            torque_axes: 0,
            coupling: None,
        }
    }
}

impl DeviceInfo {
    /// Device of which only the name is known.
    pub fn named(name: &str) -> Self {
        Self {
            name: name.to_owned(),
            ..Self::default()
        }
    }

    /// Whether the slot has a device.
    pub fn is_there(&self) -> bool {
        !self.name.is_empty()
    }

    /// Checks texts and numbers.
    ///
    /// # Errors
    /// A field is out of its range: one phrase with name, value found and value expected.
    pub fn validate(&self) -> Result<(), String> {
        self.validate_texts()?;
        let number = |field: &str, found: f32, valid: bool, expected: &str| {
            if valid {
                Ok(())
            } else {
                Err(format!("{field} is {found}, expected {expected}"))
            }
        };
        let scale = self.workspace_scale;
        let is_scale = scale.is_finite() && scale > 0.0;
        number(
            "workspace_scale",
            scale,
            is_scale,
            "a positive finite number",
        )?;
        for (field, found) in [
            ("max_force_n", self.max_force_n),
            ("max_torque_nm", self.max_torque_nm),
            ("friction_n", self.friction_n),
        ] {
            let valid = found.is_finite() && found >= 0.0;
            number(field, found, valid, "0 or a positive finite number")?;
        }
        for (field, found, most) in [
            ("motion_axes", self.motion_axes, 6),
            ("force_axes", self.force_axes, 3),
            ("torque_axes", self.torque_axes, 3),
        ] {
            if found > most {
                return Err(format!("{field} is {found}, expected 0 to {most}"));
            }
        }
        let Some(coupling) = self.coupling else {
            return Ok(());
        };
        for (field, found, [least, most], axes) in [
            (
                "coupling n_per_m",
                coupling.n_per_m,
                DeviceCoupling::N_PER_M,
                self.force_axes,
            ),
            (
                "coupling nm_per_rad",
                coupling.nm_per_rad,
                DeviceCoupling::NM_PER_RAD,
                self.torque_axes,
            ),
        ] {
            // A device without such axes displays no coupling, so it limits none.
            let without = axes == 0 && found == 0.0;
            let valid = without || (least..=most).contains(&found);
            let or = if axes == 0 { "0 or " } else { "" };
            number(field, found, valid, &format!("{or}{least} to {most}"))?;
        }
        Ok(())
    }

    /// Checks the texts.
    fn validate_texts(&self) -> Result<(), String> {
        for (field, text) in [
            ("name", &self.name),
            ("library", &self.library),
            ("serial", &self.serial),
        ] {
            if text.len() > NAME_BYTES {
                let found = text.len();
                return Err(format!(
                    "{field} has {found} bytes, expected at most {NAME_BYTES}"
                ));
            }
        }
        let digit = |c: u8| c.is_ascii_digit() || (b'a'..=b'f').contains(&c);
        let hash = self.model_hash.as_bytes();
        if !(hash.is_empty() || hash.len() == 64 && hash.iter().all(|c| digit(*c))) {
            let found = hash.len();
            return Err(format!(
                "model_hash has {found} bytes, expected none or 64 lower-case hexadecimal digits"
            ));
        }
        if !(self.figures.is_empty() || FIGURES.contains(&self.figures.as_str())) {
            let expected = FIGURES.join(", ");
            return Err(format!(
                "figures has {} bytes, expected none or one of {expected}",
                self.figures.len()
            ));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stylus() -> DeviceInfo {
        DeviceInfo {
            name: "stylus".into(),
            library: "openhaptics".into(),
            model_hash: "0a".repeat(32),
            figures: "guess".into(),
            max_force_n: 3.3,
            friction_n: 0.26,
            motion_axes: 6,
            force_axes: 3,
            coupling: Some(DeviceCoupling {
                n_per_m: 400.0,
                nm_per_rad: 0.0,
            }),
            ..DeviceInfo::default()
        }
    }

    #[test]
    fn a_field_out_of_its_range_is_named_with_value_and_range() {
        assert_eq!(DeviceInfo::default().validate(), Ok(()));
        assert_eq!(stylus().validate(), Ok(()));
        let coupling = |device: &mut DeviceInfo, n_per_m, nm_per_rad| {
            device.coupling = Some(DeviceCoupling {
                n_per_m,
                nm_per_rad,
            });
        };
        type Change<'a> = &'a dyn Fn(&mut DeviceInfo);
        let cases: [(Change, &str); 14] = [
            (&|d| d.name = "x".repeat(257), "name has 257 bytes"),
            (&|d| d.library = "x".repeat(257), "library has 257 bytes"),
            (&|d| d.serial = "x".repeat(257), "serial has 257 bytes"),
            (&|d| d.model_hash = "0A".repeat(32), "model_hash has 64"),
            (&|d| d.figures = "sure".into(), "figures has 4 bytes"),
            (&|d| d.workspace_scale = 0.0, "workspace_scale is 0"),
            (&|d| d.friction_n = f32::NAN, "friction_n is NaN"),
            (&|d| d.max_force_n = -1.0, "max_force_n is -1"),
            (&|d| d.motion_axes = 7, "motion_axes is 7, expected 0 to 6"),
            (&|d| d.torque_axes = 4, "torque_axes is 4, expected 0 to 3"),
            // A device with force must display some coupling.
            (
                &|d| coupling(d, 0.0, 0.0),
                "coupling n_per_m is 0, expected 1 to 100000",
            ),
            (&|d| coupling(d, f32::NAN, 0.0), "coupling n_per_m is NaN"),
            (&|d| coupling(d, 1e6, 0.0), "coupling n_per_m is 1000000"),
            (
                &|d| coupling(d, 400.0, 1e-5),
                "coupling nm_per_rad is 0.00001, expected 0 or 0.0001 to 1000",
            ),
        ];
        for (change, said) in cases {
            let mut device = stylus();
            change(&mut device);
            let error = device.validate().expect_err(said);
            assert!(error.starts_with(said), "{said}: {error}");
        }
    }
}
