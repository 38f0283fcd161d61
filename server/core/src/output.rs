//! Output of one tick. Conditions that are normal at 1 kHz (a full list, exhausted substeps) are status bits, not
//! errors.

use crate::{MAX_TOOLS, Pose, Wrench};

/// Status bits of one tool in one tick; several can be set.
pub mod status {
    /// No hand holds the tool, or no valid pose has arrived since the hand took the tool.
    pub const ABSENT: u16 = 1;
    /// The pose is too old (watchdog), or was invalid for 50 ms or more: the force ramps to zero.
    pub const STALE: u16 = 1 << 1;
    /// The instructor has paused the session: the force ramps to zero.
    pub const PAUSED: u16 = 1 << 2;
    /// Force or torque for the hand was clamped to its limit.
    pub const SATURATED: u16 = 1 << 3;
    /// The change of the wrench for the hand was limited in this tick (`Params::max_force_step`,
    /// `Params::max_torque_step`).
    pub const SLEW_LIMITED: u16 = 1 << 4;
    /// The tick reached `Params::max_substeps` or `Params::max_work` before convergence: the rest of the motion follows
    /// in the next tick.
    pub const EXHAUSTED: u16 = 1 << 5;
    /// The solver gave no usable solution in the last substep. The graphic pose stayed as before that substep, and the
    /// force ramps to zero.
    pub const SOLVER_FAILED: u16 = 1 << 6;
    /// The pose in the input was not finite, beyond 10 m in a coordinate or not a rotation. The last valid haptic pose
    /// was used.
    pub const BAD_INPUT: u16 = 1 << 7;
    /// The hand moved or turned faster than `Params::max_hand_speed` or `Params::max_hand_spin`: the haptic pose was
    /// clamped.
    pub const SPEED_CLAMPED: u16 = 1 << 8;
    /// The contact list or the problem was full at least once, or one sphere of the tool met too many walls of one
    /// object ([`crate::blend::MAX_SEEDS`]). Contact prediction then used a smaller distance.
    pub const CONTACTS_FULL: u16 = 1 << 9;
    /// The twist, the whole rotation from the graphic to the haptic pose, exceeds 90 degrees: the torque of the
    /// coupling no longer grows.
    pub const TWIST_SATURATED: u16 = 1 << 10;
    /// The ramp factor of the wrench is below 1.
    pub const RAMPING: u16 = 1 << 11;
    /// A value was not finite, or the program reached an impossible case. A wrench that is not finite is sent as zero;
    /// a tissue that is not finite is reset to rest.
    pub const FAULT: u16 = 1 << 12;
    /// The change of the raw force was limited in this tick (`Params::max_settle_step`). The graphic tool is on its
    /// way, without penetration, and continues in the next tick.
    pub const SETTLING: u16 = 1 << 13;
    /// Haptic tool clear of all objects: no contact within half a millimetre. The tick never sets this bit. A server
    /// sets the bit on the wire by [`crate::clearance::is_free`].
    pub const FREE: u16 = 1 << 14;
    /// Graphic and haptic tool have not met since the tool entered: the force is no act of the hand yet, and no event
    /// counts. See [`crate::state::Arrival`]. Never set in scenes up to version 7.
    pub const NOT_MET: u16 = 1 << 15;
}

/// Zone of the force of a tool on the floor of a pocket. A zone starts at its threshold.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum ForceZone {
    /// Recommended probing force, or no force.
    #[default]
    Light,
    /// Above the recommended probing force (from 0.25 N by default): the probing depth reads too deep.
    TooHeavy,
    /// Healthy tissue bleeds (from 0.5 N by default).
    Trauma,
    /// The paper's threshold of damage is reached (200 g: from 1.96 N by default).
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

/// Reading of a tool whose tip is in a pocket, at the graphic pose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PocketReading {
    /// Index of the gingiva to which the pocket belongs, among the objects of the scene.
    pub object: u16,
    /// Angle of the tip about the tooth's axis, radians, -pi to pi; 0 is mesial, pi/2 is buccal.
    pub around: f64,
    /// Probing depth, metres, positive: distance of the tip below the gingival margin along the tooth's axis. The
    /// margin is taken at the angle `around`.
    pub depth: f64,
    /// Force of the tool on the floor of the pocket along the tooth's axis, newtons, at least 0.
    pub floor_force: f64,
    /// Zone of `floor_force`. A heavier zone begins at its threshold. A zone is left for a lighter one only when the
    /// force is under `GingivaParams::rearm` times the threshold of the zone.
    pub zone: ForceZone,
    /// Whether the zone was entered in this tick from a lighter zone: an event.
    pub entered_zone: bool,
}

/// Output of one tool in a tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ToolOutput {
    /// Wrench for the hand, about the device point, world axes, N and N m; after ramp, clamp and slew.
    pub wrench: Wrench,
    /// Wrench about the same point and axes before ramp, clamp and slew: minus the sum of the tool's loads on the
    /// objects. Zero for an absent tool.
    pub raw_wrench: Wrench,
    /// Graphic pose, `world_from_tool`.
    pub graphic: Pose,
    /// Haptic pose after validation and speed limit, `world_from_tool`.
    pub haptic: Pose,
    /// Bits of [`status`].
    pub status: u16,
    /// Number of substeps; 0 for an absent tool.
    pub substeps: u8,
    /// Number of rows of this tool in the last problem.
    pub rows: u16,
    /// Number of these rows with a positive multiplier; 0 after [`status::SOLVER_FAILED`].
    pub active: u16,
    /// Smallest true gap of this tool after the last step, over the pairs in the contact list, metres. Blended gaps
    /// count only within the prediction distance. Negative for penetration; `f64::INFINITY` without such a gap.
    pub min_gap: f64,
    /// Whether the tick converged: the last step was small or limited ([`status::SETTLING`]), and no true gap is below
    /// -0.5 um (default of `Params::converged_gap`). True for an absent tool.
    pub converged: bool,
    /// Reading of the pocket; `None` with the tip outside pockets.
    pub pocket: Option<PocketReading>,
}

impl ToolOutput {
    /// Returns the output of a slot without a tool, or with a tool never held, at `pose` (`world_from_tool`).
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
    /// Number of this tick on the clock's grid; skipped ticks leave gaps.
    pub tick: u64,
    /// Chained hash (XXH3) of the input's bytes, the previous hash and the state.
    pub hash: u64,
    /// Output per tool slot.
    pub tools: [ToolOutput; MAX_TOOLS],
    /// Counted work of the tick, operations; see [`crate::work`]. The same on every machine and for every workspace.
    pub work: u32,
}
