//! The door of a hand: the only way of a wrench from the simulation to a device.
//!
//! A wrench passes the [`Door`] of its hand, in this order:
//! 1. interpolation between two wrenches, for a device that is faster than the link,
//! 2. [`Mapping`] to the axes and the handle of the device,
//! 3. [`Watchdog`], [`freshness`] and [`interlock`]: the share of the force that may be displayed,
//! 4. [`gated`]: clamp to the smallest of all [`Limits`] and to the [`continuous`] force. A wrench with a value that is
//!    not finite becomes zero.
//! 5. [`Passivity`]: damping while the loop of hand, device and simulation generates energy,
//! 6. [`slewed`]: limit of the change per millisecond, [`SlewLimits`],
//! 7. a last clamp.
//!
//! A haptic [`Device`] has a thread and a clock of its own and holds a [`HandPort`] for each hand. A [`HandSource`],
//! such as the simulated operator or a mouse, is read in step with the loop of the link; the same door stands before
//! it, without steps 1, 2 and the guard of a device. This crate uses no clock, no socket and no device driver.
//!
//! ```
//! use sulcus_core::{Params, Vec3, Wrench};
//! use sulcus_haptics::{Display, Limits, PassivityParams, SlewLimits, gated};
//!
//! let limits = Limits { force_n: 3.3, torque_nm: 0.2 };
//! let mut display = Display::new(PassivityParams::default(), SlewLimits::from(&Params::default()));
//! let sent = Wrench { force: Vec3::new(0.0, 0.0, 100.0), torque: Vec3::zeros() };
//! // A watchdog that is half open passes half of the clamped force; the slew limit passes 0.5 N of it per millisecond.
//! let wanted = gated(&sent, 0.5, &limits);
//! assert!((wanted.force.z - 1.65).abs() < 1e-12);
//! assert!((display.next(&wanted, 0.5).force.z - 0.5).abs() < 1e-12);
//! ```

pub mod continuous;
pub mod device;
pub mod display;
pub mod door;
pub mod exact;
pub mod freshness;
pub mod guide;
pub mod hands;
pub mod interlock;
pub mod limits;
pub mod mapping;
pub mod merger;
pub mod model;
pub mod passivity;
pub mod port;
pub mod watchdog;

pub use device::{Device, DeviceError, HandInfo, Stop};
pub use display::{Display, slewed};
pub use door::{Door, DoorRules, Guard, Wanted};
pub use hands::{HandSource, Shown, drawn};
pub use interlock::{Stage, Trip, Unready};
pub use limits::{Limits, SlewLimits, gated};
pub use mapping::Mapping;
pub use merger::{Merged, Merger};
pub use model::DeviceModel;
pub use passivity::{Energy, Passivity, PassivityParams};
pub use port::{HandEnd, HandPort, Sample};
pub use watchdog::Watchdog;
