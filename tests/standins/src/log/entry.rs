//! Entries of the log.

use crate::board::{Call, Mode, OffCause};
use crate::rig::Fault;
use serde::{Deserialize, Serialize};

/// One entry.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Entry {
    /// Time of the event on the controller's monotonic clock, ns. A command counts from its sending.
    pub t: u64,
    /// Time when the controller wrote the entry, ns.
    pub seen: u64,
    /// Number of the device in [`crate::setup::Setup::devices`]; none for events of a whole library.
    pub device: Option<usize>,
    /// What happened.
    pub event: Event,
}

/// What happened.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Event {
    /// The controller started; true when it got the real-time class.
    Started(bool),
    /// A process opened the device.
    Open {
        /// The process.
        pid: u32,
    },
    /// A library refused to open a device.
    Refused {
        /// The process.
        pid: u32,
        /// Error code of the vendor.
        code: u32,
    },
    /// The device was closed.
    Close {
        /// The process.
        pid: u32,
        /// The way.
        way: Closed,
    },
    /// A force command.
    Command(CommandEntry),
    /// The motors changed their output. Every change has an entry.
    Motors {
        /// Force in N. Gravity compensation is not part of it.
        #[serde(with = "lossy")]
        force: [f64; 3],
        /// Torque in N m.
        #[serde(with = "lossy")]
        torque: [f64; 3],
        /// Why the output changed.
        cause: Cause,
    },
    /// The hardware watchdog turned the motors off.
    Watchdog {
        /// Time since the last command in ns.
        silent: u64,
    },
    /// A DHD controller changed its mode.
    Mode {
        /// The mode before.
        from: Mode,
        /// The mode now.
        to: Mode,
        /// Cause of force off.
        cause: OffCause,
    },
    /// The driver reported an error to the client.
    Error {
        /// Error code of the vendor.
        code: u32,
        /// The process.
        pid: u32,
    },
    /// The client made a call.
    Call {
        /// The call.
        call: Call,
        /// The number of the call.
        value: f64,
        /// The process.
        pid: u32,
    },
    /// The calibration is right now.
    Calibrated,
    /// The motors got too warm, or cool again.
    Warm(bool),
    /// The test caused a fault.
    Fault(Fault),
    /// The test gave the device another hand.
    Hand,
    /// A full ring lost messages; the log is not complete.
    Lost(u64),
}

/// A force command, as it arrived.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CommandEntry {
    /// The process.
    pub pid: u32,
    /// Number of the frame or command of this device, from 1 since its opening.
    pub frame: u64,
    /// Tick of the driver's scheduler; 0 outside of the scheduler and for DHD.
    pub tick: u64,
    /// Stamp of the pose that the driver showed last, ns.
    pub pose_stamp: u64,
    /// How often the client set a force or torque within the frame.
    pub sets: u64,
    /// True when the driver's force output is on.
    pub enabled: bool,
    /// Force that the client asked for in N; NaN for a number that is not finite.
    #[serde(with = "lossy")]
    pub asked_force: [f64; 3],
    /// Torque that the client asked for in N m.
    #[serde(with = "lossy")]
    pub asked_torque: [f64; 3],
    /// Force that the driver sent in N.
    #[serde(with = "lossy")]
    pub force: [f64; 3],
    /// Torque that the driver sent in N m.
    #[serde(with = "lossy")]
    pub torque: [f64; 3],
    /// Why the motors do not follow the command; none when they follow it.
    pub ignored: Option<Cause>,
    /// True position of the handle in m at the time of the command.
    #[serde(with = "lossy")]
    pub position: [f64; 3],
}

/// Why the motors put out what they put out.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Cause {
    /// A command.
    Command,
    /// The command was larger than the motors are able to follow.
    Saturated,
    /// The driver's force output is off.
    Disabled,
    /// The hardware watchdog.
    Watchdog,
    /// The motors are too warm.
    Warm,
    /// The device is unplugged.
    Unplugged,
    /// The controller's mode has no force.
    Mode,
    /// The device was closed.
    Closed,
    /// The numbers of the command are not finite.
    NotFinite,
}

/// How a device was closed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Closed {
    /// By the driver's call.
    Call,
    /// At the orderly exit of the process.
    Exit,
    /// The process died.
    Died,
}

/// Vectors in JSON, which has no NaN: a number that is not finite becomes `null` and is read as NaN.
pub mod lossy {
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    /// Writes the vector.
    pub fn serialize<S: Serializer>(v: &[f64; 3], to: S) -> Result<S::Ok, S::Error> {
        v.serialize(to)
    }

    /// Reads the vector.
    pub fn deserialize<'a, D: Deserializer<'a>>(from: D) -> Result<[f64; 3], D::Error> {
        Ok(<[Option<f64>; 3]>::deserialize(from)?.map(|c| c.unwrap_or(f64::NAN)))
    }
}
