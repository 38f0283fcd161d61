//! Datagrams of a link: poses to the server, wrenches back.
//!
//! This part of the link knows no QUIC and no clock: the caller gives bytes and times.

use std::sync::Arc;
use std::time::Duration;

use sulcus_link::ladder::Ladder;
use sulcus_proto::datagram::{Echo, ToolPose};
use sulcus_proto::newest::Arrival;
use sulcus_proto::reception::Meter;
use sulcus_proto::{PoseDatagram, TOOLS, WrenchDatagram};
use triple_buffer::{Input, Output};

use super::device_end::NetworkEnd;
use super::stats::Shared;
use crate::at_hand::outbox::Outbox;

/// Readings of the devices of both hands.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PosePacket {
    /// For each tool slot: number, time by [`super::now_ns`] and period of the reading, `world_from_tool` at the device
    /// point, the buttons, and the wrench displayed last, after gate and limits.
    pub tools: [ToolPose; TOOLS],
    /// Newest tick at the hand; 0 if the server ticks.
    pub tick: u64,
    /// Number of the run of that tick: [`super::Link::restarts`]. A pose of a former run is not sent.
    pub run: u32,
}

/// A wrench and its arrival.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WrenchPacket {
    /// Datagram of the server: for each tool force (N) and torque (N m), world axes, about the device point.
    pub datagram: WrenchDatagram,
    /// Time of arrival, by [`super::now_ns`].
    pub arrived_ns: u64,
    /// Time from the measurement of the answered pose to the arrival of the wrench, nanoseconds. `None`: the server had
    /// no pose yet.
    pub age_ns: Option<u64>,
}

impl WrenchPacket {
    /// [`WrenchPacket::age_ns`] in milliseconds.
    pub fn age_ms(&self) -> Option<f64> {
        self.age_ns.map(|age| age as f64 / 1e6)
    }
}

/// Datagrams of one link: the newest pose becomes a datagram, and a datagram becomes the newest wrench.
pub(super) struct Packets {
    epoch: u32,
    /// Period of the ticks, nanoseconds.
    tick_ns: u64,
    /// Quality of the way of the wrenches.
    meter: Meter,
    /// Rate of the poses.
    ladder: Ladder,
    poses: Output<PosePacket>,
    wrenches: Input<Option<WrenchPacket>>,
    shared: Arc<Shared>,
    /// Number of the next pose datagram.
    sequence: u32,
    /// For each tool the number of the reading answered last.
    answered: [Option<u32>; TOOLS],
    /// Batches of ticks at the hand; `None` if the server ticks.
    outbox: Option<Arc<Outbox>>,
}

impl Packets {
    /// Datagrams in `epoch` of a session with ticks of `tick_ns` nanoseconds. `outbox`: batches of ticks at the hand.
    pub fn new(end: NetworkEnd, tick_ns: u64, epoch: u32, outbox: Option<Arc<Outbox>>) -> Self {
        let NetworkEnd {
            poses,
            wrenches,
            shared,
        } = end;
        Self {
            epoch,
            tick_ns,
            meter: Meter::new(),
            ladder: Ladder::new(tick_ns),
            poses,
            wrenches,
            shared,
            sequence: 0,
            answered: [None; TOOLS],
            outbox,
        }
    }

    /// Present epoch.
    pub fn epoch(&self) -> u32 {
        self.epoch
    }

    /// Takes a new epoch. Datagrams of other epochs are ignored. The sequences of both ends go on; the filter accepts
    /// any first sequence.
    pub fn begin_epoch(&mut self, epoch: u32) {
        self.epoch = epoch;
        // The path may be another one.
        self.meter = Meter::new();
        self.ladder.restart();
        self.shared.count(|numbers| numbers.filter.restart());
    }

    /// The server has lost the session: a hand with ticks waits for the begin of a new one.
    pub fn begin_run(&mut self) {
        if let Some(outbox) = &self.outbox {
            self.wrenches.write(None);
            self.shared.restart();
            outbox.begin(self.shared.restarts());
        }
    }

    /// Gives the datagram of the newest pose to `take`, unless the pose was given before or the rate leaves it out.
    /// `take` tells whether the transport took the bytes; a pose that it refused is not given again.
    pub fn send_pose(&mut self, take: impl FnOnce(&[u8]) -> bool) {
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
        // No pose fails here, also none with a number that is not finite: the tick judges poses.
        let Ok(bytes) = datagram.to_bytes() else {
            return;
        };
        if take(&bytes) {
            self.sequence = self.sequence.wrapping_add(1);
            self.shared.count(|numbers| numbers.sent += 1);
        }
    }

    /// Takes a datagram that arrived at `arrived_ns`: counts it, and hands the newest wrench of the present epoch to
    /// the device's thread. `rtt` is the round trip of the path.
    pub fn arrived(&mut self, bytes: &[u8], arrived_ns: u64, rtt: impl FnOnce() -> Duration) {
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

#[cfg(test)]
mod tests {
    use super::super::device_end::{DeviceEnd, ends};
    use super::*;

    fn begin() -> (DeviceEnd, Packets) {
        let (device, network) = ends(&Arc::new(Shared::new()));
        (device, Packets::new(network, 1_000_000, 7, None))
    }

    fn sent(packets: &mut Packets) -> Option<PoseDatagram> {
        let mut sent = None;
        packets.send_pose(|bytes| {
            sent = PoseDatagram::from_bytes(bytes).ok();
            true
        });
        sent
    }

    #[test]
    fn a_pose_that_is_not_finite_is_sent_and_the_tick_judges_it() {
        let (mut device, mut packets) = begin();
        let mut pose = PosePacket::default();
        pose.tools[0].pose.position[1] = f32::NAN;
        pose.tools[1].displayed.force[2] = f32::INFINITY;
        device.send_pose(&pose);
        let sent = sent(&mut packets).expect("sent");
        assert!(sent.tools[0].pose.position[1].is_nan());
        assert_eq!(sent.tools[1].displayed.force[2], f32::INFINITY);
        assert_eq!(device.stats().poses_sent, 1);
    }

    #[test]
    fn a_refused_pose_has_no_number_and_is_not_given_again() {
        let (mut device, mut packets) = begin();
        device.send_pose(&PosePacket::default());
        packets.send_pose(|_| false);
        assert_eq!(sent(&mut packets), None);
        assert_eq!(device.stats().poses_sent, 0);
        device.send_pose(&PosePacket::default());
        assert_eq!(
            sent(&mut packets).map(|datagram| datagram.sequence),
            Some(0)
        );
        device.send_pose(&PosePacket::default());
        assert_eq!(
            sent(&mut packets).map(|datagram| datagram.sequence),
            Some(1)
        );
    }
}
