//! One session, from the hello to the goodbye.

use std::sync::Arc;
use std::time::{Duration, Instant};

use quinn::{Connection, SendStream};
use sulcus_proto::control::{ClientHello, Command, EndReason, Goodbye};
use sulcus_proto::{ClientMessage, ServerMessage, SessionSummary};
use sulcus_sessions::events::may_a_client_say;
use tokio::sync::mpsc::Receiver;
use tokio::sync::watch;

use super::control::{self, ReadError};
use super::datagrams::Datagrams;
use super::{CLOSE_OK, Phase, Shared, Station, close_after_last_word};
use crate::handoff::{Edge, Flags};
use crate::recording::Plan;
use crate::running::{Running, Started};

type Messages = Receiver<Result<ClientMessage, ReadError>>;

/// Time a station has from its hello to its start: meanwhile nobody else can have it.
const START: Duration = Duration::from_secs(20);

/// Runs a session. `None`: the client left before it started anything.
pub(super) async fn run(
    connection: Connection,
    mut send: SendStream,
    mut messages: Messages,
    hello: ClientHello,
    shared: &Arc<Shared>,
    station: &mut Station,
) -> Option<SessionSummary> {
    let mut phase = shared.phase.clone();
    if let Err((reason, text)) = started(&mut messages, &mut phase, START).await {
        tracing::info!("session over before its start ({reason:?})");
        say_goodbye(&connection, &mut send, SessionSummary::empty(reason), &text).await;
        return None;
    }
    // Opening a recording writes the whole scene: not on the thread that carries the packets.
    let plan = Plan::new(&shared.config, &hello);
    let config = shared.config.clone();
    let opened = tokio::task::spawn_blocking(move || Running::start(&config, plan)).await;
    let started = match opened {
        Ok(Ok(started)) => started,
        Ok(Err((reason, text))) => {
            tracing::error!("{text}");
            let summary = SessionSummary::empty(reason);
            say_goodbye(&connection, &mut send, summary.clone(), &text).await;
            return Some(summary);
        }
        // The runtime is going down.
        Err(_) => return None,
    };
    let Started {
        mut running,
        poses,
        wrenches,
    } = started;
    let mut datagrams = Datagrams::new(station.epoch, poses, wrenches);
    let config = &shared.config;
    let limits = (config.max_session, config.max_silence);
    let reason = live(
        &connection,
        &mut send,
        &mut messages,
        &mut running,
        &mut datagrams,
        station,
        phase,
        limits,
    )
    .await;

    let poses = datagrams.counts();
    let finished = tokio::task::spawn_blocking(move || running.finish(reason, poses)).await;
    let (mut summary, text) = finished.unwrap_or_else(|_| {
        (
            SessionSummary::empty(EndReason::Simulation),
            "The session ended unexpectedly.".to_owned(),
        )
    });
    summary.foreign = datagrams.foreign;
    summary.malformed = datagrams.malformed;
    tracing::info!(
        "session over ({:?}): {} ticks, recording {}",
        summary.end,
        summary.ticks,
        summary.recording
    );
    say_goodbye(&connection, &mut send, summary.clone(), &text).await;
    Some(summary)
}

/// Waits for the start, at most this long; or why there is none, with one sentence for people.
async fn started(
    messages: &mut Messages,
    phase: &mut watch::Receiver<Phase>,
    limit: Duration,
) -> Result<(), (EndReason, String)> {
    match tokio::time::timeout(limit, start_said(messages, phase)).await {
        Ok(said) => said.map_err(|reason| (reason, "Nothing was started.".to_owned())),
        Err(_) => {
            let text = format!(
                "Nothing was started within {} s; connect again.",
                limit.as_secs()
            );
            Err((EndReason::TimeUp, text))
        }
    }
}

async fn start_said(
    messages: &mut Messages,
    phase: &mut watch::Receiver<Phase>,
) -> Result<(), EndReason> {
    loop {
        tokio::select! {
            _ = phase.changed() => return Err(EndReason::Shutdown),
            message = messages.recv() => match message {
                Some(Ok(ClientMessage::Start)) => return Ok(()),
                Some(Ok(ClientMessage::Stop)) => return Err(EndReason::Stopped),
                // There is nothing yet that these could act on.
                Some(Ok(ClientMessage::Button(_) | ClientMessage::Event(_) | ClientMessage::Command(_))) => {}
                Some(Ok(ClientMessage::Hello(_)) | Err(ReadError::Codec(_))) => return Err(EndReason::Protocol),
                Some(Err(ReadError::Closed)) | None => return Err(EndReason::ConnectionLost),
            },
        }
    }
}

/// Carries poses, wrenches and commands until something ends it.
#[expect(
    clippy::too_many_arguments,
    reason = "the select loop borrows each part on its own"
)]
async fn live(
    connection: &Connection,
    send: &mut SendStream,
    messages: &mut Messages,
    running: &mut Running,
    datagrams: &mut Datagrams,
    station: &mut Station,
    mut phase: watch::Receiver<Phase>,
    (limit, silence): (Option<Duration>, Duration),
) -> EndReason {
    let bell = match running.bell().listen() {
        Ok(bell) => bell,
        Err(error) => {
            tracing::error!("cannot listen to the simulation: {error}");
            return EndReason::Simulation;
        }
    };
    let time_up = async {
        match limit {
            Some(limit) => tokio::time::sleep(limit).await,
            None => std::future::pending().await,
        }
    };
    tokio::pin!(time_up);
    let mut look = tokio::time::interval((silence / 4).max(Duration::from_millis(1)));
    let (mut poses, mut heard) = (0, Instant::now());
    loop {
        tokio::select! {
            _ = look.tick() => {
                let accepted = datagrams.counts().accepted;
                if accepted != poses {
                    (poses, heard) = (accepted, Instant::now());
                } else if heard.elapsed() >= silence {
                    tracing::warn!("no pose for {:.1} s: the session ends", heard.elapsed().as_secs_f64());
                    return EndReason::ConnectionLost;
                }
            },
            datagram = connection.read_datagram() => match datagram {
                Ok(bytes) => datagrams.arrived(&bytes),
                Err(_) => return EndReason::ConnectionLost,
            },
            ready = bell.readable() => {
                if let Ok(mut ready) = ready {
                    running.bell().silence();
                    ready.clear_ready();
                }
                if Flags::is_up(&running.flags().record_failed) {
                    return EndReason::Recording;
                }
                if Flags::is_up(&running.flags().simulation_over) {
                    return EndReason::Simulation;
                }
                datagrams.send(connection);
            },
            message = messages.recv() => {
                let edge = match message {
                    Some(Ok(ClientMessage::Stop)) => return EndReason::Stopped,
                    Some(Ok(ClientMessage::Command(command))) => edge_of(command),
                    Some(Ok(ClientMessage::Button(edge))) => edge.pressed.then_some(Edge::Pressed {
                        tool: edge.tool,
                        button: edge.button,
                    }),
                    Some(Ok(ClientMessage::Event(event))) if !may_a_client_say(&event.kind) => {
                        return EndReason::Protocol;
                    }
                    Some(Ok(ClientMessage::Event(event))) => {
                        running.event(event);
                        None
                    }
                    Some(Ok(ClientMessage::Hello(_) | ClientMessage::Start) | Err(ReadError::Codec(_))) => {
                        return EndReason::Protocol;
                    }
                    Some(Err(ReadError::Closed)) | None => return EndReason::ConnectionLost,
                };
                if !apply(edge, send, running, datagrams, station).await {
                    return EndReason::ConnectionLost;
                }
            },
            Some(command) = station.commands.recv() => {
                if !apply(edge_of(command), send, running, datagrams, station).await {
                    return EndReason::ConnectionLost;
                }
            },
            _ = phase.changed() => return EndReason::Shutdown,
            () = &mut time_up => return EndReason::TimeUp,
        }
    }
}

/// `None`: a limit that is no force.
fn edge_of(command: Command) -> Option<Edge> {
    match command {
        Command::Pause => Some(Edge::Paused(true)),
        Command::Resume => Some(Edge::Paused(false)),
        Command::ForceLimit(newtons) if newtons.is_finite() && newtons >= 0.0 => {
            Some(Edge::ForceLimit(newtons))
        }
        Command::ForceLimit(newtons) => {
            tracing::warn!(
                "force limit {newtons} ignored: expected 0 (the scene's) or a positive force"
            );
            None
        }
    }
}

/// Hands an edge on; `false` when the client does not take what it must know of it.
async fn apply(
    edge: Option<Edge>,
    send: &mut SendStream,
    running: &mut Running,
    datagrams: &mut Datagrams,
    station: &mut Station,
) -> bool {
    let Some(edge) = edge else { return true };
    running.edge(edge);
    if edge != Edge::Paused(false) {
        return true;
    }
    // Poses from before or during the pause must not move anything now.
    let epoch = station.next_epoch();
    datagrams.begin_epoch(epoch);
    control::write(send, &ServerMessage::Epoch(epoch)).await
}

async fn say_goodbye(
    connection: &Connection,
    send: &mut SendStream,
    summary: SessionSummary,
    text: &str,
) {
    let goodbye = ServerMessage::Goodbye(Goodbye {
        text: text.to_owned(),
        summary,
    });
    if connection.close_reason().is_none()
        && control::write(send, &goodbye).await
        && send.finish().is_ok()
    {
        close_after_last_word(connection, CLOSE_OK, b"goodbye").await;
    }
    connection.close(CLOSE_OK, b"goodbye");
}

#[cfg(test)]
mod tests {
    use tokio::sync::mpsc::channel;

    use super::*;

    #[test]
    fn a_station_is_not_held_without_a_start() {
        let runtime = tokio::runtime::Builder::new_current_thread()
            .enable_time()
            .build()
            .expect("runtime");
        runtime.block_on(async {
            let (_phase, mut phase) = watch::channel(Phase::Serve);
            let (sender, mut messages) = channel(4);
            let limit = Duration::from_millis(30);
            let (reason, text) = started(&mut messages, &mut phase, limit)
                .await
                .expect_err("nothing was said");
            assert_eq!(reason, EndReason::TimeUp);
            assert!(text.contains("connect again"), "{text}");
            sender.send(Ok(ClientMessage::Start)).await.expect("room");
            assert_eq!(started(&mut messages, &mut phase, limit).await, Ok(()));
        });
    }
}
