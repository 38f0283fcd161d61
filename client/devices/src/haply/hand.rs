//! State of one hand: newest pose, status and force.

mod grip;

use sulcus_core::{Pose, Quat, Vec3};
use sulcus_haptics::Unready;

use self::grip::{Grip, Presence};
use super::axes::to_service;
use super::event::{Event, Meaning};
use super::foreign::{Comparison, Difference};
use super::inventory::Inventory;
use super::message::{Order, quoted};
use super::pairing::Pair;
use super::reply::{ArmStatus, Reply};

/// Age at which a pose is none, nanoseconds. Replies may leave out a device for a shorter time.
const STALE_NS: u64 = 20_000_000;

/// State of one hand.
#[derive(Clone, Debug)]
pub(super) struct Hand {
    pair: Pair,
    /// Ids of arm and grip as texts of JSON.
    quoted: (String, String),
    position: Option<(u64, Vec3)>,
    status: ArmStatus,
    arm: Presence,
    grip: Grip,
    braked: bool,
    comparison: Comparison,
    difference: Option<Difference>,
    /// Force of the next message, base axes, newtons.
    force: Vec3,
}

impl Hand {
    /// State before the first reply.
    pub(super) fn new(pair: Pair, inventory: &Inventory) -> Self {
        let grip = pair.grip.as_ref().map_or("", |(_, id)| id);
        let mut hand = Self {
            quoted: (quoted(&pair.arm), quoted(grip)),
            pair,
            position: None,
            status: ArmStatus::default(),
            arm: Presence::default(),
            grip: Grip::default(),
            braked: false,
            comparison: Comparison::new(),
            difference: None,
            force: Vec3::zeros(),
        };
        hand.begin(inventory);
        hand
    }

    /// Begins a new connection with its inventory: no pose of an older connection holds.
    pub(super) fn begin(&mut self, inventory: &Inventory) {
        self.position = None;
        self.comparison = Comparison::new();
        self.difference = None;
        self.grip = Grip::default();
        let arm = inventory.arm(&self.pair.arm);
        self.arm.gone = arm.is_none();
        self.status = arm.map(|arm| arm.status).unwrap_or_default();
        if let Some((_, id)) = &self.pair.grip {
            let grip = inventory.grip(id);
            self.grip.presence.gone = grip.is_none();
            self.grip.asleep = grip.is_some_and(|grip| !grip.awake);
        }
    }

    /// Id of the arm.
    pub(super) fn id(&self) -> &str {
        &self.pair.arm
    }

    /// Takes a reply of `now_ns`.
    pub(super) fn take(&mut self, reply: &Reply, now_ns: u64) {
        let arm = reply.arm(&self.pair.arm);
        if reply.arms.is_some() {
            self.arm.look(arm.is_some(), now_ns);
        }
        if let Some(arm) = arm {
            self.status.update(&arm.status);
            if let Some(position) = arm.position {
                self.position = Some((now_ns, position));
            }
            if let Some(force) = arm.force {
                self.difference = self.comparison.reported(&force, now_ns);
            }
        }
        if let Some((array, id)) = &self.pair.grip {
            self.grip.take(reply, *array, id, now_ns);
        }
    }

    /// Takes an event. Returns the sentence of an event that takes the force away.
    pub(super) fn event(&mut self, event: &Event) -> Option<String> {
        let of_arm = event.is_of(&self.pair.arm);
        let of_grip = self
            .pair
            .grip
            .as_ref()
            .is_some_and(|(_, id)| event.is_of(id));
        match &event.meaning {
            Meaning::Safety { cause, holds } if of_arm => {
                self.braked |= holds;
                return Some(format!(
                    "the Haply service took the force of {} away ({cause}): press a button when the arm is free",
                    self.pair.arm
                ));
            }
            Meaning::Released if of_arm => self.braked = false,
            // A released brake may have had its event in the gap. A brake that holds shows by its force.
            Meaning::Ended => self.braked = false,
            Meaning::Disconnected if event.device.is_empty() => {}
            Meaning::Disconnected => {
                self.arm.gone |= of_arm;
                self.grip.presence.gone |= of_grip;
            }
            Meaning::Asleep if of_grip => self.grip.asleep = true,
            _ => {}
        }
        None
    }

    /// Pose at `now_ns`, base axes, or the reason for none.
    pub(super) fn pose(&self, now_ns: u64) -> Result<Pose, Unready> {
        let is_fresh = |at_ns: u64| now_ns.saturating_sub(at_ns) < STALE_NS;
        let has_grip = self.pair.grip.is_some();
        if self.arm.gone || has_grip && self.grip.presence.gone {
            return Err(Unready::Absent);
        }
        if self.status.calibrated == Some(false) {
            return Err(Unready::Uncalibrated);
        }
        let refused = self.status.ready == Some(false) || self.status.started == Some(false);
        let (at_ns, position) = self.position.ok_or(Unready::NoPose)?;
        if refused || !is_fresh(at_ns) {
            return Err(Unready::NoPose);
        }
        let orientation = if has_grip {
            let awake = !self.grip.asleep && self.grip.seen_ns.is_some_and(is_fresh);
            let turned = self.grip.turning.at(now_ns).filter(|_| awake);
            turned.ok_or(Unready::NoPose)?
        } else {
            Quat::identity()
        };
        Ok(Pose::new(position, orientation))
    }

    /// Buttons of the grip, one bit each; none of a grip that says nothing.
    pub(super) fn buttons(&self, now_ns: u64) -> u16 {
        let fresh = self
            .grip
            .seen_ns
            .is_some_and(|at_ns| now_ns.saturating_sub(at_ns) < STALE_NS);
        if fresh { self.grip.buttons } else { 0 }
    }

    /// Whether the service displays no force or a foreign one: the force must stay away.
    pub(super) fn is_refused(&self) -> bool {
        self.braked || self.status.power == Some(false) || self.difference.is_some()
    }

    /// Difference between the forces sent and displayed.
    pub(super) fn difference(&self) -> Option<Difference> {
        self.difference
    }

    /// Sets the force of the next message, base axes, newtons.
    pub(super) fn set_force(&mut self, force: Vec3) {
        self.force = force;
    }

    /// Force of the next message, base axes, newtons.
    pub(super) fn force(&self) -> Vec3 {
        self.force
    }

    /// Accounts for a message with the force.
    pub(super) fn sent(&mut self, now_ns: u64) {
        if self.has_order() {
            self.comparison.sent(&self.force, now_ns);
        }
    }

    /// Whether the next message has a force for the arm. The force of an arm that is absent falls to zero first: the
    /// service may have left the arm out of its replies alone.
    fn has_order(&self) -> bool {
        !self.arm.gone || self.force != Vec3::zeros()
    }

    /// Part of the next message.
    pub(super) fn order(&self) -> Order<'_> {
        let (arm, grip) = &self.quoted;
        let array = self.pair.grip.as_ref().map(|(array, _)| *array);
        Order {
            arm: self
                .has_order()
                .then(|| (arm.as_str(), to_service(&self.force))),
            grip: array
                .filter(|_| !self.grip.presence.gone)
                .map(|array| (array, grip.as_str())),
        }
    }
}

#[cfg(test)]
mod tests;
