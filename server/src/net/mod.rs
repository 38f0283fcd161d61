//! The network thread: endpoint, admission, and one station's session at a time.

pub(crate) mod addresses;
mod admission;
mod control;
mod datagrams;
pub mod feed;
pub(crate) mod identity;
mod session;
pub(crate) mod transport;

use std::sync::Arc;
use std::time::Duration;

use quinn::{Connection, Endpoint, EndpointConfig, TokioRuntime, VarInt};
use sulcus_proto::SessionSummary;
use sulcus_proto::control::EndReason;
use sulcus_proto::limits::HELLO;
use tokio::sync::{Mutex, watch};
use tokio::task::JoinSet;

use crate::session::levels::Levels;
use crate::{ServerConfig, ServerError};

/// Phase of the whole server.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Phase {
    /// Accept connections and run sessions.
    Serve,
    /// End the running session with a goodbye, then close.
    Shutdown,
    /// Close at once without a goodbye. The recording is still finished.
    Halt,
}

/// Data shared by all connections.
pub(crate) struct Shared {
    pub config: ServerConfig,
    pub scene_hash: [u8; 32],
    pub phase: watch::Receiver<Phase>,
    /// Pause and force limit of the station's side.
    pub levels: Levels,
    /// Number of pauses that the station's side has lifted. Each change begins a new epoch.
    pub lifted: watch::Receiver<u64>,
    /// State of the station, locked by the client that uses it. A client that finds it locked is refused as busy.
    pub station: Arc<Mutex<Station>>,
}

/// State of the station from session to session.
pub(crate) struct Station {
    /// Newest epoch; every accepted client and every resume takes the next one.
    pub epoch: u32,
    /// Summaries of the sessions so far, oldest first.
    pub summaries: Vec<SessionSummary>,
}

impl Station {
    /// Takes the next epoch. After the largest number comes 1; 0 is never used.
    pub fn next_epoch(&mut self) -> u32 {
        self.epoch = self.epoch.wrapping_add(1).max(1);
        self.epoch
    }
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
/// Largest number of connections served at once, refused clients included.
const CONNECTIONS: usize = 64;
/// Number of connections from which a new client must prove its address first. Senders with false addresses must not
/// take all slots.
const CROWD: usize = CONNECTIONS / 2;
/// Largest length of an error in a log line, characters. The error may quote a peer.
const ERROR_CHARACTERS: usize = 256;

/// Serves until the phase is no longer [`Phase::Serve`]. Returns the summaries of the sessions, oldest first.
pub(crate) async fn serve(
    socket: std::net::UdpSocket,
    quic: quinn::ServerConfig,
    shared: Arc<Shared>,
) -> Result<Vec<SessionSummary>, ServerError> {
    let endpoint = Endpoint::new(
        EndpointConfig::default(),
        Some(quic),
        socket,
        Arc::new(TokioRuntime),
    )?;
    let mut phase = shared.phase.clone();
    let mut connections = JoinSet::new();
    while *phase.borrow_and_update() == Phase::Serve {
        tokio::select! {
            _ = phase.changed() => {}
            Some(_) = connections.join_next() => {}
            incoming = endpoint.accept() => match incoming {
                Some(incoming) => match answer(connections.len(), incoming.remote_address_validated()) {
                    Answer::Serve => {
                        connections.spawn(connection(incoming, shared.clone()));
                    }
                    // An error means a validated address, which `answer` excludes.
                    Answer::Retry => drop(incoming.retry()),
                    Answer::Refuse => incoming.refuse(),
                },
                None => break,
            },
        }
    }
    // Sessions read the phase too; each finishes its recording before its task ends.
    let halted = *phase.borrow() == Phase::Halt;
    let ended = !halted && all_ended(&mut connections, FAREWELL).await;
    // Nothing waits for a client from here on.
    endpoint.close(CLOSE_OK, b"server stopped");
    let unfinished = !ended
        && !all_ended(&mut connections, FINISHING).await
        // Only a session holds the lock that long.
        && shared.station.try_lock().is_err();
    connections.shutdown().await;
    // Time for the last packets; lost clients do not extend it.
    let _ = tokio::time::timeout(LAST_WORD, endpoint.wait_idle()).await;
    let mut station = shared.station.lock().await;
    if unfinished {
        tracing::error!(
            "the session did not end in time; its recording may lack the end: complete it with `sulcus-sessions info --recover`"
        );
        let summary = SessionSummary::empty(EndReason::Recording);
        station.summaries.push(summary);
    }
    Ok(std::mem::take(&mut station.summaries))
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

async fn connection(incoming: quinn::Incoming, shared: Arc<Shared>) {
    let from = incoming.remote_address();
    match tokio::time::timeout(HELLO, incoming).await {
        Ok(Ok(connection)) => admission::admit(connection, shared).await,
        Ok(Err(error)) => {
            let why = admission::printable(&error.to_string(), ERROR_CHARACTERS);
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
        let why = admission::printable("aborted: \r\n\u{1b}[2Jit is fine", ERROR_CHARACTERS);
        assert_eq!(why, "aborted: [2Jit is fine");
        let long = admission::printable(&"x".repeat(10_000), ERROR_CHARACTERS);
        assert_eq!(long.len(), ERROR_CHARACTERS);
    }
}
