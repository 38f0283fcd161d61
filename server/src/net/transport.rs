//! TLS and QUIC settings of the server.

use std::sync::Arc;

use quinn::crypto::rustls::QuicServerConfig;
use quinn::{ServerConfig, TransportConfig, VarInt};
use sulcus_proto::{ALPN, limits};

use crate::ServerError;
use crate::net::identity::Identity;

/// TLS and QUIC configuration of the server: TLS 1.3, the protocol's ALPN, no client certificate.
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
    let mut transport = sulcus_link::quic::transport(limits::WRENCH_SEND_BUFFER)
        .map_err(|error| ServerError::Tls(error.to_string()))?;
    let window = VarInt::from_u32(2 * limits::CONTROL_BYTES as u32);
    transport
        // The client opens one control stream; its window holds two messages of the largest size.
        .max_concurrent_bidi_streams(VarInt::from_u32(1))
        // One stream of inputs, if the ticks run at the hand.
        .max_concurrent_uni_streams(VarInt::from_u32(1))
        .stream_receive_window(window)
        .receive_window(window);
    Ok(transport)
}
