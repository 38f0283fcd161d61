//! 3D mouse: records and socket of the daemon `spacenavd`, raw reports for systems without it, and their meaning.
//!
//! The daemon sends records over a stream socket. A client that sends nothing gets the first version of the protocol.

pub mod cap;
#[cfg(feature = "hid")]
pub mod hid;
pub mod record;
pub mod report;
#[cfg(unix)]
pub mod socket;

pub use cap::CapRule;
#[cfg(feature = "hid")]
pub use hid::Hid;
pub use record::{Event, Parser};
pub use report::Reports;
#[cfg(unix)]
pub use socket::{Lost, Socket, path};
