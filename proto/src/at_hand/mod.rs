//! Exact inputs of ticks that run at the hand: rows, and their compact form in [`crate::control::InputBatch`].

mod bits;
mod columns;
mod pack;

pub use pack::{MOST_ROWS, Packer, Unpacker};

use crate::TOOLS;
use crate::datagram::{WirePose, WireWrench};

/// Ticks between two batches at 1 kHz: a batch leaves every 5 ms.
pub const BATCH_MS: u64 = 5;
/// Interval between two live poses of a session with ticks at the hand, milliseconds. The exact inputs follow on a
/// stream; the live pose shows the hand before they arrive.
pub const LIVE_POSE_MS: u64 = 20;
/// Interval between two wrench datagrams of such a session, milliseconds. They carry the levels in force and the newest
/// tick that the server has computed.
pub const LEVELS_MS: u64 = 10;

/// Input of one tick at the hand, with the device's sample behind it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct HandRow {
    /// Number of ticks that were skipped just before this one.
    pub skipped: u16,
    /// Whether the session is paused.
    pub paused: bool,
    /// Force limit, newtons; 0 for the scene's limit.
    pub force_limit_n: f32,
    /// Level of detail of tissue.
    pub detail: u8,
    /// Slots of the tools.
    pub tools: [HandTool; TOOLS],
}

/// Input of one tool, with the device's sample behind it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct HandTool {
    /// Whether a hand holds the tool.
    pub present: bool,
    /// Whether the pose is too old.
    pub stale: bool,
    /// Age of the pose, ticks.
    pub age_ticks: u16,
    /// Buttons, one bit each.
    pub buttons: u16,
    /// Pose of the tick's input.
    pub pose: WirePose,
    /// Number of the device's reading, wrapping at 2^32.
    pub sequence: u32,
    /// Time of the device's reading, nanoseconds of the client's monotonic clock.
    pub device_time_ns: u64,
    /// Bits of the wrench displayed at the reading, exclusive-or those of the wrench of the tick before: force, then
    /// torque. Zero where the door changed nothing.
    pub changed: [u32; 6],
}

impl HandTool {
    /// Bits of the difference of `displayed` from `ticked`, the wrench of the tick before.
    pub fn change(displayed: &WireWrench, ticked: &WireWrench) -> [u32; 6] {
        let (displayed, ticked) = (numbers(displayed), numbers(ticked));
        std::array::from_fn(|k| displayed[k].to_bits() ^ ticked[k].to_bits())
    }

    /// Displayed wrench, from that of the tick before.
    pub fn displayed(&self, ticked: &WireWrench) -> WireWrench {
        let ticked = numbers(ticked);
        let [fx, fy, fz, tx, ty, tz] =
            std::array::from_fn(|k| f32::from_bits(ticked[k].to_bits() ^ self.changed[k]));
        WireWrench {
            force: [fx, fy, fz],
            torque: [tx, ty, tz],
        }
    }
}

fn numbers(wrench: &WireWrench) -> [f32; 6] {
    let ([fx, fy, fz], [tx, ty, tz]) = (wrench.force, wrench.torque);
    [fx, fy, fz, tx, ty, tz]
}
