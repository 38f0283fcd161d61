//! QUIC settings of a connection for displays: streams in one direction, and a small window.
//!
//! Scene and frames go beside the haptic connection, through the same network queue. A window of 32 KiB held this queue
//! under 14 ms on a link of 20 Mbit/s; a window that grows filled it with 180 ms.

use quinn::{TransportConfig, VarInt};
use sulcus_proto::display;

use crate::quic;

/// Congestion window of the sender, and receive window of a display, bytes.
pub const WINDOW: u64 = 32 * 1024;
/// Send buffer of a connection, bytes. Frames are copied into it; a scene passes through.
pub const SEND_BUFFER: u64 = 256 * 1024;
/// Streams that a display grants at once: a scene and frames under way.
pub const STREAMS: u32 = 16;

/// Returns the settings of the server's end. The client opens one control stream.
///
/// # Errors
/// The idle timeout is beyond QUIC's range.
pub fn of_server() -> Result<TransportConfig, quinn::VarIntBoundsExceeded> {
    let mut transport = quic::transport_with_window(0, WINDOW)?;
    transport
        .datagram_receive_buffer_size(None)
        .max_concurrent_bidi_streams(VarInt::from_u32(1))
        .send_window(SEND_BUFFER);
    Ok(transport)
}

/// Returns the settings of a display's end.
///
/// The receive window limits the server's bytes under way also if the server's congestion window is larger. A frame of
/// the largest size passes through it in pieces.
///
/// # Errors
/// The idle timeout is beyond QUIC's range.
pub fn of_display() -> Result<TransportConfig, quinn::VarIntBoundsExceeded> {
    let mut transport = quic::transport_with_window(0, WINDOW)?;
    let window = VarInt::from_u32(WINDOW as u32);
    transport
        .datagram_receive_buffer_size(None)
        .max_concurrent_uni_streams(VarInt::from_u32(STREAMS))
        .stream_receive_window(window)
        .receive_window(window);
    Ok(transport)
}

const _: () = assert!(display::FRAME_BYTES <= SEND_BUFFER as usize);
