//! QUIC settings for datagrams at 1 kHz: no queue, no probing, the newest packet first.
//!
//! The numbers and their reasons are in [`sulcus_proto::limits`].

use std::any::Any;
use std::sync::Arc;
use std::time::Instant;

use quinn::congestion::{Controller, ControllerFactory};
use quinn::{IdleTimeout, TransportConfig, VarInt};
use sulcus_proto::limits;

/// A constant congestion window. A cubic window falls to two packets after a little loss or reordering. A full *MTU*
/// must fit before a datagram of 150 to 300 bytes may go.
#[derive(Clone, Debug)]
struct FixedWindow(u64);

impl ControllerFactory for FixedWindow {
    fn build(self: Arc<Self>, _: Instant, _: u16) -> Box<dyn Controller> {
        Box::new(self.as_ref().clone())
    }
}

impl Controller for FixedWindow {
    fn on_congestion_event(&mut self, _: Instant, _: Instant, _: bool, _: u64) {}
    fn on_mtu_update(&mut self, _: u16) {}
    fn window(&self) -> u64 {
        self.0
    }
    fn clone_box(&self) -> Box<dyn Controller> {
        Box::new(self.clone())
    }
    fn initial_window(&self) -> u64 {
        self.0
    }
    fn into_any(self: Box<Self>) -> Box<dyn Any> {
        self
    }
}

/// Returns the transport settings of both ends. `send_buffer` is the capacity for outgoing datagrams, bytes.
///
/// Neither end may open a stream; the server adds the one control stream of the client.
///
/// # Errors
/// [`limits::IDLE`] is beyond the range of QUIC's idle timeout.
pub fn transport(send_buffer: usize) -> Result<TransportConfig, quinn::VarIntBoundsExceeded> {
    transport_with_window(send_buffer, limits::WINDOW)
}

/// Returns the same settings with another congestion window, bytes.
///
/// # Errors
/// [`limits::IDLE`] is beyond the range of QUIC's idle timeout.
pub fn transport_with_window(
    send_buffer: usize,
    window: u64,
) -> Result<TransportConfig, quinn::VarIntBoundsExceeded> {
    let idle = IdleTimeout::try_from(limits::IDLE)?;
    let mut transport = TransportConfig::default();
    transport
        .datagram_send_buffer_size(send_buffer)
        .datagram_receive_buffer_size(Some(limits::DATAGRAM_RECEIVE_BUFFER))
        .congestion_controller_factory(Arc::new(FixedWindow(window)))
        .mtu_discovery_config(None)
        .initial_mtu(limits::MTU)
        .enable_segmentation_offload(false)
        .initial_rtt(limits::INITIAL_RTT)
        .max_idle_timeout(Some(idle))
        .max_concurrent_bidi_streams(VarInt::from_u32(0))
        .max_concurrent_uni_streams(VarInt::from_u32(0));
    Ok(transport)
}
