//! Reply of the service to a message: states of arms and grips.
//!
//! Every field may be absent or of another type, and is nothing then. A reply that is no JSON is no reply.

mod raw;

use sulcus_core::{Quat, Vec3};

/// Array of grips.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Array {
    /// `wireless_verse_grip`.
    Wireless,
    /// `verse_grip`.
    Wired,
    /// `custom_verse_grip`.
    Custom,
}

impl Array {
    /// Name in a message.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Wireless => "wireless_verse_grip",
            Self::Wired => "verse_grip",
            Self::Custom => "custom_verse_grip",
        }
    }
}

/// Reply.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Reply {
    /// Arms; `None` for a reply without their array.
    pub(super) arms: Option<Vec<Arm>>,
    /// Grips of each array in the reply.
    pub(super) grips: Vec<(Array, Vec<Grip>)>,
}

/// State of an arm.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Arm {
    /// Id.
    pub(super) id: String,
    /// Position, base axes, metres.
    pub(super) position: Option<Vec3>,
    /// Force that the service displays, base axes, newtons.
    pub(super) force: Option<Vec3>,
    /// Status.
    pub(super) status: ArmStatus,
}

/// Status of an arm.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct ArmStatus {
    /// The arm knows its angles.
    pub(super) calibrated: Option<bool>,
    /// A program uses the arm.
    pub(super) in_use: Option<bool>,
    /// The arm has its power supply.
    pub(super) power: Option<bool>,
    /// The arm takes commands.
    pub(super) ready: Option<bool>,
    /// The service has started the arm.
    pub(super) started: Option<bool>,
}

/// State of a grip.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Grip {
    /// Id.
    pub(super) id: String,
    /// Orientation, base axes.
    pub(super) orientation: Option<Quat>,
    /// Buttons, one bit each.
    pub(super) buttons: Option<u16>,
    /// Whether the grip is connected.
    pub(super) connected: Option<bool>,
    /// Whether the grip is awake.
    pub(super) awake: Option<bool>,
}

impl ArmStatus {
    /// Takes the fields that `newer` has.
    pub(super) fn update(&mut self, newer: &Self) {
        self.calibrated = newer.calibrated.or(self.calibrated);
        self.in_use = newer.in_use.or(self.in_use);
        self.power = newer.power.or(self.power);
        self.ready = newer.ready.or(self.ready);
        self.started = newer.started.or(self.started);
    }
}

impl Reply {
    /// Reads a reply. `None` for a text that is no object of JSON.
    pub(super) fn parse(text: &str) -> Option<Self> {
        raw::parse(text)
    }

    /// Arm of `id`.
    pub(super) fn arm(&self, id: &str) -> Option<&Arm> {
        self.arms.as_ref()?.iter().find(|arm| arm.id == id)
    }

    /// Grip of `id` in `array`.
    pub(super) fn grip(&self, array: Array, id: &str) -> Option<&Grip> {
        let (_, grips) = self.grips.iter().find(|(listed, _)| *listed == array)?;
        grips.iter().find(|grip| grip.id == id)
    }

    /// Whether the reply has `array`.
    pub(super) fn has(&self, array: Array) -> bool {
        self.grips.iter().any(|(listed, _)| *listed == array)
    }
}

#[cfg(test)]
mod tests;
