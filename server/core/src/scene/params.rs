//! Parameters of the tick, in one place. They travel in the scene and so in every recording.

use serde::{Deserialize, Serialize};

use crate::optimise::SolverKind;

/// Parameters of contact prediction, optimisation and wrench. SI units.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Params {
    /// Ticks a second. Default 1000, range 250..8000. Faster: textures and harder walls can be displayed (a device shows a stiffness
    /// of about `2 b / T` at most), and less time for a tick. What is said per millisecond keeps its meaning at any rate.
    pub rate_hz: u16,
    /// Smallest contact-prediction distance, metres. Default 3e-6, range 1e-6..1e-3. Larger: fewer
    /// substeps, more rows. Source: notes of the prototype, section 2 (the paper's fixed 0.5 mm
    /// is larger than the sphere spacing at level 3).
    pub predict_min: f64,
    /// Largest contact-prediction distance, metres. Default 5e-4 (the paper's d, section 3.2).
    pub predict_max: f64,
    /// Prediction distance per metre that the hand moved in this tick. Default 1.2.
    pub predict_gain: f64,
    /// Prediction distance added to the motion, metres. Default 3e-6: a tenth of the prototype's costs a few more
    /// passes and saves most of the rows at fine levels.
    pub predict_bias: f64,
    /// Share of the prediction distance that the graphic tool may move between two collision
    /// passes. Default 0.95, range 0.1..0.99: at 1 or more the guarantee is lost.
    pub trust: f64,
    /// Most collide-and-solve passes in a tick. Default 8, range 1..64. More: faster hands stay exact,
    /// longer worst tick.
    pub max_substeps: u8,
    /// A pass whose step stays under this ends the tick, metres. Default 5e-5.
    pub converged_step: f64,
    /// Deepest true gap of a converged tick, metres. Default 5e-7.
    pub converged_gap: f64,
    /// Compliance on every row's diagonal, m/N. Default 1e-8 (1e-5 mm/N): keeps any row set
    /// feasible. The prototype's 1e-7 spends the whole allowed gap (0.5 um) on 5 N at one sphere,
    /// after which no tick converges; at 1e-8 the solver's residual is still under 1e-9.
    pub contact_compliance: f64,
    /// Which solver answers in the tick.
    pub solver: SolverKind,
    /// Iteration cap of the solver. Default 400, range 10..10000.
    pub max_iterations: u16,
    /// Contacts that each tool's list can hold (four times as many where surfaces are blended, whose rows have
    /// many each). Default 1024, range 16..4096; where something yields a problem holds at most 256 rows (its
    /// matrix is dense). Where more sphere pairs are close the tick looks less far ahead.
    pub max_contacts: u16,
    /// Whether trees that were calibrated for it are touched as one smooth surface, blended from their
    /// spheres ([`crate::blend`]); otherwise every sphere is touched as it is. Default true. Without, a tick
    /// on a tooth takes a third to a tenth of the time, and the spheres are felt as ripple: measured on the
    /// ellipsoid, 2.0 % instead of 0.6 % of the force at level 3. Source: the bench `ripple`.
    pub blend: bool,
    /// Fastest believable hand, m/s; faster input is clamped and counted. Default 10.
    pub max_hand_speed: f64,
    /// Fastest believable turn, rad/s. Default 100.
    pub max_hand_spin: f64,
    /// Largest force sent to a hand, N. Default 3.3 (continuous force of common 6-DoF styluses).
    pub max_force: f64,
    /// Largest torque sent to a hand, N m. Default 0.2.
    pub max_torque: f64,
    /// Largest change of force per millisecond, N. Default 0.5; 1 N per millisecond is a wall at 2 m/s.
    pub max_force_step: f64,
    /// Largest change of torque per millisecond, N m. Default 0.03.
    pub max_torque_step: f64,
    /// Largest change of the **raw** force in a millisecond beyond what the hand's own motion brings (`k_t |dq_h|`), N, once a tool
    /// bears load. Default 0.02: a tool that comes loose then settles at 20 N/s and is not felt as a click. 50 is as good as none.
    pub max_settle_step: f64,
    /// Milliseconds in which the wrench ramps from zero to full after (re)entry. Default 100.
    pub ramp_up_ms: u16,
    /// Milliseconds in which it ramps to zero on pause, stale pose or absence. Default 20.
    pub ramp_down_ms: u16,
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
            ramp_up_ms: 100,
            ramp_down_ms: 20,
        }
    }
}

/// A parameter outside its range.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("parameter `{field}` is {found}, expected {expected}")]
pub struct ParamError {
    /// Name of the field.
    pub field: &'static str,
    /// Value found.
    pub found: f64,
    /// What it must be.
    pub expected: &'static str,
}

impl Params {
    /// Seconds that a tick simulates.
    #[inline]
    pub fn tick_s(&self) -> f64 {
        1.0 / f64::from(self.rate_hz)
    }

    /// Nanoseconds between two ticks on a clock.
    #[inline]
    pub fn tick_ns(&self) -> u64 {
        1_000_000_000 / u64::from(self.rate_hz.max(1))
    }

    /// Milliseconds that a tick simulates: what is said per millisecond, times this, is per tick. Exactly 1 at 1 kHz.
    #[inline]
    pub fn tick_ms(&self) -> f64 {
        1e3 / f64::from(self.rate_hz)
    }

    /// Ticks in `seconds`, to the nearest.
    #[inline]
    pub fn ticks_in(&self, seconds: f64) -> u64 {
        (seconds * f64::from(self.rate_hz) + 0.5) as u64
    }

    /// Checks every field against its range.
    ///
    /// # Errors
    /// Names the first field out of range, with the value found and the range expected.
    pub fn validate(&self) -> Result<(), ParamError> {
        let checks: [(&'static str, f64, bool, &'static str); 19] = [
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
