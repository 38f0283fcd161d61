//! Status bits of one tool in one tick, as `sulcus_core::output::status` defines them (the server's
//! tests hold the two together). Bits that a station does not know are passed on, not refused.

/// No hand holds the tool.
pub const ABSENT: u16 = 1;
/// The pose is too old (watchdog): force ramps to zero.
pub const STALE: u16 = 1 << 1;
/// Paused by the instructor: force ramps to zero.
pub const PAUSED: u16 = 1 << 2;
/// Force or torque was clamped to its limit.
pub const SATURATED: u16 = 1 << 3;
/// The wrench's change was limited in this tick.
pub const SLEW_LIMITED: u16 = 1 << 4;
/// Substeps ran out: the rest of the motion happens next tick.
pub const EXHAUSTED: u16 = 1 << 5;
/// The solver gave no usable answer: the pose was kept.
pub const SOLVER_FAILED: u16 = 1 << 6;
/// The input was no pose: the last good one was used.
pub const BAD_INPUT: u16 = 1 << 7;
/// The hand moved faster than the clamp.
pub const SPEED_CLAMPED: u16 = 1 << 8;
/// Contact prediction ran with a smaller distance, because contacts had no room.
pub const CONTACTS_FULL: u16 = 1 << 9;
/// The twist between hand and tool exceeds 90 degrees: torque no longer grows.
pub const TWIST_SATURATED: u16 = 1 << 10;
/// The wrench is below full strength because a ramp is running.
pub const RAMPING: u16 = 1 << 11;
/// A number that is not finite was about to reach the hand; zero was sent instead.
pub const FAULT: u16 = 1 << 12;
/// The force would have changed by more in this tick than the hand's own motion brings: the tool goes on in the next one.
pub const SETTLING: u16 = 1 << 13;
