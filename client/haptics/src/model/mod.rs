//! Model of a haptic device: figures of its data sheet or of its measurement, as a TOML file.
//!
//! The files of known devices are part of the program. `sulcus-client devices measure` writes the file of a person's
//! own device.

mod coupling;
mod figure;
mod shipped;

pub use coupling::{COUPLING_MARGIN, Coupling, LOOP_DELAY_S};
pub use figure::{Figure, Source};
pub use shipped::{shipped, shipped_for};

use serde::{Deserialize, Serialize};

/// Model of a device.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DeviceModel {
    /// Name for display.
    pub name: String,
    /// Library that drives the device: `openhaptics`, `forcedimension`, `haply`, `virtuose`.
    pub library: String,
    /// Names of the model, as the library reports it. Capitals do not matter.
    pub reported_as: Vec<String>,
    /// Serial number of a measured device; empty for all devices of the model.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub serial: String,
    /// Number of axes in which the device measures motion, 3 to 7.
    pub motion_dof: u8,
    /// Number of translational axes with force, 0 to 3.
    pub force_axes: u8,
    /// Number of rotational axes with torque, 0 to 3.
    pub torque_axes: u8,
    /// Rate of the device's thread, Hz, 500 to 8000.
    pub rate_hz: Figure,
    /// Delay from a measured pose to the force that answers at the motors, without the link, ms.
    pub latency_ms: Figure,
    /// Edges of the workspace: right, up, towards the person, mm.
    pub workspace_mm: Figure<[f64; 3]>,
    /// Largest force, N.
    pub peak_force_n: Figure,
    /// Force at which the device may stay, N.
    pub continuous_force_n: Figure,
    /// Largest stiffness of a wall, N/mm.
    pub stiffness_n_per_mm: Figure,
    /// Damping of the device against which a stiffness is stable, N s/m.
    pub damping_n_s_per_m: Figure,
    /// Coulomb friction of the free handle, N.
    pub friction_n: Figure,
    /// Apparent mass at the handle, g.
    pub mass_g: Figure,
    /// Smallest measured step, mm.
    pub resolution_mm: Figure,
    /// Largest torque, mN m; required with torque axes.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub peak_torque_mnm: Option<Figure>,
    /// Torque at which the device may stay, mN m; required with torque axes.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub continuous_torque_mnm: Option<Figure>,
    /// Largest stiffness in rotation, N m/rad; required with torque axes.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub turning_stiffness_nm_per_rad: Option<Figure>,
    /// Damping in rotation, N m s/rad; required with torque axes.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub turning_damping_nm_s_per_rad: Option<Figure>,
}

/// Error of a model file.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ModelError {
    /// The text is no model: line and cause.
    #[error("not a device model: {0}")]
    Format(String),
    /// A figure is out of its range.
    #[error("{field} is {found}, expected {expected}")]
    Figure {
        /// Name of the field.
        field: &'static str,
        /// Value found.
        found: String,
        /// Values expected.
        expected: &'static str,
    },
}

impl DeviceModel {
    /// Reads and checks a model file.
    ///
    /// # Errors
    /// The text is no TOML, a field is missing, unknown or out of its range.
    pub fn from_toml(text: &str) -> Result<Self, ModelError> {
        let model: Self = crate::exact::read(text).map_err(ModelError::Format)?;
        model.validate()?;
        Ok(model)
    }

    /// Text of the model file.
    ///
    /// # Errors
    /// A value cannot be written as TOML.
    pub fn to_toml(&self) -> Result<String, ModelError> {
        toml::to_string(self).map_err(|error| ModelError::Format(error.to_string()))
    }

    /// Checks every figure.
    ///
    /// # Errors
    /// The first figure out of its range: field, value found, values expected.
    pub fn validate(&self) -> Result<(), ModelError> {
        count("motion_dof", self.motion_dof, 3..=7, "3 to 7")?;
        count("force_axes", self.force_axes, 0..=3, "0 to 3")?;
        count("torque_axes", self.torque_axes, 0..=3, "0 to 3")?;
        let figures = [
            ("rate_hz", &self.rate_hz, 500.0, 8000.0, "500 to 8000"),
            ("latency_ms", &self.latency_ms, 0.0, 100.0, "0 to 100"),
            ("peak_force_n", &self.peak_force_n, 0.1, 100.0, "0.1 to 100"),
            (
                "stiffness_n_per_mm",
                &self.stiffness_n_per_mm,
                0.01,
                100.0,
                "0.01 to 100",
            ),
            (
                "damping_n_s_per_m",
                &self.damping_n_s_per_m,
                0.01,
                1000.0,
                "0.01 to 1000",
            ),
            ("friction_n", &self.friction_n, 0.0, 10.0, "0 to 10"),
            ("mass_g", &self.mass_g, 1.0, 5000.0, "1 to 5000"),
            (
                "resolution_mm",
                &self.resolution_mm,
                1e-5,
                1.0,
                "0.00001 to 1",
            ),
        ];
        for (field, figure, low, high, expected) in figures {
            ranged(field, figure.value, low, high, expected)?;
        }
        for edge in self.workspace_mm.value {
            ranged(
                "workspace_mm",
                edge,
                10.0,
                2000.0,
                "three edges of 10 to 2000",
            )?;
        }
        let (peak, lasting) = (self.peak_force_n.value, self.continuous_force_n.value);
        ranged(
            "continuous_force_n",
            lasting,
            0.05,
            peak,
            "0.05 to peak_force_n",
        )?;
        let torques = [
            (
                "peak_torque_mnm",
                &self.peak_torque_mnm,
                0.1,
                1e5,
                "0.1 to 100000",
            ),
            (
                "continuous_torque_mnm",
                &self.continuous_torque_mnm,
                0.1,
                1e5,
                "0.1 to 100000",
            ),
            (
                "turning_stiffness_nm_per_rad",
                &self.turning_stiffness_nm_per_rad,
                1e-3,
                1e3,
                "0.001 to 1000",
            ),
            (
                "turning_damping_nm_s_per_rad",
                &self.turning_damping_nm_s_per_rad,
                1e-5,
                10.0,
                "0.00001 to 10",
            ),
        ];
        for (field, figure, low, high, expected) in torques {
            match figure {
                Some(figure) => ranged(field, figure.value, low, high, expected)?,
                None if self.torque_axes > 0 => {
                    return Err(ModelError::Figure {
                        field,
                        found: "missing".into(),
                        expected: "a figure for a device with torque axes",
                    });
                }
                None => {}
            }
        }
        Ok(())
    }

    /// Whether the model is that of a device which `library` reports as `model`. Capitals do not matter.
    pub fn is_of(&self, library: &str, model: &str) -> bool {
        let mut names = self.reported_as.iter().chain([&self.name]);
        self.library == library && names.any(|name| name.eq_ignore_ascii_case(model.trim()))
    }

    /// Least trust of the figures on which the safety of a hand depends: forces, stiffness, damping.
    pub fn trust(&self) -> Source {
        [
            &self.peak_force_n,
            &self.continuous_force_n,
            &self.stiffness_n_per_mm,
            &self.damping_n_s_per_m,
        ]
        .iter()
        .map(|figure| figure.source)
        .min()
        .unwrap_or(Source::Guess)
    }

    /// Whether the device displays a torque.
    pub fn has_torque(&self) -> bool {
        self.torque_axes > 0
    }

    /// Remark about a device whose friction hides forces of `force_n` newtons; `None` for a finer device.
    pub fn friction_remark(&self, force_n: f64) -> Option<String> {
        let friction = &self.friction_n;
        (friction.value >= force_n).then(|| {
            format!(
                "the friction of {} ({} N, {}) hides a force of {force_n} N: what the hand feels of light probing is \
                 not judged",
                self.name,
                friction.value,
                friction.source.name()
            )
        })
    }
}

fn count(
    field: &'static str,
    found: u8,
    range: std::ops::RangeInclusive<u8>,
    expected: &'static str,
) -> Result<(), ModelError> {
    if range.contains(&found) {
        return Ok(());
    }
    Err(ModelError::Figure {
        field,
        found: found.to_string(),
        expected,
    })
}

fn ranged(
    field: &'static str,
    found: f64,
    low: f64,
    high: f64,
    expected: &'static str,
) -> Result<(), ModelError> {
    // In this form a NaN is outside.
    if found >= low && found <= high {
        return Ok(());
    }
    Err(ModelError::Figure {
        field,
        found: found.to_string(),
        expected,
    })
}

#[cfg(test)]
mod tests;
