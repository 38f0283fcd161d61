//! The link's task: one connection.

use std::sync::Arc;
use std::sync::mpsc::{SyncSender, sync_channel};

use quinn::{Connection, Endpoint, RecvStream, SendStream};
use sulcus_link::Bell;
use sulcus_link::control::ReadError;
use sulcus_program::tell;
use sulcus_proto::control::Goodbye;
use sulcus_proto::datagram::Echo;
use sulcus_proto::newest::Arrival;
use sulcus_proto::{ClientMessage, CodecError, PoseDatagram, ServerMessage, TOOLS, WrenchDatagram};
use tokio::sync::mpsc::{Receiver, channel};
use triple_buffer::{Input, Output, triple_buffer};

use super::handshake::{Welcome, shake};
use super::network::Network;
use super::returning::Returning;
use super::stats::Shared;
use super::{
    LAST_PACKETS, Link, LinkConfig, LinkError, PosePacket, Watchdog, WrenchPacket, control, now_ns,
};

/// Largest number of messages that wait to be written.
const MESSAGES: usize = 64;

/// Starts a link on `network` and waits for the result of the handshake.
pub(super) fn spawn(config: LinkConfig, network: Arc<Network>) -> Result<Link, LinkError> {
    let shared = Arc::new(Shared::new());
    let bell = Bell::new()?;
    let (poses, poses_out) = triple_buffer(&PosePacket::default());
    let (wrenches_in, wrenches) = triple_buffer(&None);
    let (messages, messages_out) = channel(MESSAGES);
    let (answer_in, answer) = sync_channel(1);
    let (goodbye_in, goodbye) = sync_channel(1);
    let (ended_in, ended) = sync_channel::<()>(1);
    let (worker_shared, worker_bell) = (shared.clone(), bell.clone());
    network.spawn(async move {
        // Dropped at the end of the task, also after a panic: the drop of the link waits for this end.
        let _ended = ended_in;
        let welcome = match shake(&config).await {
            Ok(welcome) => welcome,
            // The starter of the task waits for this message.
            Err(error) => return drop(answer_in.send(Err(error))),
        };
        let Welcome {
            endpoint,
            connection,
            send,
            recv,
            hello,
        } = welcome;
        let worker = Worker {
            returning: Returning::new(config, &hello),
            epoch: hello.epoch,
            endpoint,
            connection,
            send,
            poses: poses_out,
            wrenches: wrenches_in,
            bell: worker_bell,
            shared: worker_shared,
            sequence: 0,
            answered: [None; TOOLS],
        };
        if answer_in.send(Ok(hello)).is_ok() {
            worker.run(recv, messages_out, goodbye_in).await;
        }
    });
    let lost = || LinkError::System("the link's task ended unexpectedly".into());
    let hello = answer.recv().map_err(|_| lost())??;
    Ok(Link {
        hello,
        poses,
        wrenches,
        bell,
        watchdog: Watchdog::new(),
        messages: Some(messages),
        goodbye,
        shared,
        ended,
        _network: network,
    })
}

type Answers = Receiver<Result<ServerMessage, ReadError>>;

struct Worker {
    endpoint: Endpoint,
    connection: Connection,
    send: SendStream,
    epoch: u32,
    poses: Output<PosePacket>,
    wrenches: Input<Option<WrenchPacket>>,
    bell: Bell,
    shared: Arc<Shared>,
    sequence: u32,
    /// For each tool the number of the reading answered last.
    answered: [Option<u32>; TOOLS],
    returning: Returning,
}

impl Worker {
    async fn run(
        mut self,
        recv: RecvStream,
        messages: Receiver<ClientMessage>,
        goodbye: SyncSender<Result<Goodbye, LinkError>>,
    ) {
        let mut messages = messages;
        let mut answers = sulcus_link::control::reader(recv);
        let result = loop {
            let error = match self.live(&mut answers, &mut messages).await {
                Ok(goodbye) => break Ok(goodbye),
                Err(error) => error,
            };
            if !self.returning.is_possible(&error) {
                break Err(error);
            }
            tracing::warn!("{error}; trying to return to the session");
            self.shared.leave();
            self.connection.close(0u32.into(), b"lost");
            let welcome = match self.returning.come_back(self.epoch, &mut messages).await {
                Ok(welcome) => welcome,
                Err(error) => break Err(error),
            };
            tracing::warn!("returned to the session");
            self.endpoint = welcome.endpoint;
            self.connection = welcome.connection;
            self.send = welcome.send;
            answers = sulcus_link::control::reader(welcome.recv);
            self.begin_epoch(welcome.hello.epoch);
            self.shared.come_back();
        };
        self.shared.close();
        self.connection.close(0u32.into(), b"goodbye");
        // An error means that the link was dropped.
        let _ = goodbye.try_send(result);
        let _ = tokio::time::timeout(LAST_PACKETS, self.endpoint.wait_idle()).await;
    }

    /// Carries packets until the goodbye, an error, or the drop of the link.
    async fn live(
        &mut self,
        answers: &mut Answers,
        messages: &mut Receiver<ClientMessage>,
    ) -> Result<Goodbye, LinkError> {
        // Messages from before a return go first.
        while let Some(message) = self.returning.next_pending() {
            control::write(&mut self.send, &message).await?;
        }
        let listening = self.bell.listen()?;
        let mut connected = true;
        loop {
            tokio::select! {
                ready = listening.readable() => {
                    if let Ok(mut ready) = ready {
                        self.bell.silence();
                        ready.clear_ready();
                    }
                    self.send_pose();
                }
                datagram = self.connection.read_datagram(), if connected => match datagram {
                    Ok(bytes) => self.arrived(&bytes),
                    // The reader of the control stream may still hold a goodbye.
                    Err(_) => connected = false,
                },
                answer = answers.recv() => match answer {
                    Some(Ok(ServerMessage::Goodbye(goodbye))) => return Ok(goodbye),
                    Some(Ok(ServerMessage::Epoch(epoch))) => self.begin_epoch(epoch),
                    Some(Ok(ServerMessage::Say(say))) => {
                        tell!("message of the instructor: {}", printable(&say.text));
                    }
                    Some(Ok(ServerMessage::Refused(refused))) => return Err(LinkError::Refused(refused.text)),
                    Some(Ok(_)) => {
                        return Err(LinkError::Protocol(CodecError::NotCanonical(
                            "a message that the server does not send to a student in a session",
                        )));
                    }
                    Some(Err(error)) => return Err(error.into()),
                    None => return Err(LinkError::Lost("the control stream ended".into())),
                },
                message = messages.recv() => match message {
                    Some(message) => {
                        self.returning.sent(&message);
                        control::write(&mut self.send, &message).await?;
                    }
                    // The link was dropped.
                    None => {
                        self.returning.forbid();
                        return Err(LinkError::Lost("closed by this client".into()));
                    }
                },
            }
        }
    }

    /// Takes a new epoch. Datagrams of other epochs are ignored. The sequences of both ends go on; the filter accepts
    /// any first sequence.
    fn begin_epoch(&mut self, epoch: u32) {
        self.epoch = epoch;
        self.shared.count(|numbers| numbers.filter.restart());
    }

    /// Sends the newest pose, unless it was sent before or holds a number that is not finite.
    fn send_pose(&mut self) {
        if !self.poses.update() {
            return;
        }
        let PosePacket { tools } = *self.poses.output_buffer();
        let datagram = PoseDatagram {
            epoch: self.epoch,
            sequence: self.sequence,
            tools,
        };
        let Ok(bytes) = datagram.to_bytes() else {
            return;
        };
        // A full buffer drops its oldest datagram. The reader of the control stream detects a closed connection.
        if self.connection.send_datagram(bytes.to_vec().into()).is_ok() {
            self.sequence = self.sequence.wrapping_add(1);
            self.shared.count(|numbers| numbers.sent += 1);
        }
    }

    /// Takes one datagram: counts it, and hands the newest wrench of the present epoch to the device's thread.
    fn arrived(&mut self, bytes: &[u8]) {
        let arrived_ns = now_ns();
        let Ok(datagram) = WrenchDatagram::from_bytes(bytes) else {
            return self.shared.count(|numbers| numbers.malformed += 1);
        };
        if datagram.epoch != self.epoch {
            return self.shared.count(|numbers| numbers.foreign += 1);
        }
        // The first tool that has an answer stands for both.
        let echoes = datagram.tools.iter().map(|tool| tool.echo).enumerate();
        let answer = echoes.into_iter().find(|(_, echo)| echo.valid);
        let age = |echo: &Echo| arrived_ns.saturating_sub(echo.device_time_ns);
        let newest = self.shared.count(|numbers| {
            let newest = numbers.filter.judge(datagram.sequence) == Arrival::Newest;
            if let Some((tool, echo)) = answer
                && newest
                && self.answered[tool] != Some(echo.sequence)
            {
                self.answered[tool] = Some(echo.sequence);
                numbers.answered(age(&echo), echo.hold_us);
            }
            newest
        });
        if newest {
            self.wrenches.write(Some(WrenchPacket {
                datagram,
                arrived_ns,
                age_ns: answer.map(|(_, echo)| age(&echo)),
            }));
        }
    }
}

/// Text of a peer without control characters.
fn printable(text: &str) -> String {
    text.chars().filter(|c| !c.is_control()).collect()
}
