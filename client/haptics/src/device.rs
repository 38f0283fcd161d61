//! Interface of a haptic device with a thread and a clock of its own.

use std::fmt;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::port::HandPort;

/// A hand that a device or a group of devices serves.
#[derive(Clone, Debug, PartialEq)]
pub struct HandInfo {
    /// Name of the library: `openhaptics`, `forcedimension`, `haply`, `playback`.
    pub library: &'static str,
    /// Model, as the library names it.
    pub model: String,
    /// Serial number or name of the configuration: with the library the identity of the device.
    pub serial: String,
    /// Number of axes in which the device measures motion, 0 to 7.
    pub motion_dof: u8,
    /// Number of translational axes with force, 0 to 3.
    pub force_axes: u8,
    /// Number of rotational axes with torque, 0 to 3.
    pub torque_axes: u8,
    /// Period of the device's thread, nanoseconds.
    pub period_ns: u64,
    /// Limits that the driver itself reports.
    pub reported: Reported,
}

/// Limits that a driver reports at run time; `None` for a value that the driver does not know.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Reported {
    /// Largest force, newtons.
    pub peak_n: Option<f64>,
    /// Largest continuous force, newtons.
    pub continuous_n: Option<f64>,
    /// Largest stiffness, newtons per metre.
    pub stiffness_n_per_m: Option<f64>,
}

/// Request to end, from another thread.
#[derive(Clone, Debug, Default)]
pub struct Stop(Arc<AtomicBool>);

impl Stop {
    /// Creates a request that is not made yet.
    pub fn new() -> Self {
        Self::default()
    }

    /// Makes the request.
    pub fn ask(&self) {
        self.0.store(true, Ordering::Release);
    }

    /// Whether the request was made.
    pub fn is_asked(&self) -> bool {
        self.0.load(Ordering::Acquire)
    }
}

/// Error that ends the run of a device: one sentence with the cause and the remedy.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DeviceError(pub String);

impl fmt::Display for DeviceError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for DeviceError {}

/// A device, or all devices of one library that share a thread.
pub trait Device: Send {
    /// Hands of the device, in the order of the ports of [`Device::run`].
    fn info(&self) -> &[HandInfo];

    /// Runs until `stop` is asked, with a port for each hand. The calling thread belongs to the device.
    ///
    /// A device that is unplugged stays in its run without a pose, and returns when it is plugged in again. The force
    /// of every hand is zero at the end, whatever the result.
    ///
    /// # Errors
    /// The library cannot continue.
    fn run(&mut self, ports: Vec<HandPort>, stop: &Stop) -> Result<(), DeviceError>;
}
