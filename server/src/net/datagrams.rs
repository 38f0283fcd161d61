//! Datagrams of one session: poses in, through the newest-wins filter; wrenches out, with epoch, sequence and hold
//! time. The datagrams outlive the student's connections; each connection has an epoch of its own. They know bytes and
//! times alone: the caller has the connection and the clock.

use std::time::Duration;

use sulcus_link::ladder::Ladder;
use sulcus_proto::datagram::WireLevels;
use sulcus_proto::newest::{Arrival, ArrivalCounts};
use sulcus_proto::reception::Meter;
use sulcus_proto::{NewestWins, PoseDatagram, WrenchDatagram};
use triple_buffer::{Input, Output};

use crate::session::handoff::{PoseIn, WrenchOut};

/// Encoded datagram to a student.
pub(crate) type Encoded = [u8; WrenchDatagram::BYTES];

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

    /// Takes one datagram of a connection, at `now_ns` of the server's monotonic clock: the newest pose of the present
    /// epoch goes to the simulation. Returns it. The round trip of the path is seldom asked for.
    pub fn arrived(
        &mut self,
        bytes: &[u8],
        now_ns: u64,
        rtt: impl FnOnce() -> Duration,
    ) -> Option<PoseDatagram> {
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
            self.meter.arrived(now_ns, sent_ns, self.filter.counts());
            self.ladder.told(now_ns, datagram.reception, rtt);
            self.poses.write(Some(PoseIn {
                datagram,
                arrived_ns: now_ns,
            }));
            return Some(datagram);
        }
        None
    }

    /// Levels in force for a hand that ticks by itself, with the newest tick that the server has computed. The caller
    /// sends them.
    pub fn levels(&mut self, tick: u64, levels: WireLevels) -> Option<Encoded> {
        let datagram = WrenchDatagram {
            tick,
            levels,
            ..WrenchDatagram::default()
        };
        self.encoded(datagram)
    }

    /// Newest wrench, for a caller that sends it at `now_ns` of the server's monotonic clock. `None`: it was sent
    /// before, or the rate leaves it out.
    pub fn wrench(&mut self, now_ns: u64) -> Option<Encoded> {
        if !self.wrenches.update() || !self.ladder.sends() {
            return None;
        }
        let WrenchOut {
            mut datagram,
            pose_arrived_ns,
        } = *self.wrenches.output_buffer();
        let hold_us = now_ns.saturating_sub(pose_arrived_ns) / 1000;
        let hold_us = u32::try_from(hold_us).unwrap_or(u32::MAX);
        for tool in datagram.tools.iter_mut().filter(|tool| tool.echo.valid) {
            tool.echo.hold_us = hold_us;
        }
        self.encoded(datagram)
    }

    /// Datagram with epoch, sequence and quality of the poses' way. Takes the next sequence, whether the datagram
    /// arrives or not.
    fn encoded(&mut self, mut datagram: WrenchDatagram) -> Option<Encoded> {
        datagram.epoch = self.epoch;
        datagram.sequence = self.sent;
        datagram.reception = self.meter.value();
        match datagram.to_bytes() {
            Ok(bytes) => {
                self.sent = self.sent.wrapping_add(1);
                Some(bytes)
            }
            // The cause can only be a number that is not finite, which the core excludes. Nothing is sent, and the
            // client's watchdog takes the force to zero.
            Err(error) => {
                tracing::error!("the wrench of tick {} is not sent: {error}", datagram.tick);
                None
            }
        }
    }

    /// Counts of arrived poses of the session's epochs: accepted, late, duplicate, lost.
    pub fn counts(&self) -> ArrivalCounts {
        self.filter.counts()
    }
}

#[cfg(test)]
mod tests {
    use triple_buffer::triple_buffer;

    use super::*;

    const TICK_NS: u64 = 1_000_000;

    fn datagrams(
        epoch: u32,
    ) -> (
        Datagrams,
        Output<Option<PoseIn>>,
        triple_buffer::Input<WrenchOut>,
    ) {
        let (poses, taken) = triple_buffer(&None);
        let (made, wrenches) = triple_buffer(&WrenchOut::default());
        (Datagrams::new(epoch, TICK_NS, poses, wrenches), taken, made)
    }

    fn pose(epoch: u32, sequence: u32) -> Vec<u8> {
        let mut pose = PoseDatagram {
            epoch,
            sequence,
            ..PoseDatagram::default()
        };
        pose.tools[0].present = true;
        pose.to_bytes().expect("a pose").to_vec()
    }

    fn no_rtt() -> Duration {
        panic!("no rate has changed: no round trip is asked for")
    }

    #[test]
    fn poses_of_another_epoch_and_other_bytes_are_counted_and_move_nothing() {
        let (mut datagrams, mut taken, _made) = datagrams(2);
        assert!(datagrams.arrived(&pose(1, 5), 1, no_rtt).is_none());
        assert!(datagrams.arrived(b"no pose", 2, no_rtt).is_none());
        assert!(!taken.update());
        let newest = datagrams.arrived(&pose(2, 5), 3, no_rtt).expect("newest");
        assert_eq!((newest.epoch, newest.sequence), (2, 5));
        assert!(datagrams.arrived(&pose(2, 4), 4, no_rtt).is_none(), "late");
        let arrived = taken.read().as_ref().map(|pose| pose.arrived_ns);
        assert_eq!(arrived, Some(3));
        datagrams.begin_epoch(3);
        assert!(datagrams.arrived(&pose(2, 6), 5, no_rtt).is_none());
        assert!(datagrams.arrived(&pose(3, 0), 6, no_rtt).is_some());
        assert_eq!((datagrams.foreign, datagrams.malformed), (2, 1));
        assert_eq!(datagrams.counts().accepted, 2);
        datagrams.let_go();
        assert!(taken.read().is_none());
    }

    #[test]
    fn a_wrench_leaves_once_with_epoch_sequence_and_hold_time() {
        let (mut datagrams, _taken, mut made) = datagrams(7);
        assert_eq!(datagrams.wrench(0), None, "no tick yet");
        let mut out = WrenchOut {
            pose_arrived_ns: 1_000_000,
            ..WrenchOut::default()
        };
        out.datagram.tick = 3;
        out.datagram.tools[0].echo.valid = true;
        made.write(out);
        let bytes = datagrams.wrench(1_250_000).expect("new");
        let sent = WrenchDatagram::from_bytes(&bytes).expect("a wrench");
        assert_eq!((sent.epoch, sent.sequence, sent.tick), (7, 0, 3));
        let holds = sent.tools.map(|tool| tool.echo.hold_us);
        assert_eq!(holds, [250, 0]);
        assert_eq!(datagrams.wrench(1_260_000), None, "sent before");
        // A wrench that cannot be encoded takes no sequence.
        out.datagram.tools[0].wrench.force[0] = f32::NAN;
        made.write(out);
        assert_eq!(datagrams.wrench(1_270_000), None);
        let levels = datagrams.levels(9, WireLevels::default()).expect("levels");
        let sent = WrenchDatagram::from_bytes(&levels).expect("levels");
        assert_eq!((sent.sequence, sent.tick), (1, 9));
    }
}
