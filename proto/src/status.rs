//! Status bits of a tool in a tick, equal to those of `sulcus_core::output::status`.
//!
//! Tests of the server compare the two definitions. A client passes unknown bits on and does not refuse them.

/// No hand holds the tool.
pub const ABSENT: u16 = 1;
/// The pose is too old (watchdog): force ramps to zero.
pub const STALE: u16 = 1 << 1;
/// Paused by the server side or by the student: force ramps to zero.
pub const PAUSED: u16 = 1 << 2;
/// Force or torque was clamped to its limit.
pub const SATURATED: u16 = 1 << 3;
/// The change of the wrench was limited in this tick.
pub const SLEW_LIMITED: u16 = 1 << 4;
/// The limit of substeps was reached: the motion continues in the next tick.
pub const EXHAUSTED: u16 = 1 << 5;
/// The solver gave no valid solution: the graphic pose was kept.
pub const SOLVER_FAILED: u16 = 1 << 6;
/// The input held a number that is not finite, or an invalid rotation: the last valid pose was used.
pub const BAD_INPUT: u16 = 1 << 7;
/// The hand moved faster than the limit: the haptic pose was clamped.
pub const SPEED_CLAMPED: u16 = 1 << 8;
/// Contact prediction ran with a smaller distance, because the capacity for contacts was exceeded.
pub const CONTACTS_FULL: u16 = 1 << 9;
/// The twist between hand and tool exceeds 90 degrees: torque no longer grows.
pub const TWIST_SATURATED: u16 = 1 << 10;
/// The wrench is below full strength because a ramp is running.
pub const RAMPING: u16 = 1 << 11;
/// Fault: a wrench or a tissue's state was not finite, or a case occurred that the program rules out.
///
/// A wrench that is not finite is replaced by zero. A tissue whose state is not finite returns to rest.
pub const FAULT: u16 = 1 << 12;
/// The change of force in this tick was limited: the tool continues in the next tick.
///
/// The full step would have changed the force by more than the hand's own motion and the settle limit allow.
pub const SETTLING: u16 = 1 << 13;
/// The *haptic* tool has no contact within 0.5 mm of any object. Devices arm only with this bit.
///
/// The server computes the bit 62.5 times a second and adds it to the tick's own bits.
pub const FREE: u16 = 1 << 14;
/// The graphic tool has not met the hand since its entry: it is still on its way.
pub const NOT_MET: u16 = 1 << 15;
