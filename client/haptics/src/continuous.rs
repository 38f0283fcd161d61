//! Limit of the force over time: the continuous force of a device, by the heat of its motors.
//!
//! The heat of a motor follows the square of its current, which follows the force. The model is the mean square of the
//! displayed force with one time constant. Drivers stop a device whose model of the motors is too warm; the limit of
//! this module lowers the force before that.

use sulcus_core::math::{fmax, fmin};

/// Continuous limit of a device.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContinuousLimit {
    /// Largest force at which the device may stay, newtons or newton-metres, above 0.
    pub lasting: f64,
    /// Largest force for a short time, in the same unit, at least `lasting`.
    pub peak: f64,
    /// Time constant of the motors, seconds.
    pub time_s: f64,
}

/// Time constant of the motors without a better value, seconds. The value is a proposal of `notes/devices.md`.
pub const MOTOR_TIME_S: f64 = 10.0;

/// Share of the heat from which the limit falls from the peak. The limit is linear in the square of the force and ends
/// at the continuous force.
const WARM: f64 = 0.7;

/// Time for which a force may stay before the next limit follows, seconds. No force takes the heat above the limit
/// within this time. Cooling counts for this time at most, because a clock that steps forward cools no motor.
const LONGEST_STEP_S: f64 = 0.02;

/// Mean square of the displayed force, and the limit that follows.
#[derive(Clone, Debug, PartialEq)]
pub struct Heat {
    limit: ContinuousLimit,
    /// Mean square of the force with the time constant, as a share of the square of the continuous force.
    share: f64,
}

impl Heat {
    /// Creates cold motors.
    pub fn new(limit: ContinuousLimit) -> Self {
        Self { limit, share: 0.0 }
    }

    /// Returns the largest force for the next period.
    pub fn cap(&self) -> f64 {
        let ContinuousLimit {
            lasting,
            peak,
            time_s,
        } = self.limit;
        let room = fmax(0.0, 1.0 - self.share);
        let left = fmin(1.0, room / (1.0 - WARM));
        let square = lasting * lasting + (peak * peak - lasting * lasting) * left;
        let reached = lasting * lasting * (1.0 + room * fmax(0.0, time_s / LONGEST_STEP_S - 1.0));
        fmin(peak, fmin(square, reached).sqrt())
    }

    /// Accounts for `force`, which was displayed for the last `seconds`.
    pub fn displayed(&mut self, force: f64, seconds: f64) {
        let square = force / self.limit.lasting;
        let change = square * square - self.share;
        let seconds = if change < 0.0 {
            fmin(seconds, LONGEST_STEP_S)
        } else {
            seconds
        };
        self.share += change * fmin(1.0, seconds / self.limit.time_s);
    }

    /// Mean square of the force as a share of the square of the continuous force; 1 is the limit.
    pub fn share(&self) -> f64 {
        self.share
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TOUCH: ContinuousLimit = ContinuousLimit {
        lasting: 0.88,
        peak: 3.3,
        time_s: MOTOR_TIME_S,
    };

    #[test]
    fn a_force_at_the_peak_falls_to_the_continuous_force_and_never_overheats() {
        for period in [1.0 / 500.0, 1e-3, 1.0 / 4000.0, 0.02] {
            let (mut heat, mut before) = (Heat::new(TOUCH), 3.3);
            for _ in 0..(120.0 / period) as u64 {
                let force = heat.cap();
                assert!(force <= before + 1e-12, "{force} after {before}");
                before = force;
                heat.displayed(force, period);
                assert!(heat.share() <= 1.0 + 1e-12, "{}", heat.share());
            }
            assert!((before - 0.88).abs() < 0.01, "{before}");
        }
    }

    #[test]
    fn the_force_of_probing_is_never_reduced() {
        let mut heat = Heat::new(TOUCH);
        for _ in 0..600_000 {
            heat.displayed(0.5, 1e-3);
        }
        assert_eq!(heat.cap(), 3.3);
    }

    #[test]
    fn motors_cool_at_rest() {
        let mut heat = Heat::new(TOUCH);
        for _ in 0..60_000 {
            let cap = heat.cap();
            heat.displayed(cap, 1e-3);
        }
        let warm = heat.cap();
        for _ in 0..20_000 {
            heat.displayed(0.0, 1e-3);
        }
        assert!(warm < 1.0 && heat.cap() == 3.3, "{warm} {}", heat.cap());
    }
}
