//! The path of a wrench to a real hand: watchdog, clamp, passivity control, slew limit.
//!
//! The simulation's wrench passes, in this order:
//! 1. [`Watchdog`]: the share of the force that may be displayed, from the times at which wrenches arrived.
//! 2. [`gated`]: clamp to the [`Limits`] of the server's hello, times that share. A wrench
//!    with a value that is not finite becomes zero.
//! 3. [`Passivity`]: damping while the loop of hand, device and simulation generates energy.
//! 4. [`slewed`]: limit of the change per millisecond, [`SlewLimits`].
//!
//! [`Display`] implements steps 3 and 4 for one hand. This crate uses no clock, no socket and no device driver. Begin
//! at [`device::Device`], the interface of a haptic device.
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

pub mod device;
pub mod display;
pub mod limits;
pub mod passivity;
pub mod watchdog;

pub use device::{Device, Shown, drawn};
pub use display::{Display, slewed};
pub use limits::{Limits, SlewLimits, gated};
pub use passivity::{Energy, Passivity, PassivityParams};
pub use watchdog::Watchdog;
