//! TLS and QUIC settings of the client.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use quinn::crypto::rustls::QuicClientConfig;
use quinn::{ClientConfig, TransportConfig};
use sulcus_proto::{ALPN, limits};

use super::trust::Pinned;
use super::{LinkError, Pin};

/// TLS and QUIC configuration of a client. The link uses it, and tests that send messages by themselves.
///
/// The handshake sets `mismatch` if the server has another certificate than `pin`.
///
/// # Errors
/// TLS or QUIC cannot be configured. The cipher suites and the idle timeout of this program cause no error.
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
