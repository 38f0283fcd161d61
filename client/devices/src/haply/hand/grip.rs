//! Presence of a device, and state of the grip of a hand.

use sulcus_core::Quat;

use super::STALE_NS;
use crate::haply::reply::{Array, Reply};
use crate::haply::turning::Turning;

/// Whether a device is connected.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Presence {
    pub(super) gone: bool,
    pub(super) missing_ns: Option<u64>,
}

/// State of the grip.
#[derive(Clone, Debug, Default)]
pub(super) struct Grip {
    pub(super) presence: Presence,
    pub(super) turning: Turning,
    pub(super) newest: Option<Quat>,
    pub(super) seen_ns: Option<u64>,
    pub(super) asleep: bool,
    pub(super) buttons: u16,
}

impl Presence {
    /// Accounts for a reply that has the array of the device. A device that the array lacks for 20 ms is gone.
    pub(super) fn look(&mut self, found: bool, now_ns: u64) {
        if found {
            *self = Self::default();
            return;
        }
        let since = *self.missing_ns.get_or_insert(now_ns);
        self.gone |= now_ns.saturating_sub(since) >= STALE_NS;
    }
}

impl Grip {
    /// Takes a reply of `now_ns`.
    pub(super) fn take(&mut self, reply: &Reply, array: Array, id: &str, now_ns: u64) {
        let found = reply.grip(array, id);
        if reply.has(array) {
            self.presence.look(found.is_some(), now_ns);
        }
        let Some(found) = found else { return };
        self.presence.gone |= found.connected == Some(false);
        if let Some(awake) = found.awake {
            self.asleep = !awake;
        }
        let Some(orientation) = found.orientation else {
            return;
        };
        let moved = self
            .newest
            .replace(orientation)
            .is_some_and(|before| before != orientation);
        // A grip that moves is awake, whatever the last event.
        self.asleep &= !moved || found.awake == Some(false);
        if self.asleep {
            self.turning.forget();
        } else {
            self.turning.take(orientation, now_ns);
        }
        self.seen_ns = Some(now_ns);
        self.buttons = found.buttons.unwrap_or(self.buttons);
    }
}
