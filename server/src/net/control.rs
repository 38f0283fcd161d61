//! Writing side of the control stream.

use std::time::Duration;

use quinn::{SendStream, VarInt};
use sulcus_proto::{CodecError, ServerMessage, frame};

/// Timeout for a client to take one control message.
///
/// Without the timeout a client that grants no stream window would hold the station as long as its connection lives.
const WRITE: Duration = Duration::from_secs(2);
/// Application code of a control stream that the server resets after a timeout.
const GIVEN_UP: VarInt = VarInt::from_u32(1);

/// Writes one message. `false`: encoding failed, the connection is lost, or the client did not take the message within
/// [`WRITE`]. After a timeout the stream is reset, and every later write fails.
pub(super) async fn write(stream: &mut SendStream, message: &ServerMessage) -> bool {
    write_frame(stream, frame::encode(message)).await
}

/// Writes the frame of one message, as [`write`] does.
pub(super) async fn write_frame(
    stream: &mut SendStream,
    frame: Result<Vec<u8>, CodecError>,
) -> bool {
    let bytes = match frame {
        Ok(bytes) => bytes,
        Err(error) => {
            tracing::error!("cannot encode a control message: {error}");
            return false;
        }
    };
    match tokio::time::timeout(WRITE, stream.write_all(&bytes)).await {
        Ok(written) => written.is_ok(),
        Err(_) => {
            tracing::warn!(
                "the client took no control message for {} s; the control stream is closed",
                WRITE.as_secs()
            );
            // A part of the message may have been sent: a later message must fail at once, not follow that part.
            let _ = stream.reset(GIVEN_UP);
            false
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;
    use std::time::Instant;

    use quinn::crypto::rustls::QuicClientConfig;
    use quinn::{ClientConfig, Endpoint, TransportConfig};
    use sulcus_proto::ALPN;

    use super::*;
    use crate::net::identity::Identity;
    use crate::net::transport;

    /// Configuration of a client that keeps its connection alive but takes no byte of any stream.
    fn deaf(identity: &Identity) -> ClientConfig {
        let mut roots = rustls::RootCertStore::empty();
        roots.add(identity.certificate.clone()).expect("a root");
        let provider = Arc::new(rustls::crypto::ring::default_provider());
        let mut tls = rustls::ClientConfig::builder_with_provider(provider)
            .with_protocol_versions(&[&rustls::version::TLS13])
            .expect("TLS 1.3")
            .with_root_certificates(roots)
            .with_no_client_auth();
        tls.alpn_protocols = vec![ALPN.to_vec()];
        let crypto = QuicClientConfig::try_from(tls).expect("QUIC");
        let mut transport = TransportConfig::default();
        transport
            .stream_receive_window(VarInt::from_u32(0))
            .max_idle_timeout(None)
            .keep_alive_interval(Some(Duration::from_millis(500)));
        let mut config = ClientConfig::new(Arc::new(crypto));
        config.transport_config(Arc::new(transport));
        config
    }

    #[test]
    fn a_client_without_a_window_does_not_hold_a_write() {
        let runtime = tokio::runtime::Builder::new_current_thread()
            .enable_all()
            .build()
            .expect("runtime");
        runtime.block_on(async {
            let identity = Identity::generate("localhost").expect("identity");
            let any = ([127, 0, 0, 1], 0).into();
            let mut server = transport::server_config(&identity).expect("config");
            // A connection that ends in a stall of the machine would end the write too.
            let of_server = Arc::get_mut(&mut server.transport).expect("one owner");
            of_server.max_idle_timeout(None);
            let server = Endpoint::server(server, any).expect("server");
            let address = server.local_addr().expect("address");
            let client = Endpoint::client(any).expect("client");
            let connecting = client
                .connect_with(deaf(&identity), address, "localhost")
                .expect("connecting");
            let (theirs, ours) = tokio::join!(async { connecting.await.expect("joins") }, async {
                server
                    .accept()
                    .await
                    .expect("someone")
                    .await
                    .expect("joins")
            });
            let (mut asks, _hears) = theirs.open_bi().await.expect("a stream");
            asks.write_all(b"x").await.expect("written");
            let (mut send, _recv) = ours.accept_bi().await.expect("a stream");

            let message = ServerMessage::Epoch(1);
            let begun = Instant::now();
            assert!(!write(&mut send, &message).await);
            let first = begun.elapsed();
            assert!(first >= WRITE, "{first:?}");
            // A goodbye after that fails at its first poll: a timeout of zero polls once.
            let goodbye = tokio::time::timeout(Duration::ZERO, write(&mut send, &message)).await;
            assert_eq!(goodbye, Ok(false));
            assert!(
                ours.close_reason().is_none(),
                "only the stream was given up"
            );
        });
    }
}
