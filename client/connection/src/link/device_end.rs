//! Ends of the newest pose and the newest wrench: that of the device's thread, and that of the network.

use std::sync::Arc;

use sulcus_haptics::Watchdog;
use triple_buffer::{Input, Output, triple_buffer};

use super::stats::Shared;
use super::{LinkStats, PosePacket, WrenchPacket};

/// Part of a link that the device's thread uses in each period. Only [`DeviceEnd::stats`] takes a lock.
pub(super) struct DeviceEnd {
    poses: Input<PosePacket>,
    wrenches: Output<Option<WrenchPacket>>,
    watchdog: Watchdog,
    shared: Arc<Shared>,
}

/// Other side of a [`DeviceEnd`].
pub(super) struct NetworkEnd {
    /// Newest pose.
    pub poses: Output<PosePacket>,
    /// Newest wrench; `None` before the first one.
    pub wrenches: Input<Option<WrenchPacket>>,
    /// Counters and state of the link.
    pub shared: Arc<Shared>,
}

/// Both ends, without a pose or a wrench.
pub(super) fn ends(shared: &Arc<Shared>) -> (DeviceEnd, NetworkEnd) {
    let (poses, poses_out) = triple_buffer(&PosePacket::default());
    let (wrenches_in, wrenches) = triple_buffer(&None);
    let device = DeviceEnd {
        poses,
        wrenches,
        watchdog: Watchdog::new(),
        shared: shared.clone(),
    };
    let network = NetworkEnd {
        poses: poses_out,
        wrenches: wrenches_in,
        shared: shared.clone(),
    };
    (device, network)
}

impl DeviceEnd {
    /// Offers a pose, in place of an older one that was not sent yet.
    pub fn send_pose(&mut self, pose: &PosePacket) {
        self.poses.write(*pose);
        self.shared.offered();
    }

    /// Newest wrench so far; `None` before the first one.
    pub fn latest_wrench(&mut self) -> Option<WrenchPacket> {
        if self.wrenches.update()
            && let Some(packet) = self.wrenches.output_buffer()
        {
            self.watchdog.heard(packet.arrived_ns);
        }
        *self.wrenches.output_buffer()
    }

    /// Share of the force to display at `now_ns`, 0 to 1.
    pub fn force_gate(&mut self, now_ns: u64) -> f64 {
        self.latest_wrench();
        self.watchdog.gate(now_ns)
    }

    /// Number of times that the ticks at the hand began again from the first one.
    pub fn restarts(&self) -> u32 {
        self.shared.restarts()
    }

    /// Whether the link carries packets or tries to.
    pub fn is_open(&self) -> bool {
        !self.shared.is_closed()
    }

    /// Whether the connection is lost and the link tries to return.
    pub fn is_returning(&self) -> bool {
        self.shared.is_returning()
    }

    /// Counters and times so far.
    pub fn stats(&self) -> LinkStats {
        self.shared.stats()
    }
}
