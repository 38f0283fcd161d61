//! Coupling stiffness that a device can display.
//!
//! A spring that is computed once a period and displayed with a delay is stable while `K < b / (T/2 + t_d)`:
//! - `b`: damping of the device,
//! - `T`: period of the loop,
//! - `t_d`: delay of the loop.
//!
//! Source: Hulin et al., IEEE TCST 22:1, 2014 (small-gain form); without delay Colgate and Schenkel 1997.

use sulcus_core::math::fmin;

use super::DeviceModel;
use crate::continuous::{ContinuousLimit, MOTOR_TIME_S};
use crate::passivity::PassivityParams;

/// Share of the limit that a coupling uses: the figures of a device vary by 30 %.
pub const COUPLING_MARGIN: f64 = 0.7;
/// Largest displayed damping, as a share of mass over delay. A larger damping swings by itself, because the speed is an
/// old one.
const SWINGLESS: f64 = 0.3;
/// Largest damping force of one step of the encoders within a period, newtons: half of a limit cycle's bound, because
/// a step forth and back is two of them. With the whole bound a Premium 1.5 in a light hand swung by 0.057 N at 141 Hz.
const KICK_N: f64 = 0.025;
/// Excess up to which the wrench of a device is not reduced, joules: what a hand feels.
const UNFELT_J: f64 = 1e-4;
/// Time constants of the fall and of the return of a reduced wrench, seconds. A light hand with a device of 45 g turns
/// round in about 10 ms. With the controller's defaults of 2 and 30 ms the fall was deep before the hand turned.
/// Fall and return then made a swing of 0.2 N at 20 to 80 Hz.
const LET_GO_S: f64 = 0.01;
const TAKE_UP_S: f64 = 0.3;
/// Delay of the link before it is measured, seconds: the median between two programs of one machine.
pub const LOOP_DELAY_S: f64 = 2e-4;

/// Coupling between a hand and its tool.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coupling {
    /// Stiffness in translation, N/m.
    pub n_per_m: f64,
    /// Stiffness in rotation, N m/rad; infinite for a device without torque, whose loop has no torque.
    pub nm_per_rad: f64,
}

impl DeviceModel {
    /// Returns the stiffest coupling that the device can display.
    ///
    /// `period_s` is the period of the link, `delay_s` the delay of the link, both in seconds. The latency of the
    /// device is added. `scale` is the length in the world per length at the device.
    pub fn coupling(&self, period_s: f64, delay_s: f64, scale: f64) -> Coupling {
        let delay = delay_s + self.latency_ms.value * 1e-3;
        let stable = |damping: f64| COUPLING_MARGIN * damping / (0.5 * period_s + delay);
        let along = fmin(
            stable(self.damping_n_s_per_m.value),
            self.stiffness_n_per_mm.value * 1e3,
        );
        let turning = match (
            &self.turning_damping_nm_s_per_rad,
            &self.turning_stiffness_nm_per_rad,
        ) {
            (Some(damping), Some(stiffness)) if self.has_torque() => {
                fmin(stable(damping.value), stiffness.value)
            }
            _ => f64::INFINITY,
        };
        Coupling {
            n_per_m: along / scale,
            nm_per_rad: turning,
        }
    }

    /// Returns the passivity controller for the device. `period_s` is the period of the device, `link_s` the period of
    /// the link, both in seconds.
    ///
    /// A displayed damping `B` is stable while `B < b - K (T/2 + t_d)` (Colgate and Brown) and while it is small
    /// against the mass over the delay. The default of the controller is ten times as large as a Touch displays: in the
    /// closed loop with steps of its encoders that damping alone swung by 0.57 N at 150 Hz.
    pub fn passivity(&self, period_s: f64, link_s: f64) -> PassivityParams {
        let plain = PassivityParams {
            period_s,
            ..PassivityParams::default()
        };
        let latency = self.latency_ms.value * 1e-3;
        let delay = 0.5 * link_s + LOOP_DELAY_S + latency;
        let coupling = self.coupling(link_s, LOOP_DELAY_S, 1.0);
        let left = |damping: f64, stiffness: f64| COUPLING_MARGIN * (damping - stiffness * delay);
        let along = left(self.damping_n_s_per_m.value, coupling.n_per_m);
        let turning = match &self.turning_damping_nm_s_per_rad {
            Some(damping) if self.has_torque() => {
                left(damping.value, coupling.nm_per_rad) / (plain.lever * plain.lever)
            }
            _ => f64::INFINITY,
        };
        let swingless = SWINGLESS * self.mass_g.value * 1e-3 / (period_s + latency);
        let stepless = KICK_N * period_s / (self.resolution_mm.value * 1e-3);
        let most = fmin(fmin(along, turning), fmin(swingless, stepless));
        PassivityParams {
            max_damping: fmin(plain.max_damping, most),
            resolution: self.resolution_mm.value * 1e-3,
            let_go: LET_GO_S,
            take_up: TAKE_UP_S,
            unfelt: UNFELT_J,
            ..plain
        }
    }

    /// Limit of the force over time.
    pub fn force_limit(&self) -> ContinuousLimit {
        ContinuousLimit {
            lasting: self.continuous_force_n.value,
            peak: self.peak_force_n.value,
            time_s: MOTOR_TIME_S,
        }
    }

    /// Limit of the torque over time. A device without torque has the limit 1 N m, which no torque reaches.
    pub fn torque_limit(&self) -> ContinuousLimit {
        let value =
            |figure: &Option<super::Figure>| figure.as_ref().map_or(1.0, |f| f.value * 1e-3);
        ContinuousLimit {
            lasting: fmin(
                value(&self.continuous_torque_mnm),
                value(&self.peak_torque_mnm),
            ),
            peak: value(&self.peak_torque_mnm),
            time_s: MOTOR_TIME_S,
        }
    }
}
