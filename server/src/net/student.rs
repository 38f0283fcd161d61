//! Connection of a student: poses in, wrenches out, control messages. The session outlives the connection.

use std::sync::Arc;
use std::time::{Duration, Instant};

use quinn::{Connection, ConnectionError, SendStream};
use sulcus_link::clock::monotonic_ns;
use sulcus_link::control::ReadError;
use sulcus_proto::at_hand::LEVELS_MS;
use sulcus_proto::control::{Command, EndReason, Refused, RefusedReason};
use sulcus_proto::ghost::GhostPart;
use sulcus_proto::permission::{self, may};
use sulcus_proto::{ClientMessage, Role, ServerMessage};
use sulcus_sessions::Detached;
use sulcus_sessions::exercise::events::may_a_client_say;
use tokio::sync::mpsc::Receiver;

use super::datagrams::Encoded;
use super::greeting::server_hello;
use super::rate::{MESSAGES_PER_S, Rate};
use super::{CLOSE_OK, CLOSE_REFUSED, Net, close_after_last_word, control, hello, inputs};
use crate::session::handoff::Provoked;
use crate::session::levels::{Levels, Taken};
use crate::session::ports::Ports;
use crate::station::door::{Attached, Door, Student, ToStation, ToStudent};

/// Interval between two parts of a ghost's path. The wrenches of the hand must not wait behind the path. A part of
/// 29 kB every 40 ms is 6 Mbit/s.
const GHOST_PACE: Duration = Duration::from_millis(40);

type Messages = Receiver<Result<ClientMessage, ReadError>>;

/// Reason why the loop of a connection ended.
enum Left {
    /// The goodbye was sent, or could not be sent.
    Goodbye,
    /// The connection or the control stream is lost.
    Lost(String),
    /// A newer connection has taken over.
    Replaced,
    /// The client broke the protocol, or sent far too much: the connection is dropped with a sentence.
    Dropped(String),
}

/// Tells the station that the connection is gone, also after a panic of its task.
struct Leaving {
    door: Door,
    epoch: u32,
    reason: Detached,
    why: String,
}

impl Drop for Leaving {
    fn drop(&mut self) {
        self.door.gone(self.epoch, self.reason, &self.why);
    }
}

/// A student's connection to a station.
struct StudentConnection {
    connection: Connection,
    send: SendStream,
    messages: Messages,
    hears: Receiver<ToStudent>,
    /// Parts of a ghost's path that wait, last one first.
    ghost: Vec<GhostPart>,
    ports: Option<Arc<Ports>>,
    levels: Levels,
    door: Door,
    epoch: u32,
    datagrams: Rate,
    control: Rate,
}

/// Attaches a student to a station and serves the connection until its end.
pub(super) async fn serve(
    connection: Connection,
    mut send: SendStream,
    messages: Messages,
    student: Student,
    door: Door,
    net: Arc<Net>,
) {
    let token = student.grant.id.clone();
    let student = Box::new(student);
    let attach = door.ask(|reply| ToStation::Attach { student, reply }).await;
    let attached = match attach {
        Some(Ok(attached)) => attached,
        Some(Err(refused)) => return hello::refuse(&connection, &mut send, refused).await,
        None => {
            let refused = Refused {
                reason: RefusedReason::Server,
                text: "the station is ending".to_owned(),
            };
            return hello::refuse(&connection, &mut send, refused).await;
        }
    };
    let Attached {
        epoch,
        plan,
        couplings,
        ports,
        at_hand,
        levels,
        hears,
    } = attached;
    let mut leaving = Leaving {
        door: door.clone(),
        epoch,
        reason: Detached::Station,
        why: "the connection's task ended unexpectedly".to_owned(),
    };
    let attach = (epoch, ports.is_some(), at_hand);
    let greeting = ServerMessage::Hello(server_hello(
        &plan,
        &couplings,
        (&door.name, net.self_test),
        attach,
    ));
    if !control::write(&mut send, &greeting).await {
        leaving.why = "the client took no hello".to_owned();
        connection.close(CLOSE_REFUSED, b"hello not taken");
        return;
    }
    let mut student = StudentConnection {
        datagrams: Rate::of_datagrams(plan.scene.params.rate_hz),
        control: Rate::most(MESSAGES_PER_S),
        connection,
        send,
        messages,
        hears,
        ghost: Vec::new(),
        ports,
        levels,
        door,
        epoch,
    };
    let left = tokio::select! {
        left = student.live() => left,
        why = net.shared.revoked(&token) => Left::Dropped(why),
    };
    leaving.epoch = student.epoch;
    let StudentConnection {
        connection,
        mut send,
        ..
    } = student;
    match left {
        Left::Goodbye => {
            leaving.why = "the session has ended".to_owned();
            if send.finish().is_ok() {
                close_after_last_word(&connection, CLOSE_OK, b"goodbye").await;
            }
            connection.close(CLOSE_OK, b"goodbye");
        }
        Left::Lost(why) => {
            tracing::info!("station {}: connection lost: {why}", leaving.door.name);
            leaving.reason = match connection.close_reason() {
                Some(ConnectionError::ApplicationClosed(_)) => Detached::Closed,
                _ => Detached::ConnectionLost,
            };
            leaving.why = why;
            connection.close(CLOSE_OK, b"lost");
        }
        Left::Replaced => {
            connection.close(CLOSE_OK, b"replaced by a newer connection");
        }
        Left::Dropped(why) => {
            tracing::warn!("station {}: connection dropped: {why}", leaving.door.name);
            let text = ServerMessage::Refused(Refused {
                reason: RefusedReason::Role,
                text: why.clone(),
            });
            leaving.reason = Detached::Protocol;
            leaving.why = why;
            if control::write(&mut send, &text).await && send.finish().is_ok() {
                close_after_last_word(&connection, CLOSE_REFUSED, b"dropped").await;
            }
            connection.close(CLOSE_REFUSED, b"dropped");
        }
    }
}

impl StudentConnection {
    async fn live(&mut self) -> Left {
        loop {
            let left = match &self.ports {
                None => self.before_start().await,
                Some(ports) => {
                    let ports = ports.clone();
                    self.in_session(&ports).await
                }
            };
            match left {
                Ok(ports) => self.ports = Some(ports),
                Err(left) => return left,
            }
        }
    }

    /// Serves the connection until the session has started.
    async fn before_start(&mut self) -> Result<Arc<Ports>, Left> {
        loop {
            tokio::select! {
                message = self.messages.recv() => if let Some(ports) = self.message(message, None).await? {
                    return Ok(ports);
                },
                heard = self.hears.recv() => self.hear(heard).await?,
                // Without a session a pose has no meaning; a flood is dropped all the same.
                datagram = self.connection.read_datagram() => match datagram {
                    Ok(_) => self.datagrams.count(Instant::now(), "datagrams").map_err(Left::Dropped)?,
                    Err(error) => return Err(lost(&error)),
                },
            }
        }
    }

    /// Carries poses, wrenches and messages until the connection ends.
    async fn in_session(&mut self, ports: &Arc<Ports>) -> Result<Arc<Ports>, Left> {
        let mut bell = match ports.bell().listen() {
            Ok(bell) => bell,
            Err(error) => {
                return Err(Left::Lost(format!(
                    "the network cannot wait for the simulation: {error}"
                )));
            }
        };
        let mut pace = tokio::time::interval(GHOST_PACE);
        pace.set_missed_tick_behavior(tokio::time::MissedTickBehavior::Delay);
        let mut levels = tokio::time::interval(Duration::from_millis(LEVELS_MS));
        levels.set_missed_tick_behavior(tokio::time::MissedTickBehavior::Delay);
        // Ends with this connection.
        let _inputs = inputs::read_all(&self.connection, ports);
        loop {
            tokio::select! {
                datagram = self.connection.read_datagram() => match datagram {
                    Ok(bytes) => {
                        self.datagrams.count(Instant::now(), "datagrams").map_err(Left::Dropped)?;
                        ports.flags().provoke(Provoked::Connection);
                        let mut datagrams = ports.datagrams();
                        let newest = if datagrams.epoch() == self.epoch {
                            datagrams.arrived(&bytes, monotonic_ns(), || self.connection.rtt())
                        } else {
                            None
                        };
                        drop(datagrams);
                        if let Some((hand, pose)) = ports.hand().zip(newest) {
                            hand.live(&pose, self.connection.rtt());
                        }
                    }
                    Err(error) => return Err(lost(&error)),
                },
                _ = levels.tick(), if ports.hand().is_some() => self.send_levels(ports),
                // A command does not wait for the next packet; a lost one is repeated by that.
                () = self.levels.changed(), if ports.hand().is_some() => self.send_levels(ports),
                () = bell.rung(), if ports.hand().is_none() => {
                    let mut datagrams = ports.datagrams();
                    if datagrams.epoch() == self.epoch {
                        let wrench = datagrams.wrench(monotonic_ns());
                        self.send_datagram(wrench);
                    }
                },
                message = self.messages.recv() => {
                    self.message(message, Some(ports)).await?;
                }
                heard = self.hears.recv() => self.hear(heard).await?,
                _ = pace.tick(), if !self.ghost.is_empty() => if let Some(part) = self.ghost.pop() {
                    self.tell(&ServerMessage::Ghost(part)).await?;
                },
            }
        }
    }

    /// Sends pause and force limit to a hand with ticks of its own.
    fn send_levels(&self, ports: &Ports) {
        let levels = ports.hand().and_then(|hand| hand.levels(&self.levels));
        let mut datagrams = ports.datagrams();
        if let Some((tick, levels)) = levels
            && datagrams.epoch() == self.epoch
        {
            let levels = datagrams.levels(tick, levels);
            self.send_datagram(levels);
        }
    }

    fn send_datagram(&self, datagram: Option<Encoded>) {
        if let Some(bytes) = datagram {
            // A full buffer drops its oldest datagram. A closed connection ends the session's loop.
            let _ = self.connection.send_datagram(bytes.to_vec().into());
        }
    }

    /// Handles a message of the client. A started session's hand-overs are returned.
    async fn message(
        &mut self,
        message: Option<Result<ClientMessage, ReadError>>,
        ports: Option<&Arc<Ports>>,
    ) -> Result<Option<Arc<Ports>>, Left> {
        let message = match message {
            Some(Ok(message)) => message,
            Some(Err(ReadError::Codec(_))) => return self.end(EndReason::Protocol).await,
            Some(Err(ReadError::Closed(why))) => return Err(Left::Lost(why)),
            None => return Err(Left::Lost("the control stream ended".to_owned())),
        };
        self.control
            .count(Instant::now(), "control messages")
            .map_err(Left::Dropped)?;
        let Some(kind) = permission::kind(&message) else {
            return self.end(EndReason::Protocol).await;
        };
        if !may(Role::Student, kind, true) {
            return Err(Left::Dropped(format!(
                "a student may not send a message of kind {kind:?}"
            )));
        }
        match (message, ports) {
            (ClientMessage::Start, None) => {
                let epoch = self.epoch;
                let started = self.door.ask(|reply| ToStation::Start { epoch, reply });
                match started.await {
                    Some(Ok(ports)) => return Ok(Some(ports)),
                    Some(Err(goodbye)) => {
                        let goodbye = ServerMessage::Goodbye(*goodbye);
                        control::write(&mut self.send, &goodbye).await;
                        return Err(Left::Goodbye);
                    }
                    None => return Err(Left::Lost("the station is ending".to_owned())),
                }
            }
            (ClientMessage::Start, Some(_)) => return self.end(EndReason::Protocol).await,
            (ClientMessage::Stop, _) => return self.end(EndReason::Stopped).await,
            (ClientMessage::Command(command), _) => self.command(command).await,
            (ClientMessage::Button(edge), Some(ports)) => {
                if edge.pressed {
                    ports.press(edge.tool, edge.button);
                }
            }
            (ClientMessage::Event(event), Some(ports)) => {
                if !may_a_client_say(&event.kind) {
                    return self.end(EndReason::Protocol).await;
                }
                ports.event(event);
            }
            (ClientMessage::Inputs(_), _) => {
                let why = "inputs of ticks come on a stream of their own, and only if the ticks run at the hand";
                return Err(Left::Dropped(why.to_owned()));
            }
            (ClientMessage::LastTick(last), Some(ports)) => {
                let Some(hand) = ports.hand() else {
                    let why = "a last tick was named, but the ticks do not run at the hand";
                    return Err(Left::Dropped(why.to_owned()));
                };
                hand.last(last);
            }
            // These have no meaning before the start.
            (
                ClientMessage::Button(_) | ClientMessage::Event(_) | ClientMessage::LastTick(_),
                None,
            ) => {}
            (
                ClientMessage::Hello(_)
                | ClientMessage::Show(_)
                | ClientMessage::Watch
                | ClientMessage::Instruct(_),
                _,
            ) => return self.end(EndReason::Protocol).await,
        }
        Ok(None)
    }

    /// Asks the station for the end of the session. The goodbye follows as a message of the station.
    async fn end(&mut self, reason: EndReason) -> Result<Option<Arc<Ports>>, Left> {
        let epoch = self.epoch;
        self.door.tell(ToStation::End { epoch, reason }).await;
        // Further messages have no meaning.
        loop {
            let heard = self.hears.recv().await;
            self.hear(heard).await?;
        }
    }

    /// Applies a command of the student: a pause of its own, its end, or a lower limit. An invalid limit is ignored
    /// with a warning.
    async fn command(&mut self, command: Command) {
        match self.levels.student(command) {
            Taken::Set => {}
            Taken::Lifted => {
                let epoch = Some(self.epoch);
                self.door.tell(ToStation::Lifted { epoch }).await;
            }
            Taken::NoForce(newtons) => tracing::warn!(
                "force limit of the client is {newtons} N, expected 0 (no limit of its own) or a positive force: ignored"
            ),
        }
    }

    /// Passes a message of the station on to the client.
    async fn hear(&mut self, heard: Option<ToStudent>) -> Result<(), Left> {
        match heard {
            Some(ToStudent::Epoch(epoch)) => {
                self.epoch = epoch;
                self.tell(&ServerMessage::Epoch(epoch)).await
            }
            Some(ToStudent::Say(say)) => self.tell(&ServerMessage::Say(say)).await,
            Some(ToStudent::Ghost(parts)) => {
                self.ghost = parts;
                self.ghost.reverse();
                Ok(())
            }
            Some(ToStudent::Goodbye(goodbye)) => {
                control::write(&mut self.send, &ServerMessage::Goodbye(*goodbye)).await;
                Err(Left::Goodbye)
            }
            Some(ToStudent::Replaced) => Err(Left::Replaced),
            None => Err(Left::Lost("the station has ended".to_owned())),
        }
    }

    async fn tell(&mut self, message: &ServerMessage) -> Result<(), Left> {
        if control::write(&mut self.send, message).await {
            Ok(())
        } else {
            Err(Left::Lost(
                "the client takes no control messages".to_owned(),
            ))
        }
    }
}

fn lost(error: &ConnectionError) -> Left {
    Left::Lost(hello::printable(&error.to_string(), 128))
}
