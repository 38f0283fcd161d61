//! Connection of an instructor, an examiner or an administrator: status and events of stations, instructions.

use std::sync::Arc;
use std::time::{Duration, Instant};

use quinn::{Connection, SendStream};
use sulcus_link::control::ReadError;
use sulcus_proto::control::{Answer, Instruct, Instruction, Refused, RefusedReason, Welcome};
use sulcus_proto::limits::TEXT_BYTES;
use sulcus_proto::permission::{self, Kind, may};
use sulcus_proto::station::StationEvent;
use sulcus_proto::{ClientMessage, Role, ServerMessage};
use tokio::sync::broadcast::error::RecvError;
use tokio::sync::mpsc;

use super::rate::Rate;
use super::tokens::Grant;
use super::{CLOSE_OK, CLOSE_REFUSED, Net, close_after_last_word, control};
use crate::station::door::{Door, ToStation};

/// Interval between two statuses of a station.
const STATUS: Duration = Duration::from_millis(200);
/// Number of answers and events that wait for a slow instructor.
const WAITING: usize = 256;
/// Instructions and other messages per second that an instructor may send at most.
const MESSAGES_PER_S: u32 = 200;

type Messages = mpsc::Receiver<Result<ClientMessage, ReadError>>;

/// An instructor's connection.
struct Instructor {
    connection: Connection,
    send: SendStream,
    role: Role,
    grant: Grant,
    doors: Vec<Door>,
    /// Whether the instructor has subscribed to status and events.
    watching: bool,
    rate: Rate,
    /// Answers and events from tasks of this connection.
    outgoing: mpsc::Sender<ServerMessage>,
}

/// Serves the connection until its end, or the end of the server.
pub(super) async fn serve(
    connection: Connection,
    send: SendStream,
    mut messages: Messages,
    role: Role,
    grant: Grant,
    net: Arc<Net>,
) {
    let permitted = |door: &&Door| may(role, Kind::Watch, grant.station.includes(&door.name));
    let doors: Vec<Door> = net.doors.iter().filter(permitted).cloned().collect();
    let (outgoing, mut queue) = mpsc::channel(WAITING);
    let welcome = ServerMessage::Welcome(Welcome {
        program: env!("CARGO_PKG_VERSION").to_owned(),
        role,
        id: grant.id.clone(),
        stations: doors.iter().map(|door| door.name.to_string()).collect(),
    });
    let mut this = Instructor {
        connection,
        send,
        role,
        grant,
        doors,
        watching: false,
        rate: Rate::most(MESSAGES_PER_S),
        outgoing,
    };
    if !control::write(&mut this.send, &welcome).await {
        return this.connection.close(CLOSE_REFUSED, b"welcome not taken");
    }
    let id = this.grant.id.clone();
    let revoked = net.shared.revoked(&id);
    tokio::pin!(revoked);
    let mut stage = net.shared.stage.clone();
    let mut status = tokio::time::interval(STATUS);
    status.set_missed_tick_behavior(tokio::time::MissedTickBehavior::Delay);
    loop {
        let going = tokio::select! {
            message = messages.recv() => match message {
                Some(Ok(message)) => this.message(message),
                Some(Err(ReadError::Codec(error))) => Err(format!("a message cannot be read: {error}")),
                Some(Err(ReadError::Closed(_))) | None => return this.connection.close(CLOSE_OK, b"bye"),
            },
            Some(message) = queue.recv() => this.write(&message).await,
            _ = status.tick(), if this.watching => this.statuses().await,
            // No role of this connection may send poses.
            datagram = this.connection.read_datagram() => match datagram {
                Ok(_) => Err(format!("the role {role} may not send datagrams")),
                Err(_) => return,
            },
            why = &mut revoked => Err(why),
            _ = stage.changed() => Err("the server is ending".to_owned()),
        };
        if let Err(why) = going {
            return this.drop_with(why).await;
        }
    }
}

impl Instructor {
    /// Handles a message. The error is a sentence with which the connection is dropped.
    fn message(&mut self, message: ClientMessage) -> Result<(), String> {
        self.rate.count(Instant::now(), "messages")?;
        let Some(kind) = permission::kind(&message) else {
            return Err("a second hello".to_owned());
        };
        // Permission at any station at all. The station of an instruction is checked below.
        if !may(self.role, kind, true) {
            return Err(format!(
                "the role {} may not send a message of kind {kind:?}",
                self.role
            ));
        }
        match message {
            ClientMessage::Watch => self.watch(),
            ClientMessage::Instruct(instruct) => self.instruct(kind, instruct),
            _ => return Err(format!("kind {kind:?} has no meaning on this connection")),
        }
        Ok(())
    }

    /// Subscribes to status and events. The events of each station come through a task of their own.
    fn watch(&mut self) {
        if std::mem::replace(&mut self.watching, true) {
            return;
        }
        for door in &self.doors {
            let (mut events, outgoing) = (door.events(), self.outgoing.clone());
            let name = door.name.clone();
            tokio::spawn(async move {
                loop {
                    let event = match events.recv().await {
                        Ok(event) => event,
                        // The instructor is told how many events are missing; the recording has them all.
                        Err(RecvError::Lagged(missed)) => StationEvent {
                            station: name.to_string(),
                            tick: 0,
                            text: format!("events_missed at tick 0: {{\"count\":{missed}}}"),
                        },
                        Err(RecvError::Closed) => return,
                    };
                    if outgoing.send(ServerMessage::Event(event)).await.is_err() {
                        return;
                    }
                }
            });
        }
    }

    /// Passes an instruction to its station. The answer comes when a tick has obeyed it.
    fn instruct(&mut self, kind: Kind, instruct: Instruct) {
        let Instruct {
            number,
            station,
            instruction,
        } = instruct;
        let refuse = |text: String| {
            let answer = ServerMessage::Answer(Answer {
                number,
                taken: false,
                tick: 0,
                text,
            });
            // A queue full of answers belongs to an instructor who reads none.
            let _ = self.outgoing.try_send(answer);
        };
        let named = |door: &&Door| {
            *door.name == *station && may(self.role, kind, self.grant.station.includes(&door.name))
        };
        let Some(door) = self.doors.iter().find(named).cloned() else {
            let name = super::hello::clean(&station);
            return refuse(format!("this token has no station `{name}`"));
        };
        if let Instruction::Note(text)
        | Instruction::Flag(text)
        | Instruction::Say(text)
        | Instruction::Plan(text)
        | Instruction::Ghost(text) = &instruction
            && text.len() > TEXT_BYTES
        {
            let found = text.len();
            return refuse(format!(
                "the text has {found} bytes, at most {TEXT_BYTES} are allowed"
            ));
        }
        let (by, outgoing) = (self.grant.id.clone(), self.outgoing.clone());
        let exams = may(
            self.role,
            Kind::ExamPlan,
            self.grant.station.includes(&door.name),
        );
        tokio::spawn(async move {
            let answer = door.ask(|reply| ToStation::Instruct {
                by,
                instruction,
                exams,
                reply,
            });
            let answer = answer.await.unwrap_or_else(|| Answer {
                number,
                taken: false,
                tick: 0,
                text: "the station is ending".to_owned(),
            });
            let answer = ServerMessage::Answer(Answer { number, ..answer });
            let _ = outgoing.send(answer).await;
        });
    }

    /// Sends the newest status of every station.
    async fn statuses(&mut self) -> Result<(), String> {
        for k in 0..self.doors.len() {
            let status = self.doors[k].status();
            self.write(&ServerMessage::Status(status)).await?;
        }
        Ok(())
    }

    async fn write(&mut self, message: &ServerMessage) -> Result<(), String> {
        if control::write(&mut self.send, message).await {
            Ok(())
        } else {
            Err("the client takes no messages".to_owned())
        }
    }

    /// Drops the connection with a sentence.
    async fn drop_with(mut self, why: String) {
        tracing::info!("connection of {} {} ends: {why}", self.role, self.grant.id);
        let text = ServerMessage::Refused(Refused {
            reason: RefusedReason::Role,
            text: why,
        });
        if control::write(&mut self.send, &text).await && self.send.finish().is_ok() {
            close_after_last_word(&self.connection, CLOSE_REFUSED, b"dropped").await;
        }
        self.connection.close(CLOSE_REFUSED, b"dropped");
    }
}
