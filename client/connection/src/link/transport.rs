//! TLS and QUIC settings of the client.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use quinn::crypto::rustls::QuicClientConfig;
use quinn::{ClientConfig, TransportConfig};
use sulcus_proto::{ALPN, limits};

use super::trust::Pinned;
use super::{LinkError, Pin};

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
    let mut transport = sulcus_link::quic::transport(limits::POSE_SEND_BUFFER)
        .map_err(|error| LinkError::System(error.to_string()))?;
    transport.keep_alive_interval(Some(limits::KEEP_ALIVE));
    Ok(transport)
}
