//! Devices of a session, and the limits in force at its beginning, as fields of the header.

use std::fmt;

use serde::{Deserialize, Serialize};
use sulcus_core::MAX_TOOLS;

use crate::record::sane::{above_zero, no_less_than_zero, text_of};

/// Haptic device in a slot, as its client described it.
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
        if self.force_dof > 6 {
            return Err(format!(
                "device force_dof is {}, expected 0 to 6",
                self.force_dof
            ));
        }
        Ok(())
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
        )
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
