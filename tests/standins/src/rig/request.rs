//! What a rig and its controller say to each other: one JSON value in each line.

use crate::board::{Calibration, Mode, OffCause};
use crate::pose::Pose;
use crate::setup::{Hand, Setup};
use serde::{Deserialize, Serialize};

/// A request of the rig.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub enum Request {
    /// Starts the devices; the first request.
    Start(Box<Setup>),
    /// Causes a fault of a device.
    Fault(usize, Fault),
    /// Gives a device another hand.
    Hand(usize, Box<Hand>),
    /// Asks for the true state of a device.
    Snapshot(usize),
    /// Asks that the log's file holds everything up to now.
    Sync,
}

/// An answer of the controller.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub enum Response {
    /// Done.
    Done,
    /// The true state of a device.
    Snapshot(Snapshot),
    /// The request is not possible, and why.
    Refused(String),
}

/// A fault, or an act of the user.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Fault {
    /// The cable is pulled: the box gets no command, and the driver reads no pose.
    Unplug,
    /// The cable is plugged in again. A client must open the device anew.
    Replug,
    /// The motors are at their largest heat.
    Warm,
    /// The motors are cool.
    Cool,
    /// The scheduler stops once for so many ms.
    Stall(u32),
    /// Largest random delay of a scheduler tick in us.
    Jitter(u32),
    /// Real rate of the scheduler in Hz; 0 for the rate that the client set.
    Rate(u32),
    /// State of the calibration.
    Calibration(Calibration),
    /// Measured positions are NaN, or right again.
    PoseNan(bool),
    /// Measured positions move at once by these m, and stay there.
    Jump([f64; 3]),
    /// Bits of the buttons that are down.
    Buttons(u64),
    /// The stylus is in its well, or out of it.
    Inkwell(bool),
    /// The FORCE button of a DHD device is lit, or not.
    ForceButton(bool),
    /// The dead man's switch of a DHD device opens.
    DeadMan,
    /// The driver reports this error code once.
    Error(u32),
    /// Every opening of the device reports this error code; 0 for none.
    OpenError(u32),
    /// `hdDisableDevice` ends in a memory fault, or does not.
    CrashOnDisable(bool),
    /// Version that `hdGetString` shows.
    Version(String),
    /// Time without a command after which the hardware turns the motors off, in ms.
    WatchdogMs(f64),
    /// Time from a command to the motors in us.
    LatencyUs(f64),
}

/// True state of a device.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Snapshot {
    /// Time of the state, monotonic clock, ns.
    pub t: u64,
    /// True pose of the handle.
    pub pose: Pose,
    /// Velocity of the handle in m/s.
    pub velocity: [f64; 3],
    /// Force of the motors in N.
    pub force: [f64; 3],
    /// Torque of the motors in N m.
    pub torque: [f64; 3],
    /// Process that has the device open; 0 for none.
    pub owner: u32,
    /// True when a dead owner locked the device.
    pub locked: bool,
    /// True while the device is plugged in.
    pub plugged: bool,
    /// Mode of the controller.
    pub mode: Mode,
    /// Cause of force off.
    pub cause: OffCause,
    /// State of the calibration.
    pub calibration: Calibration,
    /// Heat of the motors over their budget.
    pub heat: f64,
    /// Commands so far.
    pub commands: u64,
}
