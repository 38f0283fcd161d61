//! Limited wrench for the hand: ramp, clamp and slew of the raw wrench. All three run inside the tick, so that recorded
//! wrenches replay.

use crate::math::{Vec3, Wrench, fmin, norm};
use crate::output::status;
use crate::scene::params::Params;

/// Conditions on the wrench besides the contacts.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Conditions {
    /// Whether full strength is wanted: tool present, pose fresh, no pause, problem solved.
    pub wanted: bool,
    /// Force limit in this tick, newtons.
    pub force_limit: f64,
}

/// Applies ramp, clamp and slew to the wrench `raw`. `sent` is the wrench sent in the last tick, `gain` the ramp factor
/// after the last tick. Returns the wrench to send, the new ramp factor (0 to 1) and status bits. A value that is not
/// finite gives a zero wrench, a ramp factor of 0 and [`status::FAULT`].
pub(crate) fn limited(
    raw: &Wrench,
    sent: &Wrench,
    gain: f64,
    now: &Conditions,
    params: &Params,
) -> (Wrench, f64, u16) {
    let mut bits = 0;
    let ms = params.tick_ms();
    let gain = if now.wanted {
        fmin(1.0, gain + ms / f64::from(params.ramp_up_ms.max(1)))
    } else {
        crate::math::fmax(0.0, gain - ms / f64::from(params.ramp_down_ms.max(1)))
    };
    if gain < 1.0 {
        bits |= status::RAMPING;
    }
    let mut clamp = |v: Vec3, limit: f64, bit: u16| {
        let length = norm(&v);
        if length > limit {
            bits |= bit;
            v * (limit / length)
        } else {
            v
        }
    };
    let force = clamp(raw.force * gain, now.force_limit, status::SATURATED);
    let torque = clamp(raw.torque * gain, params.max_torque, status::SATURATED);
    let force = sent.force
        + clamp(
            force - sent.force,
            params.max_force_step * ms,
            status::SLEW_LIMITED,
        );
    let torque = sent.torque
        + clamp(
            torque - sent.torque,
            params.max_torque_step * ms,
            status::SLEW_LIMITED,
        );
    // After a lowered limit the slew leads down to it. The scene's own limits hold at once.
    let force = clamp(force, params.max_force, status::SATURATED);
    let torque = clamp(torque, params.max_torque, status::SATURATED);
    let wrench = Wrench { force, torque };
    if !force.iter().chain(torque.iter()).all(|x| x.is_finite()) {
        return (Wrench::ZERO, 0.0, bits | status::FAULT);
    }
    (wrench, gain, bits)
}

#[cfg(test)]
mod tests {
    use super::*;

    const FREE: Conditions = Conditions {
        wanted: true,
        force_limit: 3.3,
    };

    fn force(x: f64) -> Wrench {
        Wrench {
            force: Vec3::new(x, 0.0, 0.0),
            torque: Vec3::zeros(),
        }
    }

    #[test]
    fn a_pause_takes_the_force_to_zero_without_a_step() {
        let params = Params::default();
        let paused = Conditions {
            wanted: false,
            ..FREE
        };
        let (mut sent, mut gain) = (force(3.0), 1.0);
        for tick in 1..=20 {
            let (next, g, _) = limited(&force(3.0), &sent, gain, &paused, &params);
            assert!((next.force.x - sent.force.x).abs() < 0.16, "tick {tick}");
            (sent, gain) = (next, g);
        }
        assert!(sent.force.x.abs() < 1e-12);
    }

    #[test]
    fn force_is_clamped_and_its_rise_limited_and_both_are_said() {
        let params = Params::default();
        let (first, _, bits) = limited(&force(50.0), &Wrench::ZERO, 1.0, &FREE, &params);
        assert_eq!(bits, status::SATURATED | status::SLEW_LIMITED);
        assert!((first.force.x - params.max_force_step).abs() < 1e-12);
        let (last, _, bits) = limited(&force(50.0), &force(3.2), 1.0, &FREE, &params);
        assert_eq!(bits, status::SATURATED);
        assert!((last.force.x - 3.3).abs() < 1e-12);
    }

    #[test]
    fn a_nan_never_reaches_the_hand() {
        let (sent, gain, bits) = limited(
            &force(f64::NAN),
            &force(1.0),
            1.0,
            &FREE,
            &Params::default(),
        );
        assert_eq!(
            (sent, gain, bits & status::FAULT),
            (Wrench::ZERO, 0.0, status::FAULT)
        );
    }
}
