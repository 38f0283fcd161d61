//! Calls of the device's loop to its link, as a trait.

use sulcus_proto::control::{Command, Event, ServerHello};

use crate::at_hand::Out;
use crate::link::{Heard, Link, PosePacket, WrenchPacket};

/// Carrier of a session's packets, with the calls of the device's loop. Poses, wrenches and the gate neither block,
/// lock nor allocate at a [`Link`].
pub trait Carrier {
    /// Hello of the server: limits and tick.
    fn hello(&self) -> &ServerHello;

    /// Offers a pose. The pose replaces an older one that was not sent yet.
    fn send_pose(&mut self, pose: &PosePacket);

    /// Newest wrench so far; `None` before the first one.
    fn latest_wrench(&mut self) -> Option<WrenchPacket>;

    /// Share of the force to display at `now_ns`, 0 to 1. The loop calls this once per period.
    fn force_gate(&mut self, now_ns: u64) -> f64;

    /// Queues the row of a tick at the hand. `false`: the rows cannot be handed in, and the session cannot go on.
    fn send_row(&mut self, out: Out) -> bool;

    /// Number of times that the ticks at the hand began again from the first one.
    fn restarts(&self) -> u32;

    /// Queues a command of the student. `false`: not queued.
    fn command(&mut self, command: Command) -> bool;

    /// Queues an event for the recording. `false`: not queued.
    fn event(&mut self, event: Event) -> bool;

    /// Next message of an instructor; `None`: no message waits.
    fn heard(&mut self) -> Option<Heard>;

    /// Whether packets are carried, or a return is tried.
    fn is_open(&self) -> bool;

    /// Whether the connection is lost and a return is tried.
    fn is_returning(&self) -> bool;
}

impl Carrier for Link {
    fn hello(&self) -> &ServerHello {
        Link::hello(self)
    }

    fn send_pose(&mut self, pose: &PosePacket) {
        Link::send_pose(self, pose);
    }

    fn latest_wrench(&mut self) -> Option<WrenchPacket> {
        Link::latest_wrench(self)
    }

    fn force_gate(&mut self, now_ns: u64) -> f64 {
        Link::force_gate(self, now_ns)
    }

    fn send_row(&mut self, out: Out) -> bool {
        Link::send_row(self, out)
    }

    fn restarts(&self) -> u32 {
        Link::restarts(self)
    }

    fn command(&mut self, command: Command) -> bool {
        Link::command(self, command)
    }

    fn event(&mut self, event: Event) -> bool {
        Link::event(self, event)
    }

    fn heard(&mut self) -> Option<Heard> {
        Link::heard(self)
    }

    fn is_open(&self) -> bool {
        Link::is_open(self)
    }

    fn is_returning(&self) -> bool {
        Link::is_returning(self)
    }
}
