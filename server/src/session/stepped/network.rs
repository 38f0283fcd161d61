//! Network's side of a stepped session: datagrams, epochs, commands and events.

use std::sync::atomic::Ordering;
use std::time::Duration;

use sulcus_proto::PoseDatagram;
use sulcus_proto::control::{Command, Event, ServerHello};
use sulcus_sessions::{Detached, Occurrence};

use super::{InForce, STATION, SteppedSession, Taken};
use crate::net::greeting::server_hello;

impl SteppedSession {
    /// Hello to a client that attaches now, with the present epoch and ticks at the server.
    pub fn hello(&self) -> ServerHello {
        let couplings = self.plan.scene.couplings();
        let attach = (self.epoch(), false, Ok(false));
        server_hello(&self.plan, &couplings, (STATION, 0), attach)
    }

    /// Takes a datagram of the student at `now_ns` of the monotonic clock, over a path with the round trip `rtt`.
    /// Returns a pose that is the newest one of the present epoch.
    pub fn datagram(&self, bytes: &[u8], now_ns: u64, rtt: Duration) -> Option<PoseDatagram> {
        self.ports.datagrams().arrived(bytes, now_ns, || rtt)
    }

    /// Newest wrench, encoded, for a caller that sends it at `now_ns` of the monotonic clock. `None`: no tick has run
    /// since the last one, or the rate leaves it out.
    pub fn wrench(&self, now_ns: u64) -> Option<Vec<u8>> {
        let wrench = self.ports.datagrams().wrench(now_ns);
        wrench.map(|bytes| bytes.to_vec())
    }

    /// Epoch of the datagrams.
    pub fn epoch(&self) -> u32 {
        self.ports.datagrams().epoch()
    }

    /// Begins the epoch of a new connection, or of the end of a pause.
    pub fn begin_epoch(&self, epoch: u32) {
        self.ports.begin_epoch(epoch);
    }

    /// Takes all tools away: the student is gone. The next pose brings them back.
    pub fn let_go(&self, reason: Detached) {
        self.ports.let_go(reason);
    }

    /// Presses a button of the tool in a slot.
    pub fn press(&self, tool: u8, button: u8) {
        self.ports.press(tool, button);
    }

    /// Passes an event of the client to the recorder. An event above the limits is dropped and counted.
    pub fn event(&self, event: Event) {
        self.ports.event(event);
    }

    /// Passes an event of the station to the recorder. `false`: the recorder's channel is full.
    pub fn occurrence(&self, occurrence: Occurrence) -> bool {
        self.ports.occurrence(occurrence)
    }

    /// Applies a command of the station's side. After [`Taken::Lifted`] a station begins a new epoch.
    pub fn instructor(&self, command: Command) -> Taken {
        self.levels.station(command)
    }

    /// Applies a command of the student. After [`Taken::Lifted`] a station begins a new epoch.
    pub fn student(&self, command: Command) -> Taken {
        self.levels.student(command)
    }

    /// Pause and force limit of both sides, for a tick that begins now.
    pub fn levels_in_force(&self) -> InForce {
        self.levels.in_force()
    }

    /// Number of commands of the station's side that the newest tick has obeyed.
    pub fn commands_obeyed(&self) -> u64 {
        self.ports.progress().commands.load(Ordering::Acquire)
    }
}
