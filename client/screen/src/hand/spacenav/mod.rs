//! 3D mouse by the daemon `spacenavd`: records, their meaning, and the socket.
//!
//! The daemon sends records over a stream socket. A client that sends nothing gets the first version of the protocol.

pub mod cap;
pub mod record;
#[cfg(unix)]
pub mod socket;

pub use cap::CapRule;
pub use record::{Event, Parser};
#[cfg(unix)]
pub use socket::{Lost, Socket, path};
