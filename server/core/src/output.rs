//! What one tick says. Trouble that is normal at 1 kHz (a full buffer, an exhausted budget) is
//! data here, never an error.

use crate::{MAX_TOOLS, Pose, Wrench};

/// Status bits of one tool in one tick.
pub mod status {
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
    /// The input held a number that is not finite, or no rotation: the last good pose was used.
    pub const BAD_INPUT: u16 = 1 << 7;
    /// The hand moved faster than the clamp: the haptic pose was limited.
    pub const SPEED_CLAMPED: u16 = 1 << 8;
    /// The contact buffer was full at least once, or one sphere of the tool had more walls of one object about it than there
    /// are rows for: contact prediction ran with a smaller distance.
    pub const CONTACTS_FULL: u16 = 1 << 9;
    /// The twist between hand and tool exceeds 90 degrees: torque no longer grows.
    pub const TWIST_SATURATED: u16 = 1 << 10;
    /// The wrench is below full strength because a ramp is running.
    pub const RAMPING: u16 = 1 << 11;
    /// A number that is not finite was about to reach the hand; zero was sent instead.
    pub const FAULT: u16 = 1 << 12;
    /// The force would have changed by more in this tick than the hand's own motion brings: the tool is on its way, outside of
    /// everything, and goes on in the next tick.
    pub const SETTLING: u16 = 1 << 13;
}

/// How heavy a hand is on the floor of a pocket.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum ForceZone {
    /// As it should be, or no force at all.
    #[default]
    Light,
    /// Above the force that probing is done with (0.25 N by default): reads too deep.
    TooHeavy,
    /// Healthy tissue bleeds (0.5 N by default).
    Trauma,
    /// The paper's threshold of damage (200 g: 1.96 N by default).
    Damage,
}

impl ForceZone {
    /// All zones, lightest first.
    pub const ALL: [ForceZone; 4] = [
        ForceZone::Light,
        ForceZone::TooHeavy,
        ForceZone::Trauma,
        ForceZone::Damage,
    ];
}

/// What a tool in a pocket reads.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PocketReading {
    /// Index of the object that the pocket belongs to.
    pub object: u16,
    /// Where the tip is around the tooth, radians from mesial over buccal, -pi to pi.
    pub around: f64,
    /// Probing depth: how far the very tip is below the gingival margin there, along the tooth's axis,
    /// metres.
    pub depth: f64,
    /// Force on the floor along the tooth's axis, newtons.
    pub floor_force: f64,
    /// Zone that the force is in; it is left only when the force is under a share of the zone's threshold (`rearm`).
    pub zone: ForceZone,
    /// Whether the zone was entered in this tick, from a lighter one: an event.
    pub entered_zone: bool,
}

/// What a tick says of one tool.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ToolOutput {
    /// For the hand: about the device point, world axes; after ramp, clamp and slew.
    pub wrench: Wrench,
    /// The same point and axes, before ramp, clamp and slew: minus the sum of the loads applied.
    pub raw_wrench: Wrench,
    /// Graphic tool: `world_from_tool`, constrained.
    pub graphic: Pose,
    /// Haptic tool after sanitising: `world_from_tool`.
    pub haptic: Pose,
    /// Bits of [`status`].
    pub status: u16,
    /// Collide-and-solve passes made.
    pub substeps: u8,
    /// Rows in the last problem.
    pub rows: u16,
    /// Rows that carry load.
    pub active: u16,
    /// Smallest true gap after the move over the pairs in the problem, metres (negative:
    /// penetration); `f64::INFINITY` without rows.
    pub min_gap: f64,
    /// Whether the tick converged: last step small (or held back: [`status::SETTLING`]), every true gap at least -0.5 um.
    pub converged: bool,
    /// What the tool reads in a pocket, while it is in one.
    pub pocket: Option<PocketReading>,
}

impl ToolOutput {
    /// What is said of a slot without a tool, or of one that was never held, at `pose` (`world_from_tool`).
    pub fn absent(pose: Pose) -> Self {
        Self {
            wrench: Wrench::ZERO,
            raw_wrench: Wrench::ZERO,
            graphic: pose,
            haptic: pose,
            status: status::ABSENT,
            substeps: 0,
            rows: 0,
            active: 0,
            min_gap: f64::INFINITY,
            converged: true,
            pocket: None,
        }
    }
}

/// Output of one tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TickOutput {
    /// Number of this tick: the clock's grid, so skipped ticks leave holes.
    pub tick: u64,
    /// Chained hash over the previous hash, the input's bytes and the state.
    pub hash: u64,
    /// Per tool slot.
    pub tools: [ToolOutput; MAX_TOOLS],
}
