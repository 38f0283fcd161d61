//! The link's task: one connection.

use std::sync::Arc;
use std::sync::mpsc::{SyncSender, sync_channel};
use std::time::Duration;

use quinn::{Connection, Endpoint, RecvStream, SendStream};
use sulcus_link::Bell;
use sulcus_link::control::ReadError;
use sulcus_proto::control::Goodbye;
use sulcus_proto::{ClientMessage, CodecError, ServerMessage};
use tokio::sync::mpsc::{Receiver, channel};
use tokio::task::JoinHandle;
use tokio::time::Instant;

use super::device_end;
use super::handshake::{Welcome, shake};
use super::heard::Ear;
use super::network::Network;
use super::packets::Packets;
use super::returning::Returning;
use super::stats::Shared;
use super::{LAST_PACKETS, Link, LinkConfig, LinkError, control, now_ns};
use crate::at_hand::TickPlace;
use crate::at_hand::outbox::{Outbox, Rows, pack, write};

/// Largest number of messages that wait to be written.
pub(super) const MESSAGES: usize = 64;

/// Longest wait of a stop for the inputs of ticks at the hand.
const HAND_IN: Duration = Duration::from_secs(540);

/// Starts a link on `network` and waits for the result of the handshake.
pub(super) fn spawn(config: LinkConfig, network: Arc<Network>) -> Result<Link, LinkError> {
    let shared = Arc::new(Shared::new());
    let bell = Bell::new()?;
    let (device, network_end) = device_end::ends(&shared);
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
    let worker_bell = bell.clone();
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
            let shared = shared.clone();
            let is_connected = move || !shared.is_returning();
            tokio::spawn(pack(ring, outbox.clone(), hello.tick_ns, is_connected));
            outbox
        });
        let worker = Worker {
            packets: Packets::new(network_end, hello.tick_ns, hello.epoch, outbox.clone()),
            outbox,
            stopping: None,
            returning: Returning::new(config, &hello),
            ear,
            endpoint,
            connection,
            send,
            bell: worker_bell,
            shared,
        };
        if answer_in.send(Ok(hello)).is_ok() {
            worker.run(recv, messages_out, goodbye_in).await;
        }
    });
    let lost = || LinkError::System("the link's task ended unexpectedly".into());
    let hello = answer.recv().map_err(|_| lost())??;
    Ok(Link {
        hello,
        device,
        bell,
        rows,
        messages: Some(messages),
        heard,
        goodbye,
        ended,
        _network: network,
    })
}

type Answers = Receiver<Result<ServerMessage, ReadError>>;

struct Worker {
    endpoint: Endpoint,
    connection: Connection,
    send: SendStream,
    /// Datagrams of the connection.
    packets: Packets,
    bell: Bell,
    shared: Arc<Shared>,
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
            let epoch = self.packets.epoch();
            let welcome = match self.returning.come_back(epoch, &mut messages).await {
                Ok(welcome) => welcome,
                Err(error) => break Err(error),
            };
            tracing::warn!("returned to the session");
            self.endpoint = welcome.endpoint;
            self.connection = welcome.connection;
            self.send = welcome.send;
            answers = sulcus_link::control::reader(welcome.recv);
            self.packets.begin_epoch(welcome.hello.epoch);
            if !welcome.hello.resumed {
                self.packets.begin_run();
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
                    Ok(bytes) => {
                        let rtt = || self.connection.rtt();
                        self.packets.arrived(&bytes, now_ns(), rtt);
                    }
                    // The reader of the control stream may still hold a goodbye.
                    Err(_) => connected = false,
                },
                answer = answers.recv() => match answer {
                    Some(Ok(ServerMessage::Goodbye(goodbye))) => return Ok(goodbye),
                    Some(Ok(ServerMessage::Epoch(epoch))) => self.packets.begin_epoch(epoch),
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

    /// Gives the newest pose to QUIC.
    fn send_pose(&mut self) {
        // A full buffer drops its oldest datagram. The reader of the control stream detects a closed connection.
        let take = |bytes: &[u8]| self.connection.send_datagram(bytes.to_vec().into()).is_ok();
        self.packets.send_pose(take);
    }
}
