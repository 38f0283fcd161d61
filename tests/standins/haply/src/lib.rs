//! Stand-in of the Haply Inverse service, for tests.
//!
//! The stand-in speaks the simulation channel, the settings over HTTP and the channel of events. Hands are simulated,
//! faults are commanded by the test, and a log in a file holds all that the client did.
//! [`Service`] runs the stand-in inside of the test, [`Process`] runs the program `standin-haply` beside it.

mod clock;
mod device;
mod fault;
mod log;
mod message;
mod net;
mod options;
mod process;
mod request;
mod service;
mod version;
mod world;

pub use clock::now_ns;
pub use device::{
    ArmKind, ArmOptions, ArmStatus, ArmView, Buttons, GripArray, GripOptions, Handedness, Mechanics,
};
pub use device::{Motion, Point, Turn};
pub use fault::{BadNumber, Fault, Place, SafetyCause};
pub use log::{Command, EndReason, Entry, IdleCause, IdleSpan, Log, Sent, Violation, What};
pub use options::{Omission, Omit, Options, Replies};
pub use process::{Process, find_program};
pub use request::{Ready, Request, RequestError};
pub use service::Service;
pub use version::Version;

/// Vector of three numbers in the frame of an arm: x right, y forward, z up.
pub type Vector = [f64; 3];

/// Rotation as a quaternion in the order w, x, y, z.
pub type Quaternion = [f64; 4];
