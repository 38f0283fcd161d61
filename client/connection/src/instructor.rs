//! Connection of an instructor: status and events of stations, instructions with their answers.

use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, sync_channel};
use std::thread::JoinHandle;
use std::time::Duration;

use quinn::{Connection, RecvStream, SendStream};
use sulcus_proto::control::{Answer, Instruct, Instruction, Welcome};
use sulcus_proto::station::{StationEvent, StationStatus};
use sulcus_proto::{ClientMessage, CodecError, ServerMessage};
use tokio::sync::mpsc;

use crate::link::{LAST_PACKETS, LinkConfig, LinkError, control, handshake, reach};

/// Number of messages that wait in either direction. Statuses and events beyond it are dropped.
const MESSAGES: usize = 1024;
/// Timeout of an answer. A server answers a level within 2 s, a plan after the compilation of its scene.
const ANSWER: Duration = Duration::from_secs(120);

/// Message of a station.
#[derive(Clone, Debug, PartialEq)]
pub enum Heard {
    /// Newest status.
    Status(Box<StationStatus>),
    /// Event of the running session.
    Event(StationEvent),
}

/// An instructor's connection to a server.
pub struct Instructor {
    welcome: Welcome,
    number: u64,
    to_server: Option<mpsc::Sender<ClientMessage>>,
    answers: Receiver<Result<Answer, LinkError>>,
    heard: Receiver<Heard>,
    thread: Option<JoinHandle<()>>,
}

impl Instructor {
    /// Connects as the role of `config`, and subscribes to status and events.
    ///
    /// # Errors
    /// No answer, another certificate, a refusal, or a system without threads or sockets.
    pub fn connect(config: LinkConfig) -> Result<Self, LinkError> {
        let (to_server, mut from_user) = mpsc::channel(MESSAGES);
        let (answers_in, answers) = sync_channel(MESSAGES);
        let (heard_in, heard) = sync_channel(MESSAGES);
        let (welcome_in, welcome) = sync_channel(1);
        let runtime = tokio::runtime::Builder::new_current_thread()
            .enable_all()
            .build()?;
        let thread = std::thread::Builder::new()
            .name("sulcus-watch".into())
            .spawn(move || {
                runtime.block_on(async {
                    let greeted = match greet(&config).await {
                        Ok(greeted) => greeted,
                        Err(error) => return drop(welcome_in.send(Err(error))),
                    };
                    let (endpoint, connection, send, recv, welcome) = greeted;
                    if welcome_in.send(Ok(welcome)).is_err() {
                        return;
                    }
                    let ended = carry(send, recv, &mut from_user, &answers_in, &heard_in).await;
                    // Before the end of the channel: the user asks for the error as soon as nobody takes messages.
                    if let Err(error) = ended {
                        let _ = answers_in.try_send(Err(error));
                    }
                    drop(from_user);
                    connection.close(0u32.into(), b"bye");
                    // Without this wait the close is never sent, and the server keeps the connection until its timeout.
                    let _ = tokio::time::timeout(LAST_PACKETS, endpoint.wait_idle()).await;
                });
            })?;
        let gone = || LinkError::System("the thread of the connection ended unexpectedly".into());
        let welcome = welcome.recv().map_err(|_| gone())??;
        Ok(Self {
            welcome,
            number: 0,
            to_server: Some(to_server),
            answers,
            heard,
            thread: Some(thread),
        })
    }

    /// Welcome of the server: role, id, stations.
    pub fn welcome(&self) -> &Welcome {
        &self.welcome
    }

    /// Sends an instruction and waits for its answer.
    ///
    /// # Errors
    /// The connection is lost, or no answer came within two minutes.
    pub fn instruct(
        &mut self,
        station: &str,
        instruction: Instruction,
    ) -> Result<Answer, LinkError> {
        self.number += 1;
        let message = ClientMessage::Instruct(Instruct {
            number: self.number,
            station: station.to_owned(),
            instruction,
        });
        let lost = || LinkError::Lost("the connection has ended".into());
        let to_server = self.to_server.as_ref().ok_or_else(lost)?;
        if to_server.blocking_send(message).is_err() {
            // The thread has ended and left its error.
            let ended = self.answers.try_iter().find_map(Result::err);
            return Err(ended.unwrap_or_else(lost));
        }
        loop {
            match self.answers.recv_timeout(ANSWER) {
                Ok(Ok(answer)) if answer.number == self.number => return Ok(answer),
                // An answer that came after its timeout.
                Ok(Ok(_)) => {}
                Ok(Err(error)) => return Err(error),
                Err(RecvTimeoutError::Timeout) => {
                    return Err(LinkError::Lost("no answer within two minutes".into()));
                }
                Err(RecvTimeoutError::Disconnected) => return Err(lost()),
            }
        }
    }

    /// Error with which the connection has ended; `None` while it goes on.
    pub fn ended(&mut self) -> Option<LinkError> {
        let to_server = self.to_server.as_ref();
        to_server.is_none_or(mpsc::Sender::is_closed).then(|| {
            let ended = self.answers.try_iter().find_map(Result::err);
            ended.unwrap_or_else(|| LinkError::Lost("the connection has ended".into()))
        })
    }

    /// Next status or event, or `None` after `timeout` or at the end of the connection.
    pub fn next(&mut self, timeout: Duration) -> Option<Heard> {
        self.heard.recv_timeout(timeout).ok()
    }
}

impl Drop for Instructor {
    fn drop(&mut self) {
        // Without a sender the thread closes the connection and ends.
        self.to_server = None;
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

type Greeted = (quinn::Endpoint, Connection, SendStream, RecvStream, Welcome);

async fn greet(config: &LinkConfig) -> Result<Greeted, LinkError> {
    let (endpoint, connection) = reach::reach(config).await?;
    let server = connection.remote_address();
    let greeting = async {
        let opened = connection.open_bi().await;
        let (mut send, mut recv) = opened.map_err(|error| LinkError::Lost(error.to_string()))?;
        control::write(&mut send, &handshake::client_hello(config, Duration::ZERO)).await?;
        match sulcus_link::control::read(&mut recv).await? {
            ServerMessage::Welcome(welcome) => {
                control::write(&mut send, &ClientMessage::Watch).await?;
                Ok((send, recv, welcome))
            }
            ServerMessage::Refused(refused) => Err(handshake::turned_away(refused)),
            _ => Err(CodecError::NotCanonical("the first message is no welcome").into()),
        }
    };
    let greeted = tokio::time::timeout(config.timeout, greeting).await;
    let (send, recv, welcome) = greeted.map_err(|_| LinkError::Absent { server })??;
    Ok((endpoint, connection, send, recv, welcome))
}

/// Carries messages until the connection or its user ends.
async fn carry(
    mut send: SendStream,
    recv: RecvStream,
    from_user: &mut mpsc::Receiver<ClientMessage>,
    answers: &SyncSender<Result<Answer, LinkError>>,
    heard: &SyncSender<Heard>,
) -> Result<(), LinkError> {
    let mut messages = sulcus_link::control::reader(recv);
    loop {
        tokio::select! {
            message = messages.recv() => match message {
                Some(Ok(ServerMessage::Answer(answer))) => {
                    let _ = answers.try_send(Ok(answer));
                }
                // A user who does not read misses the newest, and reads the next ones later.
                Some(Ok(ServerMessage::Status(status))) => {
                    let _ = heard.try_send(Heard::Status(Box::new(status)));
                }
                Some(Ok(ServerMessage::Event(event))) => {
                    let _ = heard.try_send(Heard::Event(event));
                }
                Some(Ok(ServerMessage::Refused(refused))) => return Err(LinkError::Refused(refused.text)),
                Some(Ok(_)) => {
                    return Err(CodecError::NotCanonical("a message that is not for an instructor").into());
                }
                Some(Err(error)) => return Err(error.into()),
                None => return Err(LinkError::Lost("the control stream ended".into())),
            },
            message = from_user.recv() => match message {
                Some(message) => control::write(&mut send, &message).await?,
                None => return Ok(()),
            },
        }
    }
}
