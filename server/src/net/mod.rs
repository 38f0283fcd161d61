//! The network thread: endpoint, first messages, one task for each connection and one for each station.

pub(crate) mod addresses;
pub mod codes;
mod control;
pub(crate) mod datagrams;
mod display;
pub mod feed;
pub(crate) mod greeting;
pub(crate) mod hello;
pub(crate) mod identity;
mod inputs;
mod instructor;
mod rate;
mod student;
pub mod tokens;
pub(crate) mod transport;

use std::net::SocketAddr;
use std::panic::AssertUnwindSafe;
use std::pin::pin;
use std::sync::{Arc, OnceLock};
use std::task::Poll;
use std::time::Duration;

use quinn::{Connection, Endpoint, EndpointConfig, TokioRuntime, VarInt};
use sulcus_proto::SessionSummary;
use sulcus_proto::control::EndReason;
use sulcus_proto::limits::HELLO;
use tokio::sync::mpsc::UnboundedReceiver;
use tokio::task::JoinSet;

use crate::ServerError;
use crate::station::actor::Station;
use crate::station::config::StationConfig;
use crate::station::door::{Behind, Door};
use crate::station::shared::Shared;

/// Stage in the life of the whole server.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Stage {
    /// Accept connections and run sessions.
    Serve,
    /// End the running sessions with goodbyes, then close.
    Shutdown,
    /// Close at once without a goodbye. The recordings are still finished.
    Halt,
}

/// Data of the network thread that all connections share.
pub(crate) struct Net {
    pub shared: Arc<Shared>,
    /// Doors of all stations, in the order of the configuration.
    pub doors: Vec<Door>,
    /// Hash of the tick self-test.
    pub self_test: u64,
    /// Address of the console, if it offers clients for download.
    pub clients: Arc<OnceLock<SocketAddr>>,
}

/// Application code of a close after a goodbye, or at the end of the server.
const CLOSE_OK: VarInt = VarInt::from_u32(0);
/// Application code of a refusal.
const CLOSE_REFUSED: VarInt = VarInt::from_u32(1);
/// Timeout for a client to read the last message and to close the connection.
const LAST_WORD: Duration = Duration::from_secs(2);
/// Timeout for all connections to end by themselves at the end of the server.
///
/// The time covers two control messages that are not taken, the last message, and the end of the recording.
const FAREWELL: Duration = Duration::from_secs(10);
/// Further time for a recording on a slow disk.
const FINISHING: Duration = Duration::from_secs(20);
/// Largest number of connections served at once, refused clients included: student, display and instructor at each of
/// 64 stations, and as many again.
const CONNECTIONS: usize = 384;
/// Number of connections from which a new client must prove its address first. Senders with false addresses must not
/// take all slots.
const CROWD: usize = CONNECTIONS / 2;
/// Largest length of an error in a log line, characters. The error may quote a peer.
const ERROR_CHARACTERS: usize = 256;

/// Serves until the stage is no longer [`Stage::Serve`]. Returns the summaries of the sessions, in the order of their
/// ends.
pub(crate) async fn serve(
    socket: std::net::UdpSocket,
    quic: quinn::ServerConfig,
    mut renewed: UnboundedReceiver<quinn::ServerConfig>,
    metrics: Option<std::net::TcpListener>,
    net: Arc<Net>,
    stations: Vec<(StationConfig, Door, Behind)>,
) -> Result<Vec<SessionSummary>, ServerError> {
    let shared = net.shared.clone();
    let endpoint = Endpoint::new(
        EndpointConfig::default(),
        Some(quic),
        socket,
        Arc::new(TokioRuntime),
    )?;
    let mut stage = shared.stage.clone();
    let mut outlets = JoinSet::new();
    if let Some(listener) = metrics {
        let listener = tokio::net::TcpListener::from_std(listener)?;
        outlets.spawn(crate::outlets::metrics::serve(listener, net.doors.clone()));
    }
    if let Some(quota) = shared.quota.clone() {
        outlets.spawn(crate::station::quota::watch(quota));
    }
    let mut actors = JoinSet::new();
    for (number, (config, door, behind)) in stations.into_iter().enumerate() {
        actors.spawn(station(number, config, door, behind, shared.clone()));
    }
    let mut connections = JoinSet::new();
    while *stage.borrow_and_update() == Stage::Serve {
        tokio::select! {
            _ = stage.changed() => {}
            Some(_) = connections.join_next() => {}
            Some(quic) = renewed.recv() => endpoint.set_server_config(Some(quic)),
            incoming = endpoint.accept() => match incoming {
                Some(incoming) => match answer(connections.len(), incoming.remote_address_validated()) {
                    Answer::Serve => {
                        connections.spawn(connection(incoming, net.clone()));
                    }
                    // An error means a validated address, which `answer` excludes.
                    Answer::Retry => drop(incoming.retry()),
                    Answer::Refuse => incoming.refuse(),
                },
                None => break,
            },
        }
    }
    // Stations read the stage too; each finishes its recording before its task ends.
    let halted = *stage.borrow() == Stage::Halt;
    if halted {
        endpoint.close(CLOSE_OK, b"server stopped");
    }
    let stopped = all_ended(
        &mut actors,
        if halted {
            FINISHING
        } else {
            FAREWELL + FINISHING
        },
    )
    .await;
    if !halted {
        all_ended(&mut connections, FAREWELL).await;
    }
    // Nothing waits for a client from here on.
    endpoint.close(CLOSE_OK, b"server stopped");
    connections.shutdown().await;
    // Time for the last packets; lost clients do not extend it.
    let _ = tokio::time::timeout(LAST_WORD, endpoint.wait_idle()).await;
    let mut summaries = shared.take_summaries();
    if !stopped {
        tracing::error!(
            "a session did not end in time; its recording may lack the end: complete it with `sulcus-sessions info --recover`"
        );
        summaries.push(SessionSummary::empty(EndReason::Recording));
    }
    Ok(summaries)
}

/// Runs a station until the end of the server. After a panic of its task the station begins anew: its session's threads
/// end, and the recording has no end. Other stations go on.
async fn station(
    number: usize,
    config: StationConfig,
    door: Door,
    behind: Behind,
    shared: Arc<Shared>,
) {
    let mut behind = Some(behind);
    loop {
        let Some(ends) = behind.take() else { return };
        let plan = config.plan.clone();
        let mut station = Station::new(shared.clone(), number, door.clone(), ends, plan);
        if !panics(station.run()).await {
            return;
        }
        tracing::error!(
            "station {}: its task ended unexpectedly; its session is lost, and a new one can begin",
            door.name
        );
        shared.ended(SessionSummary {
            station: door.name.to_string(),
            ..SessionSummary::empty(EndReason::Simulation)
        });
        behind = Some(station.into_behind());
    }
}

/// Runs a future to its end. `true`: it has panicked.
async fn panics(future: impl Future<Output = ()>) -> bool {
    let mut future = pin!(future);
    std::future::poll_fn(move |context| {
        let poll = AssertUnwindSafe(|| future.as_mut().poll(context));
        match std::panic::catch_unwind(poll) {
            Ok(Poll::Pending) => Poll::Pending,
            Ok(Poll::Ready(())) => Poll::Ready(false),
            Err(_) => Poll::Ready(true),
        }
    })
    .await
}

/// Answer to the first packet of a client.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Answer {
    Serve,
    /// A QUIC Retry packet: only the true owner of the address receives its token. A retry takes no slot.
    Retry,
    Refuse,
}

fn answer(served: usize, proven: bool) -> Answer {
    if served >= CONNECTIONS {
        Answer::Refuse
    } else if served >= CROWD && !proven {
        Answer::Retry
    } else {
        Answer::Serve
    }
}

/// Waits at most `limit` for the end of all connections. `false`: timeout.
async fn all_ended(connections: &mut JoinSet<()>, limit: Duration) -> bool {
    let all = async { while connections.join_next().await.is_some() {} };
    tokio::time::timeout(limit, all).await.is_ok()
}

async fn connection(incoming: quinn::Incoming, net: Arc<Net>) {
    let from = incoming.remote_address();
    match tokio::time::timeout(HELLO, incoming).await {
        Ok(Ok(connection)) => hello::admit(connection, net).await,
        Ok(Err(error)) => {
            let why = hello::printable(&error.to_string(), ERROR_CHARACTERS);
            tracing::info!("connection from {from} failed: {why}");
        }
        Err(_) => tracing::info!(
            "connection from {from} failed: no handshake within {} s",
            HELLO.as_secs()
        ),
    }
}

/// Waits at most [`LAST_WORD`] for the client's close, then closes. A client closes after the last message.
async fn close_after_last_word(connection: &Connection, code: VarInt, why: &[u8]) {
    let _ = tokio::time::timeout(LAST_WORD, connection.closed()).await;
    connection.close(code, why);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spoofed_addresses_take_half_of_the_slots_at_most() {
        assert_eq!(answer(0, false), Answer::Serve);
        assert_eq!(answer(CROWD - 1, false), Answer::Serve);
        assert_eq!(answer(CROWD, false), Answer::Retry);
        assert_eq!(answer(CROWD, true), Answer::Serve);
        assert_eq!(answer(CONNECTIONS - 1, true), Answer::Serve);
        assert_eq!(answer(CONNECTIONS, true), Answer::Refuse);
        assert_eq!(answer(CONNECTIONS, false), Answer::Refuse);
    }

    #[test]
    fn a_peers_reason_with_newlines_stays_on_its_log_line() {
        let why = hello::printable("aborted: \r\n\u{1b}[2Jit is fine", ERROR_CHARACTERS);
        assert_eq!(why, "aborted: [2Jit is fine");
        let long = hello::printable(&"x".repeat(10_000), ERROR_CHARACTERS);
        assert_eq!(long.len(), ERROR_CHARACTERS);
    }
}
