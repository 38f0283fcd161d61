//! Server of stations: QUIC, one real-time simulation thread for each session, recording.
//!
//! # Threads of one server
//! - *network*: a current-thread tokio runtime; one task for each station and one for each connection.
//! - *simulation*, one per session: a plain thread at SCHED_FIFO where permitted. It ticks at the scene's rate on
//!   absolute deadlines, and while it ticks, it never allocates, locks, or touches a tokio type.
//! - *recorder*, one per session: writes and signs the recording behind a bounded queue.
//!
//! Every hand-over to and from the simulation is wait-free. Triple buffers carry poses and wrenches, and the newest
//! wins. A ring carries rows to the recorder. Atomic words hold buttons, pause and force limit. One eventfd wakes the
//! network. A bounded channel carries a client's events from the network to the recorder.
//!
//! Facts of a wall clock are age, staleness and skipped ticks. This crate decides them and hands them to the tick as
//! input, so a recording of inputs is enough to run the session again.

#![cfg_attr(not(test), warn(clippy::print_stdout, clippy::print_stderr))]

pub mod capacity;
pub mod cases;
pub mod check;
pub mod cli;
mod commands;
#[cfg(feature = "console")]
mod console;
pub mod control_socket;
pub mod error;
mod exact;
pub mod net;
mod outlets;
pub mod plan;
mod recordings;
pub mod serve;
pub mod session;
pub mod state;
pub mod station;

pub use error::ServerError;
pub use net::feed::{FeedReport, serve_feed};
pub use net::identity::fingerprint;
pub use outlets::feed::{EncodedFrame, Feed, FeedPublisher, Latest, SessionFeed};
pub use outlets::hands::TrueDepth;
pub use session::detail::{Budget, Detail};
pub use session::handoff::Provoked;
#[doc(hidden)]
pub use session::stepped;
pub use station::config::{Exercise, ServerConfig, SessionPlan, StationConfig};
pub use station::handle::{Server, ServerHandle};
pub use sulcus_link::clock::monotonic_ns;
