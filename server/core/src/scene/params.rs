//! Parameters of the tick, stored in the scene and so in every recording.

use serde::{Deserialize, Serialize};

use crate::optimise::SolverKind;

/// Parameters of contact prediction, optimisation and wrench. SI units.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Params {
    /// Tick rate, 1/s. Default 1000, range 250..8000. A higher rate displays textures and harder walls, and leaves less
    /// time for a tick. A device with the damping `b` (N s/m) displays a stiffness of at most about `2 b rate_hz`.
    /// Parameters per millisecond do not depend on the rate.
    pub rate_hz: u16,
    /// Smallest prediction distance, metres. Default 3e-6, range 1e-6..1e-3. Larger: fewer substeps, more rows. A full
    /// contact list can shorten the distance further. Source: notes of the prototype, section 2. The paper's fixed 0.5
    /// mm is larger than the sphere spacing at level 3.
    pub predict_min: f64,
    /// Largest prediction distance, metres. Default 5e-4 (the paper's d, section 3.2), range `predict_min`..1e-2.
    pub predict_max: f64,
    /// Prediction distance in metres per metre of motion, and per radian of turn and metre of lever. Default 1.2, range
    /// 0..10.
    ///
    /// The motion is that of the hand in the first substep, and the remaining step in later substeps. If a tissue
    /// nearby is out of rest, the distance per metre of motion is 2.5 times as large.
    pub predict_gain: f64,
    /// Prediction distance added to the motion, metres. Default 3e-6, range 0..1e-3. A tenth of the prototype's value
    /// costs a few more passes and saves most of the rows at fine levels.
    pub predict_bias: f64,
    /// Share of the prediction distance that the graphic tool and the tissue together may move in a substep. Default
    /// 0.95, range 0.1..0.99. At 1 or more contacts could be missed.
    pub trust: f64,
    /// Largest number of substeps in a tick. Default 8, range 1..64. More substeps keep faster hands exact and lengthen
    /// the worst tick.
    pub max_substeps: u8,
    /// Largest step of a substep that ends the tick, metres: motion of the sphere with the longest lever, plus that of
    /// the tissue. Default 5e-5, range 1e-9..1e-3.
    pub converged_step: f64,
    /// Deepest penetration allowed in a converged tick, metres. The gap is that of the pose reached, on a blended
    /// object the blended gap. Default 5e-7, range 1e-10..1e-5.
    pub converged_gap: f64,
    /// Compliance of a contact, added on the diagonal of every row, m/N. Default 1e-8 (1e-5 mm/N), range 1e-12..1e-3.
    /// The compliance keeps any set of rows feasible. The prototype's 1e-7 uses up the allowed gap (0.5 um) with 5 N on
    /// one sphere, and no tick converges. At 1e-8 the solver's residual is still under 1e-9.
    pub contact_compliance: f64,
    /// Solver used in the tick. Default: the active set.
    pub solver: SolverKind,
    /// Iteration limit of the active-set solver. Default 400, range 10..10000.
    pub max_iterations: u16,
    /// Capacity of each tool's contact list. Default 1024, range 16..4096. With blended surfaces the capacity is four
    /// times as large, because a blended row has many contacts. With a yielding object a problem holds at most 256
    /// rows, because the compliance matrix is dense. On overflow the tick uses a shorter prediction distance.
    pub max_contacts: u16,
    /// Whether rigid objects with trees calibrated for blending are touched as one smooth surface ([`crate::blend`]).
    /// Otherwise, and always on tissue, every sphere is touched as it is. Default true. Without blending a tick on a
    /// tooth takes a third to a tenth of the time, and the spheres are felt as ripple. Measured on the ellipsoid at
    /// level 3: 2.0 % of the force without blending, 0.6 % with. Source: the bench `ripple`.
    pub blend: bool,
    /// Speed limit of the hand at the device point, m/s. Default 10, range 0.1..100. Faster input is clamped and
    /// flagged as `SPEED_CLAMPED`.
    pub max_hand_speed: f64,
    /// Limit of the hand's angular speed, rad/s. Default 100, range 1..1000. Faster input is clamped and flagged as
    /// `SPEED_CLAMPED`.
    pub max_hand_spin: f64,
    /// Largest force sent to a hand, N. Default 3.3 (continuous force of common 6-DoF styluses), range 0.01..50.
    pub max_force: f64,
    /// Largest torque sent to a hand, about the device point, N m. Default 0.2, range 1e-4..5.
    pub max_torque: f64,
    /// Largest change of the force sent to a hand per millisecond, N. Default 0.5, range 1e-3..50. A wall at 2 m/s
    /// takes 1 N per millisecond.
    pub max_force_step: f64,
    /// Largest change of the torque sent to a hand per millisecond, N m. Default 0.03, range 1e-5..5.
    pub max_torque_step: f64,
    /// Largest change of the **raw** force per millisecond beyond the change by the hand's own motion (`k_t |dq_h|`),
    /// N. Applies to a tool that already bears load. Default 0.02, range 1e-3..50. At the default a tool that comes
    /// loose settles at 20 N/s, which is not felt as a click. A value of 50 has practically no effect.
    pub max_settle_step: f64,
    /// Duration of the wrench's linear ramp from zero to full after entry, pause or a stale pose, milliseconds. Default
    /// 500; 0 counts as 1. Scenes up to version 7 have their own value, by default 100.
    pub ramp_up_ms: u16,
    /// Duration of the linear ramp from full to zero on pause, stale pose, absence or solver failure, milliseconds.
    /// Default 20; 0 counts as 1.
    pub ramp_down_ms: u16,
    /// Largest change of the **raw** force of an arriving tool per millisecond beyond the change by the hand's own
    /// motion, N. Default 0.02, range 1e-3..50, or 0.
    ///
    /// A tool arrives from its entry until it has reached its hand or its place of rest. A touch during the arrival has
    /// this limit, too, and the tool catches up no faster. With 0 a tool does not arrive, as in scenes up to version 7:
    /// the first touch has no limit, and [`crate::output::status::NOT_MET`] is never set.
    pub max_arrival_step: f64,
    /// Largest counted work of a tick, operations; see [`crate::work`]. Default 1,000,000, a millisecond of the
    /// reference machine; range 50,000.., or 0 for no bound, as in scenes up to version 7. Of the hard cases only
    /// random leaps reach the default. At 500,000 a probe that flickers in a pocket is exhausted in 38 % of its ticks.
    ///
    /// A pass that would exceed the rest is not begun, and the next ticks finish the motion. The first pass of every
    /// tick always takes place.
    pub max_work: u32,
}

impl Default for Params {
    fn default() -> Self {
        Self {
            rate_hz: 1000,
            predict_min: 3e-6,
            predict_max: 5e-4,
            predict_gain: 1.2,
            predict_bias: 3e-6,
            trust: 0.95,
            max_substeps: 8,
            converged_step: 5e-5,
            converged_gap: 5e-7,
            contact_compliance: 1e-8,
            solver: SolverKind::ActiveSet,
            max_iterations: 400,
            max_contacts: 1024,
            blend: true,
            max_hand_speed: 10.0,
            max_hand_spin: 100.0,
            max_force: 3.3,
            max_torque: 0.2,
            max_force_step: 0.5,
            max_torque_step: 0.03,
            max_settle_step: 0.02,
            ramp_up_ms: 500,
            ramp_down_ms: 20,
            max_arrival_step: 0.02,
            max_work: 1_000_000,
        }
    }
}

/// Smallest bound of [`Params::max_work`], operations. With less the first pass would take most of every tick.
const LEAST_WORK: u32 = 50_000;

/// Error of a parameter outside its range.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("parameter `{field}` is {found}, expected {expected}")]
pub struct ParamError {
    /// Name of the field.
    pub field: &'static str,
    /// Value found.
    pub found: f64,
    /// Range expected.
    pub expected: &'static str,
}

impl Params {
    /// Duration that a tick simulates, seconds.
    #[inline]
    pub fn tick_s(&self) -> f64 {
        1.0 / f64::from(self.rate_hz)
    }

    /// Interval between two ticks on a clock, nanoseconds.
    #[inline]
    pub fn tick_ns(&self) -> u64 {
        1_000_000_000 / u64::from(self.rate_hz.max(1))
    }

    /// Duration that a tick simulates, milliseconds; exactly 1 at 1 kHz. Converts a parameter per millisecond to one
    /// per tick.
    #[inline]
    pub fn tick_ms(&self) -> f64 {
        1e3 / f64::from(self.rate_hz)
    }

    /// Returns the number of ticks in `seconds`, rounded to the nearest; 0 for a negative duration.
    #[inline]
    pub fn ticks_in(&self, seconds: f64) -> u64 {
        (seconds * f64::from(self.rate_hz) + 0.5) as u64
    }

    /// Checks every field against its range.
    ///
    /// # Errors
    /// A field is out of range: the error has its name, the value found and the range expected.
    pub fn validate(&self) -> Result<(), ParamError> {
        let checks: [(&'static str, f64, bool, &'static str); 21] = [
            (
                "rate_hz",
                f64::from(self.rate_hz),
                within(f64::from(self.rate_hz), 250.0, 8000.0),
                "250 to 8000 ticks a second",
            ),
            (
                "predict_min",
                self.predict_min,
                within(self.predict_min, 1e-6, 1e-3),
                "1e-6 to 1e-3 m",
            ),
            (
                "predict_max",
                self.predict_max,
                within(self.predict_max, self.predict_min, 1e-2),
                "predict_min to 1e-2 m",
            ),
            (
                "predict_gain",
                self.predict_gain,
                within(self.predict_gain, 0.0, 10.0),
                "0 to 10",
            ),
            (
                "predict_bias",
                self.predict_bias,
                within(self.predict_bias, 0.0, 1e-3),
                "0 to 1e-3 m",
            ),
            (
                "trust",
                self.trust,
                within(self.trust, 0.1, 0.99),
                "0.1 to 0.99",
            ),
            (
                "max_substeps",
                f64::from(self.max_substeps),
                within(f64::from(self.max_substeps), 1.0, 64.0),
                "1 to 64",
            ),
            (
                "converged_step",
                self.converged_step,
                within(self.converged_step, 1e-9, 1e-3),
                "1e-9 to 1e-3 m",
            ),
            (
                "converged_gap",
                self.converged_gap,
                within(self.converged_gap, 1e-10, 1e-5),
                "1e-10 to 1e-5 m",
            ),
            (
                "contact_compliance",
                self.contact_compliance,
                within(self.contact_compliance, 1e-12, 1e-3),
                "1e-12 to 1e-3 m/N",
            ),
            (
                "max_iterations",
                f64::from(self.max_iterations),
                within(f64::from(self.max_iterations), 10.0, 10_000.0),
                "10 to 10000",
            ),
            (
                "max_contacts",
                f64::from(self.max_contacts),
                within(f64::from(self.max_contacts), 16.0, 4096.0),
                "16 to 4096",
            ),
            (
                "max_hand_speed",
                self.max_hand_speed,
                within(self.max_hand_speed, 0.1, 100.0),
                "0.1 to 100 m/s",
            ),
            (
                "max_hand_spin",
                self.max_hand_spin,
                within(self.max_hand_spin, 1.0, 1000.0),
                "1 to 1000 rad/s",
            ),
            (
                "max_force",
                self.max_force,
                within(self.max_force, 0.01, 50.0),
                "0.01 to 50 N",
            ),
            (
                "max_torque",
                self.max_torque,
                within(self.max_torque, 1e-4, 5.0),
                "1e-4 to 5 N m",
            ),
            (
                "max_force_step",
                self.max_force_step,
                within(self.max_force_step, 1e-3, 50.0),
                "1e-3 to 50 N",
            ),
            (
                "max_torque_step",
                self.max_torque_step,
                within(self.max_torque_step, 1e-5, 5.0),
                "1e-5 to 5 N m",
            ),
            (
                "max_settle_step",
                self.max_settle_step,
                within(self.max_settle_step, 1e-3, 50.0),
                "1e-3 to 50 N",
            ),
            (
                "max_arrival_step",
                self.max_arrival_step,
                self.max_arrival_step == 0.0 || within(self.max_arrival_step, 1e-3, 50.0),
                "0, or 1e-3 to 50 N",
            ),
            (
                "max_work",
                f64::from(self.max_work),
                self.max_work == 0 || self.max_work >= LEAST_WORK,
                "0, or at least 50000 operations",
            ),
        ];
        match checks.into_iter().find(|check| !check.2) {
            Some((field, found, _, expected)) => Err(ParamError {
                field,
                found,
                expected,
            }),
            None => Ok(()),
        }
    }
}

/// Whether a number lies in a closed range; false for NaN.
pub(crate) fn within(x: f64, low: f64, high: f64) -> bool {
    x >= low && x <= high
}
