//! One session, from the hello to the goodbye.

use std::sync::Arc;
use std::time::{Duration, Instant};

use quinn::{Connection, SendStream};
use sulcus_link::control::ReadError;
use sulcus_proto::control::{ClientHello, Command, EndReason, Goodbye};
use sulcus_proto::{ClientMessage, ServerMessage, SessionSummary};
use sulcus_sessions::exercise::events::may_a_client_say;
use tokio::sync::mpsc::Receiver;
use tokio::sync::watch;

use super::control;
use super::datagrams::Datagrams;
use super::{CLOSE_OK, Phase, Shared, Station, close_after_last_word};
use crate::outlets::recording::Plan;
use crate::session::handoff::Flags;
use crate::session::levels::{Levels, Taken};
use crate::session::running::{Running, Started};

type Messages = Receiver<Result<ClientMessage, ReadError>>;

/// Timeout from the server's hello to the client's start. In this time the station is in use.
const START: Duration = Duration::from_secs(20);

/// Runs a session from the hello to the goodbye and returns its summary.
///
/// `None`: no session was started. The client stopped, left, broke the protocol or sent no start within [`START`], or
/// the server ended. A recording that cannot be opened gives a summary.
pub(super) async fn run(
    connection: Connection,
    mut send: SendStream,
    mut messages: Messages,
    hello: ClientHello,
    shared: &Arc<Shared>,
    station: &mut Station,
) -> Option<SessionSummary> {
    let mut phase = shared.phase.clone();
    let levels = shared.levels.of_new_connection();
    if let Err((reason, text)) = started(&mut messages, &mut phase, &levels, START).await {
        tracing::info!("the client ended before a session was started ({reason:?})");
        say_goodbye(&connection, &mut send, SessionSummary::empty(reason), &text).await;
        return None;
    }
    // The start of a recording writes the whole scene. The thread of the packets must not wait for it.
    let plan = Plan::new(&shared.config, &hello);
    let config = shared.config.clone();
    // A pause that was lifted before this session needs no new epoch.
    let mut lifted = shared.lifted.clone();
    lifted.mark_unchanged();
    let in_force = levels.clone();
    let opened = tokio::task::spawn_blocking(move || Running::start(&config, plan, in_force)).await;
    let started = match opened {
        Ok(Ok(started)) => started,
        Ok(Err((reason, text))) => {
            tracing::error!("{text}");
            let summary = SessionSummary::empty(reason);
            say_goodbye(&connection, &mut send, summary.clone(), &text).await;
            return Some(summary);
        }
        // The runtime is shutting down, or the start has panicked.
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
        &levels,
        (phase, lifted),
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
        "the session has ended ({:?}): {} ticks, recording {}",
        summary.end,
        summary.ticks,
        summary.recording
    );
    say_goodbye(&connection, &mut send, summary.clone(), &text).await;
    Some(summary)
}

/// Waits at most `limit` for the start. The error is the reason and one sentence for people.
async fn started(
    messages: &mut Messages,
    phase: &mut watch::Receiver<Phase>,
    levels: &Levels,
    limit: Duration,
) -> Result<(), (EndReason, String)> {
    match tokio::time::timeout(limit, start_said(messages, phase, levels)).await {
        Ok(said) => said.map_err(|reason| (reason, "No session was started.".to_owned())),
        Err(_) => {
            let text = format!(
                "No session was started within {} s; connect again.",
                limit.as_secs()
            );
            Err((EndReason::TimeUp, text))
        }
    }
}

async fn start_said(
    messages: &mut Messages,
    phase: &mut watch::Receiver<Phase>,
    levels: &Levels,
) -> Result<(), EndReason> {
    loop {
        tokio::select! {
            _ = phase.changed() => return Err(EndReason::Shutdown),
            message = messages.recv() => match message {
                Some(Ok(ClientMessage::Start)) => return Ok(()),
                Some(Ok(ClientMessage::Stop)) => return Err(EndReason::Stopped),
                // The level holds from the first tick on.
                Some(Ok(ClientMessage::Command(command))) => {
                    request(levels, command);
                }
                // Buttons and events have no meaning before the start.
                Some(Ok(ClientMessage::Button(_) | ClientMessage::Event(_))) => {}
                Some(Ok(ClientMessage::Hello(_)) | Err(ReadError::Codec(_))) => return Err(EndReason::Protocol),
                Some(Err(ReadError::Closed(_))) | None => return Err(EndReason::ConnectionLost),
            },
        }
    }
}

/// Carries poses, wrenches and control messages until the session ends.
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
    levels: &Levels,
    (mut phase, mut lifted): (watch::Receiver<Phase>, watch::Receiver<u64>),
    (limit, silence): (Option<Duration>, Duration),
) -> EndReason {
    let bell = match running.bell().listen() {
        Ok(bell) => bell,
        Err(error) => {
            tracing::error!("the network cannot wait for the simulation: {error}");
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
                    tracing::warn!(
                        "the session ends: no new pose for {:.1} s, expected one within {:.0} s",
                        heard.elapsed().as_secs_f64(),
                        silence.as_secs_f64()
                    );
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
                match message {
                    Some(Ok(ClientMessage::Stop)) => return EndReason::Stopped,
                    Some(Ok(ClientMessage::Command(command))) => {
                        let again = request(levels, command) == Taken::Lifted;
                        if again && !begin_epoch(send, datagrams, station).await {
                            return EndReason::ConnectionLost;
                        }
                    }
                    Some(Ok(ClientMessage::Button(edge))) => {
                        if edge.pressed {
                            running.press(edge.tool, edge.button);
                        }
                    }
                    Some(Ok(ClientMessage::Event(event))) if !may_a_client_say(&event.kind) => {
                        return EndReason::Protocol;
                    }
                    Some(Ok(ClientMessage::Event(event))) => running.event(event),
                    Some(Ok(ClientMessage::Hello(_) | ClientMessage::Start) | Err(ReadError::Codec(_))) => {
                        return EndReason::Protocol;
                    }
                    Some(Err(ReadError::Closed(_))) | None => return EndReason::ConnectionLost,
                }
            },
            Ok(()) = lifted.changed() => {
                if !begin_epoch(send, datagrams, station).await {
                    return EndReason::ConnectionLost;
                }
            },
            _ = phase.changed() => return EndReason::Shutdown,
            () = &mut time_up => return EndReason::TimeUp,
        }
    }
}

/// Applies a command of the student's connection: a pause of its own, its end, or a lower limit. An invalid limit is
/// ignored with a warning.
fn request(levels: &Levels, command: Command) -> Taken {
    let taken = levels.student(command);
    if let Taken::NoForce(newtons) = taken {
        tracing::warn!(
            "force limit of the client is {newtons} N, expected 0 (no limit of its own) or a positive force: ignored"
        );
    }
    taken
}

/// Begins a new epoch after the end of a pause: poses from before its end must not move a tool. `false`: the client
/// does not take the message.
async fn begin_epoch(
    send: &mut SendStream,
    datagrams: &mut Datagrams,
    station: &mut Station,
) -> bool {
    let epoch = station.next_epoch();
    datagrams.begin_epoch(epoch);
    control::write(send, &ServerMessage::Epoch(epoch)).await
}

/// Sends the goodbye and closes the connection. A client that does not take the goodbye loses the connection.
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
            let levels = Levels::default();
            let (reason, text) = started(&mut messages, &mut phase, &levels, limit)
                .await
                .expect_err("nothing was said");
            assert_eq!(reason, EndReason::TimeUp);
            assert!(text.contains("connect again"), "{text}");
            // A command from before the start holds from the first tick on.
            let pause = ClientMessage::Command(Command::Pause);
            sender.send(Ok(pause)).await.expect("room");
            sender.send(Ok(ClientMessage::Start)).await.expect("room");
            let begun = started(&mut messages, &mut phase, &levels, limit).await;
            assert_eq!(begun, Ok(()));
            assert!(levels.in_force().student.paused);
        });
    }
}
