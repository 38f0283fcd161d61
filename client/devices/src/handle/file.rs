//! File of a handle adapter, TOML.

use std::fmt;

use serde::{Deserialize, Serialize};
use sulcus_core::math::{Mat3, norm};
use sulcus_core::{Pose, Quat, Vec3};

use super::pivot::Pivot;

/// Hand that holds a handle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Side {
    /// Left hand.
    Left,
    /// Right hand.
    Right,
    /// Both hands may hold it.
    Either,
}

/// Instrument that is fixed to a device.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Handle {
    /// Name of the instrument.
    pub instrument: String,
    /// Hand that holds the handle.
    pub hand: Side,
    /// Position of the tip in the frame of the handle, mm.
    pub gimbal_from_tip_mm: [f64; 3],
    /// Unit vector of the shank in the frame of the handle, pointing out of the tip.
    pub axis: [f64; 3],
    /// Turn of the tool about the axis against the x axis of the handle, degrees, right-handed.
    #[serde(default)]
    pub roll_deg: f64,
    /// Mass of instrument and adapter, g.
    pub mass_g: f64,
    /// Residual of the calibration, root mean square, mm; absent for a tip that was not measured.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub residual_mm: Option<f64>,
}

/// Error of a handle file.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum HandleError {
    /// The text is no handle: line and cause.
    #[error("not a handle: {0}")]
    Format(String),
    /// A value is out of its range.
    #[error("{field} is {found}, expected {expected}")]
    Value {
        /// Name of the field.
        field: &'static str,
        /// Value found.
        found: String,
        /// Values expected.
        expected: &'static str,
    },
}

impl Handle {
    /// Handle of a straight instrument through the centre of the gimbal, from the calibration of its tip.
    pub fn straight(instrument: &str, hand: Side, mass_g: f64, pivot: &Pivot) -> Self {
        let tip = pivot.gimbal_from_tip;
        let length = norm(&tip);
        let axis = if length > 0.0 {
            tip / length
        } else {
            -Vec3::z()
        };
        Self {
            instrument: instrument.into(),
            hand,
            gimbal_from_tip_mm: (tip * 1e3).into(),
            axis: axis.into(),
            roll_deg: 0.0,
            mass_g,
            residual_mm: Some(pivot.residual * 1e3),
        }
    }

    /// Reads and checks a handle file.
    ///
    /// # Errors
    /// The text is no TOML, a field is missing, unknown or out of its range.
    pub fn from_toml(text: &str) -> Result<Self, HandleError> {
        let handle: Self = sulcus_haptics::exact::read(text).map_err(HandleError::Format)?;
        handle.validate()?;
        Ok(handle)
    }

    /// Text of the handle file.
    ///
    /// # Errors
    /// A value cannot be written as TOML.
    pub fn to_toml(&self) -> Result<String, HandleError> {
        toml::to_string(self).map_err(|error| HandleError::Format(error.to_string()))
    }

    /// Checks every value.
    ///
    /// # Errors
    /// The first value out of its range: field, value found, values expected.
    pub fn validate(&self) -> Result<(), HandleError> {
        if self.instrument.trim().is_empty() {
            return Err(value("instrument", &"empty", "the name of the instrument"));
        }
        for x in self.gimbal_from_tip_mm {
            ranged(
                "gimbal_from_tip_mm",
                x,
                -500.0,
                500.0,
                "three lengths of -500 to 500",
            )?;
        }
        ranged(
            "axis",
            norm(&Vec3::from(self.axis)),
            0.999,
            1.001,
            "a vector of length 1",
        )?;
        ranged("roll_deg", self.roll_deg, -360.0, 360.0, "-360 to 360")?;
        ranged("mass_g", self.mass_g, 0.0, 1000.0, "0 to 1000")?;
        ranged(
            "residual_mm",
            self.residual_mm.unwrap_or(0.0),
            0.0,
            10.0,
            "0 to 10",
        )
    }

    /// Returns the pose of a tool in the frame of the handle, metres. `tip` (metres) and `axis` (unit vector out of the
    /// tip) are those of the tool, in the tool's frame.
    ///
    /// The tips coincide and the axes are aligned. About the axis, the x axis of the tool has the direction of the x
    /// axis of the handle, turned by [`Handle::roll_deg`]. Where an x axis is parallel to its own axis, the y axis
    /// takes its place.
    pub fn gimbal_from_tool(&self, tip: &Vec3, axis: &Vec3) -> Pose {
        let own_axis = Vec3::from(self.axis);
        let turned = Quat::from_scaled_axis(unit(&own_axis) * self.roll_deg.to_radians());
        let matrix = turned.to_rotation_matrix() * triad(&own_axis) * triad(axis).transpose();
        let orientation = Quat::from_matrix(&matrix);
        let own_tip = Vec3::from(self.gimbal_from_tip_mm) * 1e-3;
        Pose::new(own_tip - orientation * tip, orientation)
    }
}

impl fmt::Display for Side {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Left => "left",
            Self::Right => "right",
            Self::Either => "either",
        })
    }
}

/// Right-handed triad with `axis` as its third column and the part of x across the axis as its first.
fn triad(axis: &Vec3) -> Mat3 {
    let along = unit(axis);
    let across = |reference: Vec3| reference - along * along.dot(&reference);
    let x = across(Vec3::x());
    let first = unit(&if norm(&x) > 0.05 {
        x
    } else {
        across(Vec3::y())
    });
    Mat3::from_columns(&[first, along.cross(&first), along])
}

fn unit(v: &Vec3) -> Vec3 {
    let length = norm(v);
    if length > 0.0 { v / length } else { Vec3::z() }
}

fn value(field: &'static str, found: &dyn fmt::Display, expected: &'static str) -> HandleError {
    HandleError::Value {
        field,
        found: found.to_string(),
        expected,
    }
}

fn ranged(
    field: &'static str,
    found: f64,
    low: f64,
    high: f64,
    expected: &'static str,
) -> Result<(), HandleError> {
    // In this form a NaN is outside.
    if found >= low && found <= high {
        return Ok(());
    }
    Err(value(field, &found, expected))
}
