//! Bounds of the invariants: every number with its source, fixed before any run.

use sulcus_proto::limits::{POSE_STALE, WRENCH_SILENT};

use crate::seen::Facts;

/// Silence of the server after which the gate falls, nanoseconds: 20 ms, `proto/src/limits.rs`.
pub(super) const SILENT_NS: u64 = WRENCH_SILENT.as_nanos() as u64;
/// Age since its arrival at which a pose is stale at the server, nanoseconds: 50 ms, `proto/src/limits.rs`.
pub(super) const STALE_NS: u64 = POSE_STALE.as_nanos() as u64;
/// Fall of the gate, nanoseconds of its course: 20 ms, `SECURITY.md`, watchdog of wrenches.
const GATE_FALL_NS: u64 = 20_000_000;
/// Largest course of the gate in a pass, nanoseconds: 2 ms, `SECURITY.md`, step of the gate.
///
/// An overslept pass therefore shuts the gate later in time. The bounds of a device count passes for this reason.
const GATE_COURSE_NS: u64 = 2_000_000;
/// Rise of the gate after the begin and after a long silence, nanoseconds: 500 ms, `SECURITY.md`.
pub(super) const GATE_RISE_NS: u64 = 500_000_000;
/// Steepest slope of the gate over its whole course, without unit: 1.5.
///
/// Source: `SECURITY.md` bounds 2 ms of a course of 20 ms by 15 % of the force.
pub(super) const GATE_SLOPE: f64 = 1.5;
/// Silence after which the gate needs its long rise, nanoseconds: 50 ms, `SECURITY.md`.
pub(super) const LONG_SILENCE_NS: u64 = 50_000_000;
/// Ramp of the tick on a pause, a stale pose or an absent tool, nanoseconds of ticks run: 20 ms, `ramp_down_ms`.
const RAMP_DOWN_NS: u64 = 20_000_000;
/// Age of the pose behind a wrench from which on no force is left, nanoseconds: 120 ms, `DESIGN.md`, section 5.
pub(super) const POSE_OLD_NS: u64 = 120_000_000;
/// Time behind [`POSE_OLD_NS`] until the displayed force is zero, nanoseconds: 20 ms, issue 53, property of the gate.
const POSE_FALL_NS: u64 = 20_000_000;
/// Largest damping of the passivity controller beyond the simulation's force, newtons: 1 N, `SECURITY.md`.
pub(super) const BRAKE_N: f64 = 1.0;
/// Tolerance of a force in newtons and of a torque in newton metres; less counts as none. Chosen: 1e-5.
///
/// The wire rounds to f32. At 50 N, the largest force of a scene, a rounding is at most 2e-6 N.
pub(super) const ROUNDING: f64 = 1e-5;
/// Spare ticks or passes of every bound. Chosen: 1, for an event between two points of the grid.
const SPARE: u64 = 1;

/// Bounds of one session, from its facts.
pub(super) struct Bounds {
    /// Facts of the session.
    pub(super) facts: Facts,
    /// Largest change of a force in a tick or a pass, newtons.
    pub(super) force_step_n: f64,
    /// Largest change of a torque in a tick or a pass, newton metres.
    pub(super) torque_step_nm: f64,
    /// Number of ticks under a pause, a stale pose or an absence that may still send a force.
    ///
    /// The ramp comes before the clamp, so a strong raw force is at the limit until the ramp ends. Its fall then takes
    /// the time of the slew limit.
    pub(super) quiet_ticks: u64,
    /// Number of passes until a displayed wrench is zero behind a target of zero.
    pub(super) slew_passes: u64,
    /// Number of passes in silence, from [`SILENT_NS`] on, that may still display a force.
    pub(super) shut_passes: u64,
    /// Number of passes on a pose older than [`POSE_OLD_NS`] that may still display a force.
    pub(super) aged_passes: u64,
}

impl Bounds {
    /// Derives the bounds. All facts are finite and above 0.
    pub(super) fn new(facts: Facts) -> Self {
        let period_ms = facts.tick_ns as f64 / 1e6;
        let force_step_n = facts.max_force_step_n * period_ms;
        let torque_step_nm = facts.max_torque_step_nm * period_ms;
        let slew = (facts.max_force_n / force_step_n).max(facts.max_torque_nm / torque_step_nm);
        let slew = slew.ceil() as u64;
        let course_ns = facts.tick_ns.min(GATE_COURSE_NS);
        Self {
            force_step_n,
            torque_step_nm,
            quiet_ticks: RAMP_DOWN_NS.div_ceil(facts.tick_ns) + slew + SPARE,
            slew_passes: slew + SPARE,
            shut_passes: GATE_FALL_NS.div_ceil(course_ns) + slew + SPARE,
            aged_passes: POSE_FALL_NS.div_ceil(facts.tick_ns).max(slew) + SPARE,
            facts,
        }
    }

    /// Smaller of the scene's limit and a further force limit, newtons; 0 for no further limit.
    pub(super) fn limit_n(&self, force_limit_n: f64) -> f64 {
        if force_limit_n > 0.0 && force_limit_n < self.facts.max_force_n {
            force_limit_n
        } else {
            self.facts.max_force_n
        }
    }
}
