//! The link to a server: poses to the server and wrenches back, once per tick, and control messages.
//!
//! A thread carries the packets of one link, or of several. The device's thread only calls [`Link::send_pose`],
//! [`Link::latest_wrench`] and [`Link::force_gate`], none of which blocks, locks or allocates. The newest pose and the
//! newest wrench win. When no wrench arrives, the gate ramps the force to zero.
//!
//! A lost connection does not end a started session: the link connects again with the same token, for as long as the
//! server's plan allows, and the session goes on under a new epoch.
//!
//! All times are nanoseconds of this machine's monotonic clock, as [`now_ns`] reads it. No clock is compared between
//! machines.

mod config;
pub(crate) mod control;
mod device_end;
mod error;
pub(crate) mod handshake;
mod heard;
mod network;
mod packets;
mod path;
pub(crate) mod reach;
mod returning;
mod stats;
mod stepped;
mod transport;
mod trust;
mod worker;

use std::sync::Arc;
use std::sync::mpsc::{Receiver, RecvTimeoutError};
use std::time::Duration;

use sulcus_proto::control::{ButtonEdge, Command, Event, Goodbye, ServerHello};
use sulcus_proto::{ClientMessage, SessionSummary};
use tokio::sync::mpsc::Sender;

pub use config::{LinkConfig, Pin};
pub use error::LinkError;
pub use heard::Heard;
pub use network::Network;
pub use packets::{PosePacket, WrenchPacket};
pub use path::{PathFigures, measure_path};
pub use stats::LinkStats;
#[doc(hidden)]
pub use stepped::SteppedLink;
pub use sulcus_link::clock::monotonic_ns as now_ns;
pub use transport::client_config;

use crate::at_hand::outbox::{Out, Rows};
use device_end::DeviceEnd;
use sulcus_link::Bell;

/// Timeout for the last packets after the close of a connection.
pub(crate) const LAST_PACKETS: Duration = Duration::from_millis(500);
/// Timeout for the goodbye after a stop. In this time the server finishes and signs the recording.
const GOODBYE: Duration = Duration::from_secs(20);
/// The same for ticks at the hand, whose inputs may have to be handed in first.
const GOODBYE_AT_HAND: Duration = Duration::from_secs(600);

/// A connection to a server, held by the device's thread. A drop closes the connection without a stop, and blocks until
/// the link's task has ended.
pub struct Link {
    hello: ServerHello,
    device: DeviceEnd,
    bell: Bell,
    /// Rows of ticks at the hand, if the client asked for them.
    rows: Option<Rows>,
    messages: Option<Sender<ClientMessage>>,
    heard: Receiver<Heard>,
    goodbye: Receiver<Result<Goodbye, LinkError>>,
    /// Disconnected at the end of the link's task.
    ended: Receiver<()>,
    _network: Arc<Network>,
}

impl Link {
    /// Connects and sends the hello. Blocks until the server's answer or the timeout. The simulation begins with
    /// [`Link::start`].
    ///
    /// # Errors
    /// No answer, another certificate or version, a refusal, an invalid hello, or a system without threads or sockets.
    pub fn connect(config: LinkConfig) -> Result<Link, LinkError> {
        Self::connect_on(config, Arc::new(Network::start()?))
    }

    /// Connects like [`Link::connect`], on a thread that other links may share.
    ///
    /// # Errors
    /// The errors of [`Link::connect`].
    pub fn connect_on(config: LinkConfig, network: Arc<Network>) -> Result<Link, LinkError> {
        worker::spawn(config, network)
    }

    /// Hello of the server: scene, tools, exercise, limits, tick.
    pub fn hello(&self) -> &ServerHello {
        &self.hello
    }

    /// Queues the start of simulation and recording. `false`: not queued, because the link has ended or 64 messages
    /// wait.
    pub fn start(&self) -> bool {
        self.say(ClientMessage::Start)
    }

    /// Offers a pose. The pose replaces an older one that was not sent yet.
    pub fn send_pose(&mut self, pose: &PosePacket) {
        self.device.send_pose(pose);
        self.bell.ring();
    }

    /// Whether the ticks of this session run at the hand. The device's loop then computes them.
    pub fn ticks_at_hand(&self) -> bool {
        self.hello.plan.tick_at_hand && self.rows.is_some()
    }

    /// Number of times that the ticks at the hand begin again from the first one: the server has restarted and lost the
    /// session. Rows name this number.
    pub fn restarts(&self) -> u32 {
        self.device.restarts()
    }

    /// Queues the row of a tick at the hand. Wait-free. `false`: the rows cannot be handed in, and the session cannot
    /// go on.
    pub fn send_row(&mut self, out: Out) -> bool {
        self.rows.as_mut().is_some_and(|rows| rows.push(out))
    }

    /// Newest wrench so far, also after the end of the link; `None` before the first one. [`Link::force_gate`] gives
    /// the share of the force to display.
    pub fn latest_wrench(&mut self) -> Option<WrenchPacket> {
        self.device.latest_wrench()
    }

    /// Share of the force to display at `now_ns`, 0 to 1. The device's loop calls this once per period.
    ///
    /// After 20 ms without a wrench the share falls to zero within 20 ms. With wrenches it rises to one within 100 ms.
    pub fn force_gate(&mut self, now_ns: u64) -> f64 {
        self.device.force_gate(now_ns)
    }

    /// Queues a pause of the student, its end, or a lower force limit. The station's pause and limit stay in force.
    /// `false`: not queued, because the link has ended or 64 messages wait.
    pub fn command(&self, command: Command) -> bool {
        self.say(ClientMessage::Command(command))
    }

    /// Queues a button edge, which travels on the reliable stream. `false`: not queued, because the link has ended or
    /// 64 messages wait.
    pub fn button(&self, edge: ButtonEdge) -> bool {
        self.say(ClientMessage::Button(edge))
    }

    /// Queues an event for the recording. The server may drop it: see `SessionSummary::edges_dropped`. `false`: not
    /// queued, because the link has ended or 64 messages wait.
    pub fn event(&self, event: Event) -> bool {
        self.say(ClientMessage::Event(event))
    }

    /// Next message of an instructor; `None`: no message waits. The call neither blocks nor locks.
    pub fn heard(&self) -> Option<Heard> {
        self.heard.try_recv().ok()
    }

    /// Whether the link carries packets or tries to. `false` after the server's goodbye, an invalid message, or a lost
    /// connection without a return.
    pub fn is_open(&self) -> bool {
        self.device.is_open()
    }

    /// Whether the connection is lost and the link tries to return to the session.
    pub fn is_returning(&self) -> bool {
        self.device.is_returning()
    }

    /// Counters and times of packets so far. The call takes a lock, so the device's loop must not use it.
    pub fn stats(&self) -> LinkStats {
        let stats = self.device.stats();
        match &self.rows {
            Some(rows) if self.ticks_at_hand() => LinkStats {
                ticks_behind: rows.outbox().behind(),
                bytes_per_tick: rows.outbox().bytes_per_tick(),
                ..stats
            },
            _ => stats,
        }
    }

    /// Stops the session and returns the summary of the server's goodbye.
    ///
    /// # Errors
    /// The errors of [`Link::finish_with_text`].
    pub fn finish(self) -> Result<SessionSummary, LinkError> {
        self.finish_with_text().map(|goodbye| goodbye.summary)
    }

    /// Stops the session and waits for the server's goodbye: summary and text. Blocks at most about 20 seconds.
    ///
    /// # Errors
    /// The connection was lost, the server violated the protocol, or no goodbye came within the timeout.
    pub fn finish_with_text(self) -> Result<Goodbye, LinkError> {
        // An error means that the link has ended; the channel then holds the result. The queue of 64 messages may be
        // full: the stop waits for a place.
        if let Some(messages) = &self.messages {
            let _ = messages.blocking_send(ClientMessage::Stop);
        }
        let patience = if self.ticks_at_hand() {
            GOODBYE_AT_HAND
        } else {
            GOODBYE
        };
        match self.goodbye.recv_timeout(patience) {
            Ok(result) => result,
            Err(RecvTimeoutError::Timeout) => Err(LinkError::NoGoodbye),
            Err(RecvTimeoutError::Disconnected) => {
                Err(LinkError::Lost("the link's task has ended".into()))
            }
        }
    }

    /// Queues a message. `false`: the link has ended, or the queue of 64 messages is full.
    fn say(&self, message: ClientMessage) -> bool {
        self.messages
            .as_ref()
            .is_some_and(|messages| messages.try_send(message).is_ok())
    }
}

impl Drop for Link {
    fn drop(&mut self) {
        // Without a sender the worker closes the connection and ends.
        self.messages = None;
        let _ = self.ended.recv();
    }
}
