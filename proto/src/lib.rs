//! Network protocol between a client and its server: messages, version, codec.
//!
//! The crate has no sockets, no files and no clock. A client holds one QUIC connection (ALPN [`ALPN`]) with two kinds
//! of traffic:
//! - [`control`] messages travel on one bidirectional stream, opened by the client. Each message is a [`frame`].
//! - Poses go to the server and wrenches to the client as [datagrams](datagram) of fixed size. The network may lose,
//!   duplicate or reorder them; [`newest`] filters them by sequence number.
//!
//! # Units and frames
//! All quantities are in SI units: metres, newtons, newton-metres. Points in time are nanoseconds of the *client's*
//! monotonic clock; durations name their unit. A pose is `world_from_tool` at the tool's device point. Force and
//! torque are in world axes about that point. Poses and wrenches are f32 on the wire; widening to f64 is exact.
//!
//! # Strictness
//! Decoding accepts exactly the bytes that encoding writes. A wrong version, kind, length or flag byte and trailing
//! bytes are typed [`CodecError`]s. No input causes a panic.
//!
//! ```
//! use sulcus_proto::{ServerMessage, frame};
//!
//! let bytes = frame::encode(&ServerMessage::Epoch(7))?;
//! let message: ServerMessage = frame::decode(&bytes[frame::LENGTH_BYTES..])?;
//! assert_eq!(message, ServerMessage::Epoch(7));
//! # Ok::<(), sulcus_proto::CodecError>(())
//! ```

pub mod alert;
pub mod at_hand;
mod at_most_two;
pub mod codec;
pub mod control;
pub mod datagram;
pub mod device;
pub mod display;
pub mod frame;
pub mod ghost;
pub mod hex;
pub mod learner;
pub mod limits;
pub mod live;
pub mod newest;
pub mod permission;
pub mod reception;
pub mod role;
pub mod station;
pub mod status;
pub mod summary;
pub mod ticket;

pub use codec::CodecError;
pub use control::{ClientMessage, ServerMessage};
pub use datagram::{PoseDatagram, WrenchDatagram};
pub use newest::NewestWins;
pub use role::{Role, RoleError};
pub use summary::{Percentiles, SessionSummary};
pub use ticket::Ticket;

/// Application protocol (ALPN) of the TLS handshake, equal at both ends.
pub const ALPN: &[u8] = b"sulcus/1";

/// Version of every message: first byte of each datagram and of the body of each control frame.
pub const PROTOCOL_VERSION: u8 = 8;

/// Number of tool slots in every datagram: one slot per hand.
pub const TOOLS: usize = 2;
