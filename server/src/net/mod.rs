//! The network thread: endpoint, admission, and one station's session at a time.

pub(crate) mod addresses;
mod admission;
mod control;
mod datagrams;
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

/// What the whole server is about to do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Phase {
    /// Serve.
    Serve,
    /// End the session properly, say goodbye, close.
    Shutdown,
    /// Close at once without a word to the client; the recording is still finished.
    Halt,
}

/// What connections share.
pub(crate) struct Shared {
    pub config: ServerConfig,
    pub scene_hash: [u8; 32],
    pub phase: watch::Receiver<Phase>,
    /// Pause and force limit of the station's side.
    pub levels: Levels,
    /// How often the station's side has lifted its pause: each time a new epoch begins.
    pub lifted: watch::Receiver<u64>,
    /// Held by the session that runs: whoever finds it locked is told that the station is busy.
    pub station: Arc<Mutex<Station>>,
}

/// What the one running session owns.
pub(crate) struct Station {
    /// Epoch of the last session; every session and every resume takes the next one.
    pub epoch: u32,
    /// Sessions so far.
    pub summaries: Vec<SessionSummary>,
}

impl Station {
    /// A new session epoch; 0 is never used.
    pub fn next_epoch(&mut self) -> u32 {
        self.epoch = self.epoch.wrapping_add(1).max(1);
        self.epoch
    }
}

/// Application code of a proper close.
const CLOSE_OK: VarInt = VarInt::from_u32(0);
/// Application code of a refusal.
const CLOSE_REFUSED: VarInt = VarInt::from_u32(1);
/// Time a client has to read the last message and close.
const LAST_WORD: Duration = Duration::from_secs(2);
/// Time that connections have to end by themselves once the server ends: a message that is not taken,
/// a goodbye that is not taken, the last word, and some to finish the recording.
const FAREWELL: Duration = Duration::from_secs(10);
/// Time that a recording has to be finished after that, on a slow disk.
const FINISHING: Duration = Duration::from_secs(20);
/// Connections being served at once, refused ones included.
const CONNECTIONS: usize = 64;
/// As many, and whoever comes next proves first that it is where its packets say: senders that lie about it must not
/// take all slots.
const CROWD: usize = CONNECTIONS / 2;
/// Characters of an error, which may quote a peer, in a log line.
const ERROR_CHARACTERS: usize = 256;

/// Serves until the phase says otherwise; returns the sessions served.
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
                    // Fails only for an address that is proven.
                    Answer::Retry => drop(incoming.retry()),
                    Answer::Refuse => incoming.refuse(),
                },
                None => break,
            },
        }
    }
    // Sessions see the phase too; each finishes its recording before its task ends.
    let halted = *phase.borrow() == Phase::Halt;
    let ended = !halted && all_ended(&mut connections, FAREWELL).await;
    // From here on nothing waits for a client any more.
    endpoint.close(CLOSE_OK, b"server stopped");
    let unfinished = !ended
        && !all_ended(&mut connections, FINISHING).await
        // Only a session holds it that long.
        && shared.station.try_lock().is_err();
    connections.shutdown().await;
    // Let the last packets out, but do not wait for clients that are gone.
    let _ = tokio::time::timeout(LAST_WORD, endpoint.wait_idle()).await;
    let mut station = shared.station.lock().await;
    if unfinished {
        tracing::error!("the session did not end in time; its recording may be cut off");
        let summary = SessionSummary::empty(EndReason::Recording);
        station.summaries.push(summary);
    }
    Ok(std::mem::take(&mut station.summaries))
}

/// What becomes of a first packet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Answer {
    Serve,
    /// Come again with a token that only the true owner of the address receives; costs no slot.
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

/// Waits until all connections have ended, at most this long; whether they have.
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
        Err(_) => tracing::info!("connection from {from} failed: the handshake takes too long"),
    }
}

/// Waits until the client has closed (it does so after the last message), then closes.
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
