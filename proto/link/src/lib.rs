//! Code that both ends of a connection share, and their real-time threads.
//!
//! - [`quic`]: transport settings
//! - [`bulk`]: transport settings of a connection for displays
//! - [`control`]: framed control stream
//! - [`ladder`]: rate of datagrams by the quality of the path
//! - [`Bell`]: wake-up of a network thread
//! - [`clock`]: monotonic clock and absolute sleep
//! - [`mod@schedule`]: real-time scheduling
//! - [`Times`]: histogram of times
//!
//! The messages are in `sulcus-proto`. Connections, roles and sessions belong to server and client. Begin at
//! [`quic::transport`].

pub mod bell;
pub mod bulk;
pub mod clock;
pub mod control;
pub mod ladder;
pub mod quic;
pub mod schedule;
pub mod times;

pub use bell::Bell;
pub use times::Times;
