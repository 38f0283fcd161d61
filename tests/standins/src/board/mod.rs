//! The board: a file in memory that the controller and the driver libraries share.
//!
//! The controller writes the state of every device box to the board.
//! A library writes messages to a ring of its own on the board.
//! Neither side waits for the other side, and neither side calls the kernel for it.

mod layout;
mod link;
mod message;
mod ring;
mod shared;
mod state;

pub use layout::{Board, BoardError, DEVICES, Driver, RINGS, Slot};
pub use link::{Library, Link, LinkError};
pub use message::{Call, Command, Message, NO_DEVICE, Packet};
pub use ring::Ring;
pub use shared::{Shared, Text, Words};
pub use state::{Calibration, Family, Mode, OffCause, State, Traits};

/// Environment variable with the path of the board. The libraries read no other variable.
pub const ENV: &str = "SULCUS_STANDIN_BOARD";
