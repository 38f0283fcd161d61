//! Entry of the list of devices.

use serde::Serialize;

/// State of a device or of a back-end without a device.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum State {
    /// The device can be used.
    Ready,
    /// The device must be calibrated first.
    Uncalibrated,
    /// A part of the device sleeps or has no power.
    Asleep,
    /// Another program uses the device.
    InUse,
    /// The library or the service runs and has no device.
    NoDevice,
    /// The library or the service is absent.
    NoLibrary,
    /// The library or the service has a version that is not supported, or lacks a function.
    WrongVersion,
    /// Another error.
    Error,
}

/// Device, or back-end without a device.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Found {
    /// Name of the back-end.
    pub library: &'static str,
    /// Model, as the library reports it; empty without a device.
    pub model: String,
    /// Serial number or name of the configuration; empty without a device.
    pub serial: String,
    /// Hand of the device: `left`, `right`, or empty if no hand is stored.
    pub hand: String,
    /// Number of axes in which the device measures motion; 0 without a device.
    pub motion_dof: u8,
    /// Number of axes in which the device displays force or torque; 0 without a device.
    pub force_dof: u8,
    /// State.
    pub state: State,
    /// One sentence: state, and the remedy where one is needed.
    pub message: String,
}

impl Found {
    /// Entry of a back-end without a device.
    pub fn nothing(library: &'static str, state: State, message: impl Into<String>) -> Self {
        Self {
            library,
            model: String::new(),
            serial: String::new(),
            hand: String::new(),
            motion_dof: 0,
            force_dof: 0,
            state,
            message: message.into(),
        }
    }
}
