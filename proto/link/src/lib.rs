//! Code that both ends of a connection share, and their real-time threads.
//!
//! [`quic`] holds the transport settings, [`control`] the framed control stream, [`Bell`] the wake-up of a network thread,
//! [`clock`] the monotonic clock and the absolute sleep, [`schedule`] SCHED_FIFO. Messages are `sulcus-proto`'s; connections,
//! roles and sessions belong to server and client. Begin at [`quic::transport`].

pub mod bell;
pub mod clock;
pub mod control;
pub mod quic;
pub mod schedule;

pub use bell::Bell;
