//! Datagrams of one session: poses in through the newest-wins filter, wrenches out with epoch,
//! sequence and hold time.

use quinn::Connection;
use sulcus_proto::newest::{Arrival, ArrivalCounts};
use sulcus_proto::{NewestWins, PoseDatagram};
use triple_buffer::{Input, Output};

use crate::session::handoff::{PoseIn, WrenchOut};
use sulcus_link::clock::monotonic_ns;

/// The network's ends of the two triple buffers, and what it counts.
pub(super) struct Datagrams {
    epoch: u32,
    filter: NewestWins,
    poses: Input<Option<PoseIn>>,
    wrenches: Output<WrenchOut>,
    sent: u32,
    /// Of another epoch.
    pub foreign: u64,
    /// That did not decode.
    pub malformed: u64,
}

impl Datagrams {
    pub fn new(epoch: u32, poses: Input<Option<PoseIn>>, wrenches: Output<WrenchOut>) -> Self {
        Self {
            epoch,
            filter: NewestWins::new(),
            poses,
            wrenches,
            sent: 0,
            foreign: 0,
            malformed: 0,
        }
    }

    /// Begins a new epoch: whatever is still under way belongs to the past.
    pub fn begin_epoch(&mut self, epoch: u32) {
        self.epoch = epoch;
        self.filter.restart();
    }

    /// Takes in one datagram.
    pub fn arrived(&mut self, bytes: &[u8]) {
        let arrived_ns = monotonic_ns();
        let Ok(datagram) = PoseDatagram::from_bytes(bytes) else {
            self.malformed += 1;
            return;
        };
        if datagram.epoch != self.epoch {
            self.foreign += 1;
            return;
        }
        if self.filter.judge(datagram.sequence) == Arrival::Newest {
            self.poses.write(Some(PoseIn {
                datagram,
                arrived_ns,
            }));
        }
    }

    /// Sends the newest wrench if there is one that was not sent.
    pub fn send(&mut self, connection: &Connection) {
        if !self.wrenches.update() {
            return;
        }
        let WrenchOut {
            mut datagram,
            pose_arrived_ns,
        } = *self.wrenches.output_buffer();
        datagram.epoch = self.epoch;
        datagram.sequence = self.sent;
        if datagram.echo.valid {
            let hold_us = monotonic_ns().saturating_sub(pose_arrived_ns) / 1000;
            datagram.echo.hold_us = u32::try_from(hold_us).unwrap_or(u32::MAX);
        }
        match datagram.to_bytes() {
            Ok(bytes) => {
                self.sent = self.sent.wrapping_add(1);
                // Full buffer: the oldest goes. Closed connection: the session's loop sees it too.
                let _ = connection.send_datagram(bytes.to_vec().into());
            }
            // Only a number that is not finite; the core rules that out. Nothing is sent, and the
            // client's watchdog takes the force to zero.
            Err(error) => tracing::error!("tick {} gave no wrench: {error}", datagram.tick),
        }
    }

    /// How poses fared.
    pub fn counts(&self) -> ArrivalCounts {
        self.filter.counts()
    }
}
