//! The link to a server: poses up and wrenches down at 1 kHz, control messages beside them.
//!
//! A thread of its own carries the packets. The device's thread only calls [`Link::send_pose`],
//! [`Link::latest_wrench`] and [`Link::force_gate`], none of which blocks, locks or allocates: the
//! newest pose and the newest wrench win, and when wrenches stop coming the gate takes the force to
//! zero smoothly.
//!
//! All times are nanoseconds of this machine's monotonic clock, as [`now_ns`] reads it; no clock
//! is compared between machines.

mod config;
mod control;
mod error;
mod handshake;
mod reach;
mod stats;
mod transport;
mod trust;
mod worker;

use std::sync::Arc;
use std::sync::mpsc::{Receiver, RecvTimeoutError};
use std::thread::JoinHandle;
use std::time::Duration;

use sulcus_proto::control::{ButtonEdge, Command, Event, Goodbye, ServerHello};
use sulcus_proto::datagram::ToolPose;
use sulcus_proto::{ClientMessage, SessionSummary, TOOLS, WrenchDatagram};
use tokio::sync::mpsc::Sender;
use triple_buffer::{Input, Output};

pub use config::{LinkConfig, Pin};
pub use error::LinkError;
pub use stats::LinkStats;
use sulcus_haptics::Watchdog;
pub use sulcus_link::clock::monotonic_ns as now_ns;
pub use transport::client_config;

use stats::Shared;
use sulcus_link::Bell;

/// Time that a server has to finish and sign a recording after a stop.
const GOODBYE: Duration = Duration::from_secs(20);

/// What a device measured at one moment.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PosePacket {
    /// When, by [`now_ns`].
    pub device_time_ns: u64,
    /// Per tool slot: `world_from_tool` at the device point, buttons, and the wrench that the device
    /// displayed last (after gate and limits).
    pub tools: [ToolPose; TOOLS],
}

/// A wrench and when it came.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WrenchPacket {
    /// What the server sent: per tool force (N) and torque (N m), world axes, about the device point.
    pub datagram: WrenchDatagram,
    /// Arrival, by [`now_ns`].
    pub arrived_ns: u64,
    /// Age of the pose that it answers when it arrived; `None` before the server had a pose.
    pub age_ns: Option<u64>,
}

impl WrenchPacket {
    /// [`WrenchPacket::age_ns`] in milliseconds.
    pub fn age_ms(&self) -> Option<f64> {
        self.age_ns.map(|age| age as f64 / 1e6)
    }
}

/// A connection to a server, held by the device's thread. Dropping it closes the connection at once.
pub struct Link {
    hello: ServerHello,
    poses: Input<PosePacket>,
    wrenches: Output<Option<WrenchPacket>>,
    bell: Bell,
    watchdog: Watchdog,
    messages: Option<Sender<ClientMessage>>,
    goodbye: Receiver<Result<Goodbye, LinkError>>,
    shared: Arc<Shared>,
    thread: Option<JoinHandle<()>>,
}

impl Link {
    /// Connects and says hello; blocks until the server has answered. The simulation begins with
    /// [`Link::start`].
    ///
    /// # Errors
    /// No server, another certificate or version, a wrong token, a busy station: one sentence each.
    pub fn connect(config: LinkConfig) -> Result<Link, LinkError> {
        worker::spawn(config)
    }

    /// What the server said of scene, tools and exercise.
    pub fn hello(&self) -> &ServerHello {
        &self.hello
    }

    /// Begins to simulate and record. `false`: the link has ended.
    pub fn start(&self) -> bool {
        self.say(ClientMessage::Start)
    }

    /// Offers a pose. The newest wins: one that was not sent yet is replaced.
    pub fn send_pose(&mut self, pose: &PosePacket) {
        self.poses.write(*pose);
        self.shared.offered();
        self.bell.ring();
    }

    /// The newest wrench that ever arrived. Ask [`Link::force_gate`] how much of it to display.
    pub fn latest_wrench(&mut self) -> Option<WrenchPacket> {
        if self.wrenches.update()
            && let Some(packet) = self.wrenches.output_buffer()
        {
            self.watchdog.heard(packet.arrived_ns);
        }
        *self.wrenches.output_buffer()
    }

    /// Share of the force to display at `now_ns`, 0 to 1, to be asked once per period of the device:
    /// falls to zero when no wrench has come for 20 ms, rises when they come again, never jumps.
    pub fn force_gate(&mut self, now_ns: u64) -> f64 {
        self.latest_wrench();
        self.watchdog.gate(now_ns)
    }

    /// Asks for a pause of the student's own, its end, or a lower force limit. What the station's side has set stands.
    /// `false`: it was not taken.
    pub fn command(&self, command: Command) -> bool {
        self.say(ClientMessage::Command(command))
    }

    /// Reports a button edge, which must not be lost. `false`: it was not taken.
    pub fn button(&self, edge: ButtonEdge) -> bool {
        self.say(ClientMessage::Button(edge))
    }

    /// Puts something into the recording. `false`: it was not taken.
    pub fn event(&self, event: Event) -> bool {
        self.say(ClientMessage::Event(event))
    }

    /// Whether the link carries packets; `false` after the server's goodbye or a lost connection.
    pub fn is_open(&self) -> bool {
        !self.shared.is_closed()
    }

    /// How packets have fared. Takes a lock: not for the device's loop.
    pub fn stats(&self) -> LinkStats {
        self.shared.stats()
    }

    /// Stops the session and waits for the server's goodbye.
    ///
    /// # Errors
    /// If the connection was lost or the server does not answer.
    pub fn finish(self) -> Result<SessionSummary, LinkError> {
        self.finish_with_text().map(|goodbye| goodbye.summary)
    }

    /// As [`Link::finish`], with the server's last sentence.
    ///
    /// # Errors
    /// If the connection was lost or the server does not answer.
    pub fn finish_with_text(self) -> Result<Goodbye, LinkError> {
        // Not taken: it has ended already, and the reason waits in the channel.
        self.say(ClientMessage::Stop);
        match self.goodbye.recv_timeout(GOODBYE) {
            Ok(result) => result,
            Err(RecvTimeoutError::Timeout) => Err(LinkError::NoGoodbye),
            Err(RecvTimeoutError::Disconnected) => {
                Err(LinkError::Lost("the link's thread has ended".into()))
            }
        }
    }

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
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}
