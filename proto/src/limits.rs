//! Numbers that both ends of a connection must agree on or should share: time limits, buffers,
//! window. Congestion control and send buffers act on the sender, so each end sets its own.

use std::time::Duration;

use crate::datagram::{PoseDatagram, WrenchDatagram};

/// What quinn counts per queued datagram beside its payload (`size_of::<Datagram>()`: one `Bytes`).
const QUEUE_OVERHEAD: usize = 32;

/// Send buffer of a station, bytes: four poses. The default (1 MiB) holds seconds of stale ones; a
/// full buffer drops its oldest, which is what newest-wins wants.
pub const POSE_SEND_BUFFER: usize = 4 * (PoseDatagram::BYTES + QUEUE_OVERHEAD);
/// Send buffer of a server, bytes: four wrenches.
pub const WRENCH_SEND_BUFFER: usize = 4 * (WrenchDatagram::BYTES + QUEUE_OVERHEAD);
/// Receive buffer of both, bytes: a stalled reader must not wake to seconds of history.
pub const DATAGRAM_RECEIVE_BUFFER: usize = 16 * 1024;

/// Fixed congestion window, bytes: about a second of datagrams at 1 kHz, so that an outage shorter
/// than that does not block the first packets after it. The connection carries nothing but
/// datagrams and a few control frames.
pub const WINDOW: u64 = 256 * 1024;
/// Packet size, no discovery: payloads are far smaller.
pub const MTU: u16 = 1200;
/// Round trip assumed before one is measured (a LAN): RFC 9002's 333 ms makes the loss of a first
/// packet cost a second.
pub const INITIAL_RTT: Duration = Duration::from_millis(50);
/// A station's keep-alive; only matters while it sends nothing.
pub const KEEP_ALIVE: Duration = Duration::from_millis(500);
/// Silence after which a connection is lost.
pub const IDLE: Duration = Duration::from_secs(3);

/// Age of the newest pose at which the server calls it stale: force ramps to zero.
pub const POSE_STALE: Duration = Duration::from_millis(50);
/// Silence after which a station takes its own force to zero.
pub const WRENCH_SILENT: Duration = Duration::from_millis(20);

/// Largest control message, bytes, without its length.
pub const CONTROL_BYTES: usize = 64 * 1024;
/// Longest name (program version, device, learner, exercise, token) in a hello, bytes.
pub const NAME_BYTES: usize = 256;
/// Time a station has from its first packet to its hello.
pub const HELLO: Duration = Duration::from_secs(5);
