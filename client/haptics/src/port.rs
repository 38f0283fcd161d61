//! Port of a hand: the end of the door at the device's thread, and the end at the loop of the link.
//!
//! Two mailboxes connect both ends. Each holds the newest value alone, and neither end waits, locks or allocates.

use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};

use sulcus_core::{Pose, RawPose, Wrench};
use triple_buffer::{Input, Output, TripleBuffer};

use crate::door::{Counts, Door, DoorRules, Wanted};
use crate::interlock::{Stage, Trip, Unready};
use crate::limits::Limits;
use crate::passivity::Energy;

/// State of a hand at its device, as the loop of the link reads it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Number of the period at the device; wraps.
    pub sequence: u32,
    /// Time of the measurement, nanoseconds of the device thread's clock.
    pub at_ns: u64,
    /// Pose of the tool, `world_from_tool` at the device point.
    pub pose: RawPose,
    /// Whether the device has a valid pose.
    pub present: bool,
    /// Wrench displayed in the period, about the tool's device point, world axes.
    pub displayed: Wrench,
    /// Stage of the interlock.
    pub stage: Stage,
    /// Share of the force that the door lets pass, 0 to 1.
    pub gate: f64,
    /// Counters of the door.
    pub counts: Counts,
    /// Sums of the passivity controller.
    pub energy: Energy,
}

impl Sample {
    /// State before the first period.
    pub const NOTHING: Self = Self {
        sequence: 0,
        at_ns: 0,
        pose: RawPose::IDENTITY,
        present: false,
        displayed: Wrench::ZERO,
        stage: Stage::Unready(Unready::Absent),
        gate: 0.0,
        counts: Counts {
            periods: 0,
            trips: 0,
            dropped: 0,
            most_dropped_nm: 0.0,
            limited: 0,
            most_n: 0.0,
        },
        energy: Energy {
            most_out: 0.0,
            most_at_once: 0.0,
            taken: 0.0,
            acted: 0,
        },
    };
}

/// End of the door at the device's thread. The wrench of [`HandPort::exchange`] is the only wrench that a back-end may
/// send to its device.
#[derive(Debug)]
pub struct HandPort {
    door: Door,
    orders: Output<Wanted>,
    samples: Input<Sample>,
    pressed: Arc<AtomicU32>,
    sequence: u32,
}

/// End of the door at the loop of the link.
#[derive(Debug)]
pub struct HandEnd {
    orders: Input<Wanted>,
    samples: Output<Sample>,
    pressed: Arc<AtomicU32>,
}

/// Creates a closed door with both of its ends. The limits of [`DoorRules::guarded`] hold for any rules. Rules without
/// a guard let no force pass.
pub fn door(rules: DoorRules) -> (HandPort, HandEnd) {
    let rules = match rules.guard.clone() {
        Some(guard) => DoorRules::guarded(rules.limits, rules.slew, rules.passivity, guard),
        None => DoorRules {
            limits: Limits {
                force_n: 0.0,
                torque_nm: 0.0,
            },
            ..rules
        },
    };
    let (orders_in, orders_out) = TripleBuffer::new(&Wanted::NOTHING).split();
    let (samples_in, samples_out) = TripleBuffer::new(&Sample::NOTHING).split();
    let pressed = Arc::new(AtomicU32::new(0));
    let port = HandPort {
        door: Door::new(rules),
        orders: orders_out,
        samples: samples_in,
        pressed: pressed.clone(),
        sequence: 0,
    };
    let end = HandEnd {
        orders: orders_in,
        samples: samples_out,
        pressed,
    };
    (port, end)
}

impl HandPort {
    /// Performs a period of the device: takes pose and buttons of the handle, and returns the wrench to display about
    /// the centre of the gimbal. Both are in base axes: x right, y up, z towards the person.
    ///
    /// `now_ns` is the time of the measurement by the monotonic clock of the machine. An `Err` states why there is no
    /// pose; the wrench then falls to zero. The call neither waits, locks nor allocates.
    pub fn exchange(&mut self, now_ns: u64, pose: Result<&Pose, Unready>, buttons: u16) -> Wrench {
        self.door.order(self.orders.read());
        let wrench = self.door.exchange(now_ns, pose, buttons);
        self.pressed.fetch_or(u32::from(buttons), Ordering::Relaxed);
        self.sequence = self.sequence.wrapping_add(1);
        let tool = self.door.tool();
        self.samples.write(Sample {
            sequence: self.sequence,
            at_ns: now_ns,
            pose: tool.map_or(RawPose::IDENTITY, |pose| RawPose::from(&pose)),
            present: tool.is_some(),
            displayed: self.door.displayed_in_world(),
            stage: self.door.stage(),
            gate: self.door.gate(),
            counts: self.door.counts(),
            energy: self.door.energy(),
        });
        wrench
    }

    /// Takes the force away until a button is pressed, for an error of the driver.
    pub fn trip(&mut self, trip: Trip) {
        self.door.trip(trip);
    }

    /// Stage of the interlock.
    pub fn stage(&self) -> Stage {
        self.door.stage()
    }
}

impl HandEnd {
    /// Offers an order. The order replaces an older one that the device has not taken yet.
    pub fn order(&mut self, wanted: &Wanted) {
        self.orders.write(*wanted);
    }

    /// Newest state of the hand.
    pub fn sample(&mut self) -> Sample {
        *self.samples.read()
    }

    /// Buttons held in any period since the previous call, one bit each.
    pub fn buttons(&mut self) -> u16 {
        self.pressed.swap(0, Ordering::Relaxed) as u16
    }
}

#[cfg(test)]
mod tests;
