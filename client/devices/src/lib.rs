//! Back-ends of haptic devices.
//!
//! A back-end drives the devices of one library or service and implements [`sulcus_haptics::Device`]. Libraries of
//! vendors are opened at run time and never closed: a second load of a driver fails in the same process. Nothing of a
//! vendor is part of this program.
//!
//! [`backends`] lists all back-ends. [`Backend::list`] finds their devices, and [`Backend::open`] opens some of them.

#![cfg_attr(not(test), warn(clippy::print_stdout, clippy::print_stderr))]

pub mod doctor;
pub mod forcedimension;
mod found;
pub mod handle;
pub mod haply;
pub mod library;
pub mod measure;
pub mod openhaptics;

pub use found::{Found, State};

use sulcus_haptics::device::{Device, DeviceError};

/// Back-end of one library or service.
pub trait Backend {
    /// Name of the library: `haply`, `openhaptics`, `forcedimension`.
    fn name(&self) -> &'static str;

    /// Finds the devices. A library that is absent or unusable is an entry without a device: its state and message say
    /// why and what to do. The call ends within about two seconds, and no device moves or gets a force.
    fn list(&self) -> Vec<Found>;

    /// Opens the devices of `serials`, in this order, for one run. An empty list is an error.
    ///
    /// # Errors
    /// The library is absent or unusable, or a device is absent, in use or unusable: one sentence with the remedy.
    fn open(&self, serials: &[String]) -> Result<Box<dyn Device>, DeviceError>;
}

/// Returns all back-ends, in the order of the listing.
pub fn backends() -> Vec<Box<dyn Backend>> {
    vec![
        Box::new(haply::Haply::default()),
        Box::new(openhaptics::OpenHaptics::default()),
        Box::new(forcedimension::ForceDimension::default()),
    ]
}
