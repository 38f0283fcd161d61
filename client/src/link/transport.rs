//! QUIC tuned for 1 kHz datagrams: nothing queues, nothing probes, the newest packet goes out first.
//! The numbers and their reasons are in `sulcus_proto::limits`.

use std::any::Any;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use quinn::congestion::{Controller, ControllerFactory};
use quinn::crypto::rustls::QuicClientConfig;
use quinn::{ClientConfig, TransportConfig, VarInt};
use sulcus_proto::{ALPN, limits};

use super::trust::Pinned;
use super::{LinkError, Pin};

/// A congestion window that never changes. A cubic window falls to two packets after a little loss
/// or reordering, and a full *MTU* must fit before a 150-byte datagram may go.
#[derive(Clone, Debug)]
struct FixedWindow;

impl ControllerFactory for FixedWindow {
    fn build(self: Arc<Self>, _: Instant, _: u16) -> Box<dyn Controller> {
        Box::new(FixedWindow)
    }
}

impl Controller for FixedWindow {
    fn on_congestion_event(&mut self, _: Instant, _: Instant, _: bool, _: u64) {}
    fn on_mtu_update(&mut self, _: u16) {}
    fn window(&self) -> u64 {
        limits::WINDOW
    }
    fn clone_box(&self) -> Box<dyn Controller> {
        Box::new(FixedWindow)
    }
    fn initial_window(&self) -> u64 {
        limits::WINDOW
    }
    fn into_any(self: Box<Self>) -> Box<dyn Any> {
        self
    }
}

/// The client's half of a connection, for tools that speak the protocol by hand. `mismatch` is
/// raised when the server shows another certificate than the pinned one.
///
/// # Errors
/// If TLS cannot be set up (never with the cipher suites this program is built with).
pub fn client_config(pin: Pin, mismatch: Arc<AtomicBool>) -> Result<ClientConfig, LinkError> {
    let tls_error = |error: &dyn std::fmt::Display| LinkError::System(error.to_string());
    let provider = Arc::new(rustls::crypto::ring::default_provider());
    let mut tls = rustls::ClientConfig::builder_with_provider(provider.clone())
        .with_protocol_versions(&[&rustls::version::TLS13])
        .map_err(|error| tls_error(&error))?
        .dangerous()
        .with_custom_certificate_verifier(Arc::new(Pinned::new(pin, provider, mismatch)))
        .with_no_client_auth();
    tls.alpn_protocols = vec![ALPN.to_vec()];
    let crypto = QuicClientConfig::try_from(tls).map_err(|error| tls_error(&error))?;
    let mut config = ClientConfig::new(Arc::new(crypto));
    config.transport_config(Arc::new(transport()?));
    Ok(config)
}

fn transport() -> Result<TransportConfig, LinkError> {
    let idle = limits::IDLE
        .try_into()
        .map_err(|_| LinkError::System("idle time is too long".into()))?;
    let mut transport = TransportConfig::default();
    transport
        .datagram_send_buffer_size(limits::POSE_SEND_BUFFER)
        .datagram_receive_buffer_size(Some(limits::DATAGRAM_RECEIVE_BUFFER))
        .congestion_controller_factory(Arc::new(FixedWindow))
        .mtu_discovery_config(None)
        .initial_mtu(limits::MTU)
        .enable_segmentation_offload(false)
        .initial_rtt(limits::INITIAL_RTT)
        .keep_alive_interval(Some(limits::KEEP_ALIVE))
        .max_idle_timeout(Some(idle))
        // A server opens no streams.
        .max_concurrent_bidi_streams(VarInt::from_u32(0))
        .max_concurrent_uni_streams(VarInt::from_u32(0));
    Ok(transport)
}
