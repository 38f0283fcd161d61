//! Options of arms and grips.

use serde::{Deserialize, Serialize};

use super::motion::{Motion, Turn};

/// Arm: Inverse3, Inverse3x or Minverse, with the hand that holds it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ArmOptions {
    /// Id, unique in its array.
    pub id: String,
    /// Type.
    pub kind: ArmKind,
    /// Side that the config tells.
    pub handedness: Handedness,
    /// Status at the start.
    pub status: ArmStatus,
    /// True where the device is plugged in at the start.
    pub connected: bool,
    /// Motion of the hand at the start.
    pub motion: Motion,
    /// Mechanics of the arm itself.
    pub mechanics: Mechanics,
}

impl ArmOptions {
    /// An Inverse3, ready and at rest 0.1 m in front of its base and 0.1 m above.
    #[must_use]
    pub fn new(id: &str, handedness: Handedness) -> Self {
        Self {
            id: id.into(),
            kind: ArmKind::Inverse3,
            handedness,
            status: ArmStatus::default(),
            connected: true,
            motion: Motion::Rest {
                at: [0.0, 0.1, 0.1],
            },
            mechanics: Mechanics::default(),
        }
    }
}

/// Type of an arm.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ArmKind {
    /// Inverse3.
    Inverse3,
    /// Inverse3x.
    Inverse3x,
    /// Minverse.
    Minverse,
    /// A type that no client knows.
    Other(String),
}

impl ArmKind {
    /// Name in the config.
    pub(crate) fn name(&self) -> &str {
        match self {
            Self::Inverse3 => "inverse3",
            Self::Inverse3x => "inverse3x",
            Self::Minverse => "minverse",
            Self::Other(name) => name,
        }
    }

    /// Number in `device_info.device_type`.
    pub(crate) fn number(&self) -> u32 {
        match self {
            Self::Inverse3 | Self::Inverse3x => 4,
            Self::Minverse => 6,
            Self::Other(_) => 99,
        }
    }
}

/// Side of the body.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Handedness {
    /// Left.
    Left,
    /// Right.
    Right,
}

/// Status of an arm.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ArmStatus {
    /// The arm knows its angles.
    pub calibrated: bool,
    /// Another program uses the arm.
    pub in_use: bool,
    /// The arm has its power supply.
    pub power_supply: bool,
    /// The arm takes commands.
    pub ready: bool,
    /// The service has started the arm.
    pub started: bool,
}

impl Default for ArmStatus {
    fn default() -> Self {
        Self {
            calibrated: true,
            in_use: false,
            power_supply: true,
            ready: true,
            started: true,
        }
    }
}

/// Mechanics of an arm itself; the moving mass and the damping act with a held hand only.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Mechanics {
    /// Moving mass of the arm, in kg.
    pub mass_kg: f64,
    /// Damping of the arm, in N s/m.
    pub damping_n_s_per_m: f64,
    /// Step of every reported coordinate, in m; 0 for none.
    pub position_step_m: f64,
    /// Step of every displayed component of a force, in N; 0 for none.
    pub force_step_n: f64,
}

impl Default for Mechanics {
    fn default() -> Self {
        Self {
            mass_kg: 0.15,
            damping_n_s_per_m: 0.5,
            position_step_m: 1e-5,
            force_step_n: 0.014,
        }
    }
}

/// Grip with its own measurement of rotation.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GripOptions {
    /// Id.
    pub id: String,
    /// Arrays that the grip stands in; more than one is allowed.
    pub arrays: Vec<GripArray>,
    /// True where the grip is connected at the start.
    pub connected: bool,
    /// False where the grip sleeps at the start.
    pub awake: bool,
    /// Rotation at the start.
    pub turn: Turn,
    /// Rate of new rotations, in Hz.
    pub rate_hz: f64,
}

impl GripOptions {
    /// A wireless grip, awake and at rest.
    #[must_use]
    pub fn wireless(id: &str) -> Self {
        Self {
            id: id.into(),
            arrays: vec![GripArray::Wireless],
            connected: true,
            awake: true,
            turn: Turn::Rest {
                at: [1.0, 0.0, 0.0, 0.0],
            },
            rate_hz: 50.0,
        }
    }

    /// A wired grip at rest.
    #[must_use]
    pub fn wired(id: &str) -> Self {
        Self {
            arrays: vec![GripArray::Wired],
            ..Self::wireless(id)
        }
    }
}

/// Array of grips.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum GripArray {
    /// `verse_grip`.
    Wired,
    /// `wireless_verse_grip`.
    Wireless,
    /// `custom_verse_grip`.
    Custom,
}

impl GripArray {
    /// Every array, in the order of a reply.
    pub(crate) const ALL: [Self; 3] = [Self::Wired, Self::Wireless, Self::Custom];

    /// Name in a message.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Wired => "verse_grip",
            Self::Wireless => "wireless_verse_grip",
            Self::Custom => "custom_verse_grip",
        }
    }
}

/// Buttons and inner switch of a grip; a wired grip has the button `a` only.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Buttons {
    /// First button.
    pub a: bool,
    /// Second button.
    pub b: bool,
    /// Third button.
    pub c: bool,
    /// Level of the magnetic sensor.
    pub hall: u32,
}
