//! A link without threads, sockets and clocks, whose owner carries the bytes and gives the times: for simulations.

use std::collections::VecDeque;
use std::sync::Arc;
use std::time::Duration;

use sulcus_proto::ClientMessage;
use sulcus_proto::control::{Command, Event, ServerHello};

use super::device_end::{DeviceEnd, ends};
use super::packets::Packets;
use super::stats::Shared;
use super::worker::MESSAGES;
use super::{Heard, LinkStats, PosePacket, WrenchPacket};
use crate::at_hand::Out;
use crate::carrier::Carrier;

/// Link in steps: the datagrams and the gate of a [`super::Link`], for a session with ticks at the server.
#[doc(hidden)]
pub struct SteppedLink {
    hello: ServerHello,
    device: DeviceEnd,
    packets: Packets,
    shared: Arc<Shared>,
    /// Messages that wait for the control stream, oldest first.
    messages: VecDeque<ClientMessage>,
}

impl SteppedLink {
    /// Open link after the hello of a server, whose tick and first epoch it has. The hello is not checked.
    pub fn new(hello: ServerHello) -> Self {
        let shared = Arc::new(Shared::new());
        let (device, network) = ends(&shared);
        Self {
            packets: Packets::new(network, hello.tick_ns, hello.epoch, None),
            hello,
            device,
            shared,
            messages: VecDeque::new(),
        }
    }

    /// Datagram of the newest pose, which the network takes. `None`: the pose was given before, the rate leaves it out,
    /// or there is no connection.
    pub fn pose_bytes(&mut self) -> Option<Vec<u8>> {
        let mut taken = None;
        if self.is_connected() {
            self.packets.send_pose(|bytes| {
                taken = Some(bytes.to_vec());
                true
            });
        }
        taken
    }

    /// Arrival of a datagram at `now_ns` over a path with the round trip `rtt`. Without a connection the datagram is
    /// lost.
    pub fn arrived(&mut self, bytes: &[u8], now_ns: u64, rtt: Duration) {
        if self.is_connected() {
            self.packets.arrived(bytes, now_ns, || rtt);
        }
    }

    /// Begin of an epoch on the same connection, as the server tells it.
    pub fn begin_epoch(&mut self, epoch: u32) {
        self.packets.begin_epoch(epoch);
    }

    /// Loss of the connection. Messages and the newest pose wait.
    pub fn leave(&mut self) {
        self.shared.leave();
    }

    /// Return to the session over a new connection, under a new epoch.
    pub fn come_back(&mut self, epoch: u32) {
        self.packets.begin_epoch(epoch);
        self.shared.come_back();
    }

    /// End of the link: the goodbye, or a connection that is lost for good.
    pub fn close(&mut self) {
        self.shared.close();
    }

    /// Next event or command for the server. `None`: no message waits, or there is no connection.
    pub fn next_message(&mut self) -> Option<ClientMessage> {
        if !self.is_connected() {
            return None;
        }
        self.messages.pop_front()
    }

    /// Counters and times of packets so far.
    pub fn stats(&self) -> LinkStats {
        self.device.stats()
    }

    fn is_connected(&self) -> bool {
        self.device.is_open() && !self.device.is_returning()
    }

    /// Queues a message. `false`: the link has ended, or the queue is full.
    fn say(&mut self, message: ClientMessage) -> bool {
        let fits = self.device.is_open() && self.messages.len() < MESSAGES;
        if fits {
            self.messages.push_back(message);
        }
        fits
    }
}

impl Carrier for SteppedLink {
    fn hello(&self) -> &ServerHello {
        &self.hello
    }

    fn send_pose(&mut self, pose: &PosePacket) {
        self.device.send_pose(pose);
    }

    fn latest_wrench(&mut self) -> Option<WrenchPacket> {
        self.device.latest_wrench()
    }

    fn force_gate(&mut self, now_ns: u64) -> f64 {
        self.device.force_gate(now_ns)
    }

    fn send_row(&mut self, _: Out) -> bool {
        false
    }

    fn restarts(&self) -> u32 {
        self.device.restarts()
    }

    fn command(&mut self, command: Command) -> bool {
        self.say(ClientMessage::Command(command))
    }

    fn event(&mut self, event: Event) -> bool {
        self.say(ClientMessage::Event(event))
    }

    fn heard(&mut self) -> Option<Heard> {
        None
    }

    fn is_open(&self) -> bool {
        self.device.is_open()
    }

    fn is_returning(&self) -> bool {
        self.device.is_returning()
    }
}

#[cfg(test)]
mod tests;
