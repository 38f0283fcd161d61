//! Stations over QUIC, the real-time thread, recording.
//!
//! # Threads of one server
//! - *network*: a current-thread tokio runtime; owns the endpoint, the control stream, all sockets.
//! - *simulation*, one per session: a plain thread at SCHED_FIFO where permitted, ticking at 1 kHz on
//!   absolute deadlines. It never allocates, locks, or touches a tokio type.
//! - *recorder*, one per session: writes and signs the recording behind a bounded queue.
//!
//! They meet in wait-free hand-overs only: triple buffers (newest wins) for poses and wrenches, a ring
//! for rows, atomic words for buttons, pause and force limit, one eventfd to wake the network.
//!
//! What depends on a wall clock (age, staleness, skipped ticks) is decided here and handed to the
//! tick as input, so a recording of inputs is enough to run the session again.

#![cfg_attr(not(test), warn(clippy::print_stdout, clippy::print_stderr))]

pub mod cli;
pub mod error;
mod net;
mod outlets;
pub mod serve;
pub mod session;
pub mod station;

pub use error::ServerError;
pub use net::identity::fingerprint;
pub use session::detail::{Budget, Detail};
pub use station::config::{Exercise, ServerConfig};
pub use station::handle::{Server, ServerHandle};
pub use sulcus_link::clock::monotonic_ns;
