//! Datagrams of one session: poses in, through the newest-wins filter; wrenches out, with epoch, sequence and hold
//! time. The datagrams outlive the student's connections; each connection has an epoch of its own.

use quinn::Connection;
use sulcus_link::ladder::Ladder;
use sulcus_proto::datagram::WireLevels;
use sulcus_proto::newest::{Arrival, ArrivalCounts};
use sulcus_proto::reception::Meter;
use sulcus_proto::{NewestWins, PoseDatagram, WrenchDatagram};
use triple_buffer::{Input, Output};

use crate::session::handoff::{PoseIn, WrenchOut};
use sulcus_link::clock::monotonic_ns;

/// The network's ends of the two triple buffers, and counters of datagrams.
#[derive(Debug)]
pub(crate) struct Datagrams {
    epoch: u32,
    filter: NewestWins,
    poses: Input<Option<PoseIn>>,
    wrenches: Output<WrenchOut>,
    /// Quality of the way of the poses.
    meter: Meter,
    /// Rate of the wrenches.
    ladder: Ladder,
    /// Sequence of the next wrench; wraps.
    sent: u32,
    /// Number of poses of another epoch.
    pub foreign: u64,
    /// Number of datagrams that did not decode.
    pub malformed: u64,
}

impl Datagrams {
    /// Ends for ticks of `tick_ns`, nanoseconds.
    pub fn new(
        epoch: u32,
        tick_ns: u64,
        poses: Input<Option<PoseIn>>,
        wrenches: Output<WrenchOut>,
    ) -> Self {
        Self {
            epoch,
            filter: NewestWins::new(),
            poses,
            wrenches,
            meter: Meter::new(),
            ladder: Ladder::new(tick_ns),
            sent: 0,
            foreign: 0,
            malformed: 0,
        }
    }

    /// Begins a new epoch. Poses of an older epoch are counted as foreign and ignored.
    pub fn begin_epoch(&mut self, epoch: u32) {
        self.epoch = epoch;
        self.filter.restart();
        // The path may be another one.
        self.meter = Meter::new();
        self.ladder.restart();
    }

    /// Epoch of the datagrams.
    pub fn epoch(&self) -> u32 {
        self.epoch
    }

    /// Takes all tools away: the student is gone. The next pose brings them back.
    pub fn let_go(&mut self) {
        self.poses.write(None);
    }

    /// Takes one datagram of a connection: the newest pose of the present epoch goes to the simulation. Returns it.
    pub fn arrived(&mut self, bytes: &[u8], connection: &Connection) -> Option<PoseDatagram> {
        let arrived_ns = monotonic_ns();
        let Ok(datagram) = PoseDatagram::from_bytes(bytes) else {
            self.malformed += 1;
            return None;
        };
        if datagram.epoch != self.epoch {
            self.foreign += 1;
            return None;
        }
        if self.filter.judge(datagram.sequence) == Arrival::Newest {
            let times = datagram.tools.iter().map(|tool| tool.device_time_ns);
            let sent_ns = times.max().unwrap_or(0);
            self.meter
                .arrived(arrived_ns, sent_ns, self.filter.counts());
            let rtt = || connection.rtt();
            self.ladder.told(arrived_ns, datagram.reception, rtt);
            self.poses.write(Some(PoseIn {
                datagram,
                arrived_ns,
            }));
            return Some(datagram);
        }
        None
    }

    /// Sends the levels in force to a hand that ticks by itself, with the newest tick that the server has computed.
    pub fn send_levels(&mut self, tick: u64, levels: WireLevels, connection: &Connection) {
        let datagram = WrenchDatagram {
            tick,
            levels,
            ..WrenchDatagram::default()
        };
        self.send_datagram(datagram, connection);
    }

    /// Sends the newest wrench, unless it was sent before or the rate leaves it out.
    pub fn send(&mut self, connection: &Connection) {
        if !self.wrenches.update() || !self.ladder.sends() {
            return;
        }
        let WrenchOut {
            mut datagram,
            pose_arrived_ns,
        } = *self.wrenches.output_buffer();
        let hold_us = monotonic_ns().saturating_sub(pose_arrived_ns) / 1000;
        let hold_us = u32::try_from(hold_us).unwrap_or(u32::MAX);
        for tool in datagram.tools.iter_mut().filter(|tool| tool.echo.valid) {
            tool.echo.hold_us = hold_us;
        }
        self.send_datagram(datagram, connection);
    }

    fn send_datagram(&mut self, mut datagram: WrenchDatagram, connection: &Connection) {
        datagram.epoch = self.epoch;
        datagram.sequence = self.sent;
        datagram.reception = self.meter.value();
        match datagram.to_bytes() {
            Ok(bytes) => {
                self.sent = self.sent.wrapping_add(1);
                // A full buffer drops its oldest datagram. A closed connection ends the session's loop.
                let _ = connection.send_datagram(bytes.to_vec().into());
            }
            // The cause can only be a number that is not finite, which the core excludes. Nothing is sent, and the
            // client's watchdog takes the force to zero.
            Err(error) => {
                tracing::error!("the wrench of tick {} is not sent: {error}", datagram.tick);
            }
        }
    }

    /// Counts of arrived poses of the session's epochs: accepted, late, duplicate, lost.
    pub fn counts(&self) -> ArrivalCounts {
        self.filter.counts()
    }
}
