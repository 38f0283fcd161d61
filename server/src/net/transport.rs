//! QUIC tuned for 1 kHz datagrams: nothing queues, nothing probes, the newest packet goes out first.
//! The numbers and their reasons are in `sulcus_proto::limits`.

use std::any::Any;
use std::sync::Arc;
use std::time::Instant;

use quinn::congestion::{Controller, ControllerFactory};
use quinn::crypto::rustls::QuicServerConfig;
use quinn::{ServerConfig, TransportConfig, VarInt};
use sulcus_proto::{ALPN, limits};

use crate::ServerError;
use crate::net::identity::Identity;

/// A congestion window that never changes. A cubic window falls to two packets after a little loss
/// or reordering, and a full *MTU* must fit before a 300-byte datagram may go.
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

/// The server's half of the connection.
pub(crate) fn server_config(identity: &Identity) -> Result<ServerConfig, ServerError> {
    let tls_error = |error: &dyn std::fmt::Display| ServerError::Tls(error.to_string());
    let provider = Arc::new(rustls::crypto::ring::default_provider());
    let mut tls = rustls::ServerConfig::builder_with_provider(provider)
        .with_protocol_versions(&[&rustls::version::TLS13])
        .map_err(|error| tls_error(&error))?
        .with_no_client_auth()
        .with_single_cert(vec![identity.certificate.clone()], identity.key.clone_key())
        .map_err(|error| tls_error(&error))?;
    tls.alpn_protocols = vec![ALPN.to_vec()];
    let crypto = QuicServerConfig::try_from(tls).map_err(|error| tls_error(&error))?;
    let mut config = ServerConfig::with_crypto(Arc::new(crypto));
    config.transport_config(Arc::new(transport()?));
    Ok(config)
}

fn transport() -> Result<TransportConfig, ServerError> {
    let idle = limits::IDLE
        .try_into()
        .map_err(|_| ServerError::Tls("idle time is too long".into()))?;
    let mut transport = TransportConfig::default();
    transport
        .datagram_send_buffer_size(limits::WRENCH_SEND_BUFFER)
        .datagram_receive_buffer_size(Some(limits::DATAGRAM_RECEIVE_BUFFER))
        .congestion_controller_factory(Arc::new(FixedWindow))
        .mtu_discovery_config(None)
        .initial_mtu(limits::MTU)
        .enable_segmentation_offload(false)
        .initial_rtt(limits::INITIAL_RTT)
        .max_idle_timeout(Some(idle))
        // One control stream, opened by the client; its window holds one message.
        .max_concurrent_bidi_streams(VarInt::from_u32(1))
        .max_concurrent_uni_streams(VarInt::from_u32(0))
        .stream_receive_window(VarInt::from_u32(2 * limits::CONTROL_BYTES as u32))
        .receive_window(VarInt::from_u32(2 * limits::CONTROL_BYTES as u32));
    Ok(transport)
}
