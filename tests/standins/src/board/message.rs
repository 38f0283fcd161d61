//! Messages of a driver library to the controller, and their form as words.

use super::ring::WORDS;
use serde::{Deserialize, Serialize};

/// Device number of a message that concerns the whole library.
pub const NO_DEVICE: u64 = u64::MAX;

/// A force command for one device.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Command {
    /// Number of the frame or command of this device, from 1 since the driver opened it.
    pub frame: u64,
    /// Tick of the driver's scheduler; 0 outside of the scheduler and for DHD.
    pub tick: u64,
    /// Stamp of the pose that the driver showed last, ns.
    pub pose_stamp: u64,
    /// How often the client set a force or torque within the frame.
    pub sets: u64,
    /// True when the driver's force output is on.
    pub enabled: bool,
    /// Force that the client asked for in N.
    pub asked_force: [f64; 3],
    /// Torque that the client asked for in N m.
    pub asked_torque: [f64; 3],
    /// Force that the driver sent after its own limits and ramp in N.
    pub force: [f64; 3],
    /// Torque that the driver sent in N m.
    pub torque: [f64; 3],
}

/// Calls of a client that the controller logs. A call carries one number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[repr(u32)]
pub enum Call {
    /// `hdStartScheduler`.
    StartScheduler = 1,
    /// `hdStopScheduler`.
    StopScheduler,
    /// `hdSetSchedulerRate`; the number is the rate in Hz.
    SchedulerRate,
    /// `hdScheduleAsynchronous` or `hdScheduleSynchronous`; the number is the priority.
    Schedule,
    /// `hdUnschedule`.
    Unschedule,
    /// `hdEnable`; the number is the capability.
    Enable,
    /// `hdDisable`; the number is the capability.
    Disable,
    /// `hdUpdateCalibration`; the number is the style.
    UpdateCalibration,
    /// A stall of the scheduler that took place; the number is its length in ms.
    Stall,
    /// `dhdEnableForce`.
    EnableForce,
    /// `dhdSetBrakes`.
    Brakes,
    /// `dhdStop`.
    Stop,
    /// `dhdSetWatchdog`; the number counts 125 us.
    Watchdog,
    /// `dhdSetGravityCompensation`.
    Gravity,
    /// `dhdSetEffectorMass` in kg.
    EffectorMass,
    /// `dhdSetMaxForce` in N.
    MaxForce,
    /// `drdAutoInit`.
    AutoInit,
    /// `drdStop`; the number is 1 when the force stays on.
    RegulationStop,
    /// `dhdSetTimeGuard` in us.
    TimeGuard,
    /// `dhdEmulateButton`.
    EmulateButton,
    /// `dhdSetVelocityThreshold`.
    VelocityThreshold,
    /// `dhdEnableExpertMode`.
    ExpertMode,
}

/// Calls by their number minus one.
const CALLS: [Call; 22] = [
    Call::StartScheduler,
    Call::StopScheduler,
    Call::SchedulerRate,
    Call::Schedule,
    Call::Unschedule,
    Call::Enable,
    Call::Disable,
    Call::UpdateCalibration,
    Call::Stall,
    Call::EnableForce,
    Call::Brakes,
    Call::Stop,
    Call::Watchdog,
    Call::Gravity,
    Call::EffectorMass,
    Call::MaxForce,
    Call::AutoInit,
    Call::RegulationStop,
    Call::TimeGuard,
    Call::EmulateButton,
    Call::VelocityThreshold,
    Call::ExpertMode,
];

/// A message of a driver library.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Message {
    /// The library opened the device.
    Open,
    /// The library refused to open the device, with the vendor's error code.
    Refused(u32),
    /// The library closed the device: true at the exit of the process, false by a call.
    Close(bool),
    /// A force command.
    Command(Command),
    /// An error that the library reported to the client, with the vendor's code.
    Error(u32),
    /// A call.
    Call(Call, f64),
}

/// A message with its device, process and time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Packet {
    /// Number of the device on the board, or [`NO_DEVICE`].
    pub device: u64,
    /// Process that sent the message.
    pub pid: u32,
    /// Time of sending, monotonic clock, ns.
    pub sent: u64,
    /// True when the sender waits until the controller handled the message.
    pub waits: bool,
    /// The message.
    pub message: Message,
}

impl Packet {
    /// The packet as words.
    pub fn words(&self) -> [u64; WORDS] {
        let mut w = [0u64; WORDS];
        w[1] = self.device;
        w[2] = u64::from(self.pid);
        w[3] = self.sent;
        w[23] = u64::from(self.waits);
        match self.message {
            Message::Open => w[0] = 1,
            Message::Refused(code) => (w[0], w[4]) = (2, u64::from(code)),
            Message::Close(exit) => (w[0], w[4]) = (3, u64::from(exit)),
            Message::Command(c) => {
                w[0] = 4;
                w[4..9].copy_from_slice(&[
                    c.frame,
                    c.tick,
                    c.pose_stamp,
                    c.sets,
                    u64::from(c.enabled),
                ]);
                for (i, v) in [c.asked_force, c.asked_torque, c.force, c.torque]
                    .iter()
                    .enumerate()
                {
                    w[9 + 3 * i..12 + 3 * i].copy_from_slice(&v.map(f64::to_bits));
                }
            }
            Message::Error(code) => (w[0], w[4]) = (5, u64::from(code)),
            Message::Call(call, value) => (w[0], w[4], w[5]) = (6, call as u64, value.to_bits()),
        }
        w
    }

    /// The packet of `words`; none for words of no known message.
    pub fn read(words: &[u64; WORDS]) -> Option<Self> {
        let w = words;
        let v = |i: usize| [w[i], w[i + 1], w[i + 2]].map(f64::from_bits);
        let message = match w[0] {
            1 => Message::Open,
            2 => Message::Refused(w[4] as u32),
            3 => Message::Close(w[4] != 0),
            4 => Message::Command(Command {
                frame: w[4],
                tick: w[5],
                pose_stamp: w[6],
                sets: w[7],
                enabled: w[8] != 0,
                asked_force: v(9),
                asked_torque: v(12),
                force: v(15),
                torque: v(18),
            }),
            5 => Message::Error(w[4] as u32),
            6 => Message::Call(
                *CALLS.get((w[4] as usize).wrapping_sub(1))?,
                f64::from_bits(w[5]),
            ),
            _ => return None,
        };
        Some(Self {
            device: w[1],
            pid: w[2] as u32,
            sent: w[3],
            waits: w[23] != 0,
            message,
        })
    }
}
