//! Constants shared by both ends of a connection: timeouts, buffer sizes, congestion window.
//!
//! Congestion control and send buffers act on the sender, so each end configures its own.

use std::time::Duration;

use crate::datagram::{PoseDatagram, WrenchDatagram};

/// Overhead that quinn counts per queued datagram, bytes: `size_of::<Datagram>()`, a single `Bytes`.
const QUEUE_OVERHEAD: usize = 32;

/// Send buffer of a client, bytes: four poses.
///
/// quinn's default (1 MiB) would hold seconds of stale poses. A full buffer drops its oldest datagram, as newest-wins
/// requires.
pub const POSE_SEND_BUFFER: usize = 4 * (PoseDatagram::BYTES + QUEUE_OVERHEAD);
/// Send buffer of a server, bytes: four wrenches.
pub const WRENCH_SEND_BUFFER: usize = 4 * (WrenchDatagram::BYTES + QUEUE_OVERHEAD);
/// Receive buffer of both ends, bytes. The limit keeps a stalled reader from a backlog of seconds.
pub const DATAGRAM_RECEIVE_BUFFER: usize = 16 * 1024;

/// Fixed congestion window, bytes: about a second of datagrams at 1 kHz.
///
/// A shorter outage then does not block the first packets after the outage. A fixed window suffices, because the
/// connection carries only datagrams and a few control frames.
pub const WINDOW: u64 = 256 * 1024;
/// Packet size, bytes, without MTU discovery: payloads are far smaller.
pub const MTU: u16 = 1200;
/// Round-trip time assumed before the first measurement, for a LAN.
///
/// With the 333 ms of RFC 9002, the loss of a first packet costs a second.
pub const INITIAL_RTT: Duration = Duration::from_millis(50);
/// Keep-alive interval of a client; takes effect only while the client sends nothing.
pub const KEEP_ALIVE: Duration = Duration::from_millis(500);
/// Idle timeout: silence after which a connection is lost.
pub const IDLE: Duration = Duration::from_secs(3);

/// Age at which the newest pose is stale at the server. Force then ramps to zero.
pub const POSE_STALE: Duration = Duration::from_millis(50);
/// Silence of the server after which a client ramps its own force to zero.
pub const WRENCH_SILENT: Duration = Duration::from_millis(20);

/// Largest body of a control frame, bytes, without the length field.
pub const CONTROL_BYTES: usize = 64 * 1024;
/// Largest length of each string in a client's hello, bytes: program version, token, texts of a device, learner,
/// exercise.
pub const NAME_BYTES: usize = 256;
/// Largest length of a text from an instructor, bytes: note, message, plan.
pub const TEXT_BYTES: usize = 16 * 1024;
/// Timeout from the first packet of a client to its hello.
pub const HELLO: Duration = Duration::from_secs(5);
