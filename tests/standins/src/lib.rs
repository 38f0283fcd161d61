//! Stand-ins of haptic drivers and their controllers, for tests.
//!
//! Three parts work together.
//! The program `standin-controller` plays the device boxes, their motors and the hands of the users.
//! The libraries `standin_hd` and `standin_dhd` play the vendors' drivers; a client loads them with `dlopen`.
//! The [`Rig`] starts the controller, causes faults and reads the controller's log.
//!
//! The controller and the libraries share a file in memory, the [`board`].
//! A library finds the file by the environment variable [`board::ENV`] and by nothing else.
//!
//! A test starts a [`Rig`] and passes [`Rig::environment`] to its client process.
//! A test that loads a library into its own process calls `standin_reset` of the library with [`Rig::board`].
//! The controller's log has the commands as the client asked for them, and the output of the motors.
//!
//! ```no_run
//! use sulcus_standins::setup::{DeviceSetup, Setup};
//! use sulcus_standins::{Fault, Rig, library};
//!
//! # fn main() -> std::io::Result<()> {
//! let rig = Rig::start(Setup::new(vec![DeviceSetup::touch("Left", "L1")]))?;
//! let (variable, board) = rig.environment();
//! let mut client = std::process::Command::new("a-client")
//!     .arg(library("standin_hd")?)
//!     .env(variable, board)
//!     .spawn()?;
//! rig.fault(0, Fault::Stall(50))?;
//! client.kill()?;
//! let log = rig.log()?;
//! assert!(log.flaws(rig.setup()).is_empty());
//! assert!(log.largest_force(0) <= 3.3);
//! # Ok(())
//! # }
//! ```
//!
//! The stand-ins work on Linux; the package is empty on other systems.
#![cfg(target_os = "linux")]

pub mod board;
pub mod clock;
pub mod log;
pub mod pose;
mod rig;
pub mod setup;

pub use log::Log;
pub use rig::{Fault, Request, Response, Rig, Snapshot, example, library};
