//! 3D mouse: records and socket of the daemon `spacenavd`, raw reports for systems without it, and their meaning.
//!
//! The daemon sends records over a stream socket. A client that sends nothing gets the first version of the protocol.

pub mod cap;
pub mod record;
pub mod report;
#[cfg(unix)]
pub mod socket;

pub use cap::CapRule;
pub use record::{Event, Parser};
pub use report::Reports;
#[cfg(unix)]
pub use socket::{Lost, Socket, path};
