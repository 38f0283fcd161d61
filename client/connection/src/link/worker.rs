//! The link's task: one connection.

use std::sync::Arc;
use std::sync::mpsc::{SyncSender, sync_channel};
use std::time::Duration;

use quinn::{Connection, Endpoint, RecvStream, SendStream};
use sulcus_link::Bell;
use sulcus_link::control::ReadError;
use sulcus_link::ladder::Ladder;
use sulcus_proto::control::Goodbye;
use sulcus_proto::datagram::Echo;
use sulcus_proto::newest::Arrival;
use sulcus_proto::reception::Meter;
use sulcus_proto::{ClientMessage, CodecError, PoseDatagram, ServerMessage, TOOLS, WrenchDatagram};
use tokio::sync::mpsc::{Receiver, channel};
use tokio::task::JoinHandle;
use tokio::time::Instant;
use triple_buffer::{Input, Output, triple_buffer};

use super::handshake::{Welcome, shake};
use super::heard::Ear;
use super::network::Network;
use super::returning::Returning;
use super::stats::Shared;
use super::{
    LAST_PACKETS, Link, LinkConfig, LinkError, PosePacket, Watchdog, WrenchPacket, control, now_ns,
};
use crate::at_hand::TickPlace;
use crate::at_hand::outbox::{Outbox, Rows, pack, write};

/// Largest number of messages that wait to be written.
const MESSAGES: usize = 64;

/// Longest wait of a stop for the inputs of ticks at the hand.
const HAND_IN: Duration = Duration::from_secs(540);

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
    let (ear, heard) = Ear::new();
    let (rows, mut at_hand) = match config.tick {
        TickPlace::Server => (None, None),
        TickPlace::Hand | TickPlace::Auto => {
            let (rows, ring, outbox) = Rows::new();
            (Some(rows), Some((ring, outbox)))
        }
    };
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
        let at_hand = at_hand.take().filter(|_| hello.plan.tick_at_hand);
        let outbox = at_hand.map(|(ring, outbox)| {
            let shared = worker_shared.clone();
            let is_connected = move || !shared.is_returning();
            tokio::spawn(pack(ring, outbox.clone(), hello.tick_ns, is_connected));
            outbox
        });
        let worker = Worker {
            outbox,
            stopping: None,
            returning: Returning::new(config, &hello),
            epoch: hello.epoch,
            ear,
            endpoint,
            connection,
            send,
            tick_ns: hello.tick_ns,
            meter: Meter::new(),
            ladder: Ladder::new(hello.tick_ns),
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
        rows,
        watchdog: Watchdog::new(),
        messages: Some(messages),
        heard,
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
    /// Period of the ticks, nanoseconds.
    tick_ns: u64,
    /// Quality of the way of the wrenches.
    meter: Meter,
    /// Rate of the poses.
    ladder: Ladder,
    poses: Output<PosePacket>,
    wrenches: Input<Option<WrenchPacket>>,
    bell: Bell,
    shared: Arc<Shared>,
    sequence: u32,
    /// For each tool the number of the reading answered last.
    answered: [Option<u32>; TOOLS],
    returning: Returning,
    ear: Ear,
    /// Batches of ticks at the hand; `None` if the server ticks.
    outbox: Option<Arc<Outbox>>,
    /// Time at which a stop goes even if the server has not computed all ticks at the hand. `None`: no stop waits.
    stopping: Option<Instant>,
}

/// Task that ends with its owner.
struct Task(JoinHandle<()>);

impl Drop for Task {
    fn drop(&mut self) {
        self.0.abort();
    }
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
            if let Some(outbox) = &self.outbox
                && !welcome.hello.resumed
            {
                // The server has lost the session: the hand waits for the begin of a new one.
                self.wrenches.write(None);
                self.shared.restart();
                outbox.begin(self.shared.restarts());
            }
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
            self.say(message).await?;
        }
        let _writing = self.outbox.as_ref().map(|outbox| {
            outbox.rewind();
            Task(tokio::spawn(write(self.connection.clone(), outbox.clone())))
        });
        if self.stopping.is_some() {
            self.say_last_tick().await?;
        }
        let mut listening = self.bell.listen()?;
        let mut connected = true;
        loop {
            let outbox = self.outbox.clone();
            let emptied = async {
                match (outbox, self.stopping) {
                    (Some(outbox), Some(until)) => {
                        let _ = tokio::time::timeout_at(until, outbox.emptied()).await;
                    }
                    _ => std::future::pending().await,
                }
            };
            tokio::select! {
                () = emptied => {
                    self.stopping = None;
                    control::write(&mut self.send, &ClientMessage::Stop).await?;
                }
                () = listening.rung() => self.send_pose(),
                datagram = self.connection.read_datagram(), if connected => match datagram {
                    Ok(bytes) => self.arrived(&bytes),
                    // The reader of the control stream may still hold a goodbye.
                    Err(_) => connected = false,
                },
                answer = answers.recv() => match answer {
                    Some(Ok(ServerMessage::Goodbye(goodbye))) => return Ok(goodbye),
                    Some(Ok(ServerMessage::Epoch(epoch))) => self.begin_epoch(epoch),
                    Some(Ok(ServerMessage::Say(say))) => self.ear.say(&say),
                    Some(Ok(ServerMessage::Ghost(part))) => self.ear.ghost(&part)?,
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
                        self.say(message).await?;
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

    /// Writes a message. The stop of a session with ticks at the hand waits until the server has computed all of them.
    async fn say(&mut self, message: ClientMessage) -> Result<(), LinkError> {
        let waits = self
            .outbox
            .as_ref()
            .is_some_and(|outbox| !outbox.is_empty());
        if message == ClientMessage::Stop && waits {
            self.stopping = Some(Instant::now() + HAND_IN);
            return self.say_last_tick().await;
        }
        control::write(&mut self.send, &message).await
    }

    /// Names the last tick at the hand: the server then expects no newer one.
    async fn say_last_tick(&mut self) -> Result<(), LinkError> {
        match self.outbox.as_ref().and_then(|outbox| outbox.end()) {
            Some(last) => control::write(&mut self.send, &last).await,
            None => Ok(()),
        }
    }

    /// Takes a new epoch. Datagrams of other epochs are ignored. The sequences of both ends go on; the filter accepts
    /// any first sequence.
    fn begin_epoch(&mut self, epoch: u32) {
        self.epoch = epoch;
        // The path may be another one.
        self.meter = Meter::new();
        self.ladder.restart();
        self.shared.count(|numbers| numbers.filter.restart());
    }

    /// Sends the newest pose, unless it was sent before or holds a number that is not finite.
    fn send_pose(&mut self) {
        // The device's loop sends few live poses of ticks at the hand, and no rate of them falls.
        if !self.poses.update() || self.outbox.is_none() && !self.ladder.sends() {
            return;
        }
        let PosePacket { tools, tick, run } = *self.poses.output_buffer();
        if self.outbox.is_some() && run != self.shared.restarts() {
            return;
        }
        let datagram = PoseDatagram {
            epoch: self.epoch,
            sequence: self.sequence,
            tools,
            reception: self.meter.value(),
            tick,
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
                numbers.answered(age(&echo), &echo);
            }
            if newest && self.outbox.is_none() {
                // The points of the server's grid are its clock, on which skipped ticks count.
                let sent_ns = datagram.tick.wrapping_mul(self.tick_ns);
                self.meter
                    .arrived(arrived_ns, sent_ns, numbers.filter.counts());
                let rtt = || self.connection.rtt();
                self.ladder.told(arrived_ns, datagram.reception, rtt);
                numbers.divisor = self.ladder.divisor();
                numbers.falls = self.ladder.falls();
            }
            newest
        });
        if let Some(outbox) = &self.outbox {
            outbox.computed(datagram.tick);
        }
        if newest {
            self.wrenches.write(Some(WrenchPacket {
                datagram,
                arrived_ns,
                age_ns: answer.map(|(_, echo)| age(&echo)),
            }));
        }
    }
}
