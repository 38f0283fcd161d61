//! A connection to a server by any of its addresses. A name often has two, `::1` and `127.0.0.1`, and a server may
//! listen on one of them only.
//!
//! The attempts start one after the other, each 250 ms after the one before or at its failure (RFC 8305, "Happy
//! Eyeballs"). The first connection wins. The hello follows on that connection only, so a station sees one client.

use std::net::{Ipv4Addr, Ipv6Addr, SocketAddr};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use quinn::{Connection, ConnectionError, Endpoint, TransportErrorCode};
use tokio::task::JoinSet;

use super::{LinkConfig, LinkError, transport};
use sulcus_proto::Role;

/// Time from the start of one attempt to the start of the next (RFC 8305, section 5).
const HEAD_START: Duration = Duration::from_millis(250);

/// TLS alert `no_application_protocol`: the server offers another ALPN.
const NO_APPLICATION_PROTOCOL: u8 = 120;

/// Connects to the first address that answers with the pinned certificate.
///
/// # Errors
/// The error of the only address, or [`LinkError::Nowhere`] with those of all.
pub(crate) async fn reach(config: &LinkConfig) -> Result<(Endpoint, Connection), LinkError> {
    let servers = config.servers();
    let mut waiting = servers.iter().copied();
    let mut next = waiting.next();
    let mut tries = JoinSet::new();
    let mut failed: Vec<(SocketAddr, LinkError)> = Vec::new();
    loop {
        if let Some(server) = next.take() {
            let config = config.clone();
            tries.spawn(async move { (server, connect(&config, server).await) });
        }
        tokio::select! {
            tried = tries.join_next() => match tried {
                // The other attempts end with the set.
                Some(Ok((_, Ok(reached)))) => return Ok(reached),
                Some(Ok((server, Err(error)))) => {
                    failed.push((server, error));
                    next = waiting.next();
                }
                Some(Err(error)) => return Err(LinkError::System(error.to_string())),
                None => break,
            },
            () = tokio::time::sleep(HEAD_START), if waiting.len() > 0 => next = waiting.next(),
        }
    }
    failed.sort_by_key(|(server, _)| servers.iter().position(|other| other == server));
    Err(match <[_; 1]>::try_from(failed) {
        Ok([(_, only)]) => only,
        Err(failed) => LinkError::Nowhere(failed),
    })
}

/// Connects to one address, with a timeout of `config.timeout`.
async fn connect(
    config: &LinkConfig,
    server: SocketAddr,
) -> Result<(Endpoint, Connection), LinkError> {
    let mismatch = Arc::new(AtomicBool::new(false));
    let from: SocketAddr = match server {
        SocketAddr::V4(_) => (Ipv4Addr::UNSPECIFIED, 0).into(),
        SocketAddr::V6(_) => (Ipv6Addr::UNSPECIFIED, 0).into(),
    };
    let endpoint = Endpoint::client(from)?;
    let mut client = transport::client_config(config.pin.clone(), mismatch.clone())?;
    if config.role == Role::Display {
        client.transport_config(Arc::new(crate::display::transport()?));
    }
    let connecting = endpoint
        .connect_with(client, server, &config.server_name)
        .map_err(|error| LinkError::System(error.to_string()))?;
    let connection = tokio::time::timeout(config.timeout, connecting)
        .await
        .map_err(|_| LinkError::Absent { server })?
        .map_err(|error| {
            if mismatch.load(Ordering::Acquire) {
                LinkError::WrongCertificate { server }
            } else {
                explain(error, server)
            }
        })?;
    Ok((endpoint, connection))
}

fn explain(error: ConnectionError, server: SocketAddr) -> LinkError {
    match error {
        ConnectionError::TimedOut => LinkError::Absent { server },
        ConnectionError::VersionMismatch => {
            LinkError::Version("the server has another version of QUIC".into())
        }
        ConnectionError::ConnectionClosed(close)
            if close.error_code == TransportErrorCode::crypto(NO_APPLICATION_PROTOCOL) =>
        {
            LinkError::Version(
                "the server has another one; install the same release of client and server".into(),
            )
        }
        other => LinkError::lost(&other),
    }
}
