//! What crosses the network between a station and its server: messages, version, codec.
//! No sockets, no files, no clock.
//!
//! A station holds one QUIC connection (ALPN [`ALPN`]). [`control`] messages travel on one
//! bidirectional stream opened by the client, each as a [`frame`]; poses go up and wrenches come
//! down as [datagrams](datagram) of fixed size, which may be lost, doubled and reordered
//! ([`newest`] sorts that out).
//!
//! # Units and frames
//! SI: metres, newtons, newton-metres; times in nanoseconds of the *sender's* monotonic clock. A
//! pose is `world_from_tool` at the tool's device point; force and torque are in world axes about
//! that point. Numbers are f32 on the wire and widened exactly.
//!
//! # Strictness
//! Decoding accepts exactly what encoding writes: wrong version, kind, length, flag bits or
//! trailing bytes are typed [`CodecError`]s. No input makes it panic.

pub mod codec;
pub mod control;
pub mod datagram;
pub mod frame;
pub mod learner;
pub mod limits;
pub mod newest;
pub mod status;
pub mod summary;
pub mod ticket;

pub use codec::CodecError;
pub use control::{ClientMessage, ServerMessage};
pub use datagram::{PoseDatagram, WrenchDatagram};
pub use newest::NewestWins;
pub use summary::{Percentiles, SessionSummary};
pub use ticket::Ticket;

/// Application protocol that both ends name in the TLS handshake.
pub const ALPN: &[u8] = b"sulcus/1";

/// Version of every message here; the first byte of each datagram and of each control frame.
pub const PROTOCOL_VERSION: u8 = 1;

/// Tool slots in every datagram: one for each hand.
pub const TOOLS: usize = 2;
