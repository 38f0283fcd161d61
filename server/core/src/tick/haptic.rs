//! Haptic pose: validation of the input, twist from the graphic to the haptic tool, and wrench at the device.

use crate::input::RawPose;
use crate::math::{Pose, Quat, Vec3, Wrench, exp_rotation, log_rotation, norm, normalised};
use crate::output::status;
use crate::scene::params::Params;
use crate::scene::tool::Tool;
use crate::state::ToolState;

/// Largest twist that still raises the torque, radians (90 degrees).
const TWIST_LIMIT: f64 = std::f64::consts::FRAC_PI_2;
/// Twist beyond which the kept axis determines the sign of the twist's axis, radians (170 degrees). Near 180 degrees
/// the axis of the shortest rotation can flip.
const AXIS_KEPT_BEYOND: f64 = 170.0 * std::f64::consts::PI / 180.0;

/// Returns the raw pose in f64 with a unit quaternion; `-0.0` becomes `0.0`. Returns `None` if a number is not finite
/// or a coordinate is beyond 10 m. A quaternion must be between 0.9 and 1.1 long.
fn checked(raw: &RawPose) -> Option<Pose> {
    let widen = |x: f32| f64::from(x) + 0.0;
    let p = raw.position.map(widen);
    let q = raw.orientation.map(widen);
    let length = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
    // A hand is within 10 m of the mouth. A unit quaternion in f32 is within 1e-6 of unit length; 10 % is tolerated.
    let believable = p.iter().all(|x| x.abs() <= 10.0) && length > 0.81 && length < 1.21;
    believable.then(|| {
        Pose::new(
            Vec3::new(p[0], p[1], p[2]),
            normalised(q[0], q[1], q[2], q[3]),
        )
    })
}

/// Returns the haptic pose of this tick and status bits. `ticks` is the number of ticks since the last pose. Speed and
/// spin of the hand are clamped to the limits of `params` over `ticks` ticks, except for a tool absent in the last
/// tick. An invalid input gives the last pose and [`status::BAD_INPUT`].
pub(crate) fn sanitise(
    raw: &RawPose,
    params: &Params,
    last: &ToolState,
    ticks: u64,
) -> (Pose, u16) {
    let Some(mut pose) = checked(raw) else {
        return (last.haptic, status::BAD_INPUT);
    };
    if !last.entered {
        return (pose, 0);
    }
    let mut bits = 0;
    let seconds = ticks as f64 * params.tick_s();
    let step = pose.position - last.haptic.position;
    let (length, most) = (norm(&step), params.max_hand_speed * seconds);
    if length > most {
        pose.position = last.haptic.position + step * (most / length);
        bits = status::SPEED_CLAMPED;
    }
    let turn = log_rotation(&(pose.orientation * last.haptic.orientation.inverse()));
    let (angle, most) = (norm(&turn), params.max_hand_spin * seconds);
    if angle > most {
        pose.orientation =
            renormalised(&(exp_rotation(&(turn * (most / angle))) * last.haptic.orientation));
        bits = status::SPEED_CLAMPED;
    }
    (pose, bits)
}

/// Returns the quaternion scaled to unit length. Products of quaternions drift from unit length by rounding.
pub(crate) fn renormalised(q: &Quat) -> Quat {
    normalised(q.w, q.i, q.j, q.k)
}

/// Returns the rotation vector from the graphic to the haptic tool and whether it was clamped. World axes, radians, at
/// most 90 degrees long. Beyond 170 degrees the sign of the axis follows `kept_axis`, a unit vector, or zero for none.
pub(crate) fn twist(haptic: &Quat, graphic: &Quat, kept_axis: &Vec3) -> (Vec3, bool) {
    let mut w = log_rotation(&(haptic * graphic.inverse()));
    let mut angle = norm(&w);
    if angle > AXIS_KEPT_BEYOND && w.dot(kept_axis) < 0.0 {
        // The same rotation the other way round, along the axis that the hand has felt so far.
        w *= 1.0 - std::f64::consts::TAU / angle;
        angle = std::f64::consts::TAU - angle;
    }
    if angle > TWIST_LIMIT {
        (w * (TWIST_LIMIT / angle), true)
    } else {
        (w, false)
    }
}

/// Returns the axis of the twist for the next tick: unit vector, world axes. A twist of at most 1e-3 rad or beyond 170
/// degrees has no reliable axis, and the result is then `before`.
pub(crate) fn kept_axis(haptic: &Quat, graphic: &Quat, before: &Vec3) -> Vec3 {
    let w = log_rotation(&(haptic * graphic.inverse()));
    let angle = norm(&w);
    if angle > 1e-3 && angle <= AXIS_KEPT_BEYOND {
        w / angle
    } else {
        *before
    }
}

/// Returns the raw wrench for the hand: minus `load`, the sum of the loads on all objects, moved from the world's
/// origin to the device point.
///
/// The load acts on the working point of the graphic tool and reaches the hand through the coupling. The lever to the
/// device point is therefore that of the haptic tool. With this lever the wrench is the exact gradient of the
/// coupling's energy.
pub(crate) fn wrench_at_device(
    load: &Wrench,
    tool: &Tool,
    graphic: &Pose,
    haptic: &Pose,
) -> Wrench {
    let on_tool = Wrench {
        force: -load.force,
        torque: -load.torque,
    };
    let at_working_point = on_tool.moved(&-graphic.transform(&tool.working_point));
    at_working_point.moved(&(haptic.orientation * tool.working_point))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::state::Arrival;

    fn entered(pose: Pose) -> ToolState {
        let zero = Wrench::ZERO;
        ToolState {
            haptic: pose,
            graphic: pose,
            entered: true,
            arrival: Arrival::Met,
            bad_ticks: 0,
            gain: 1.0,
            sent: zero,
            raw: zero,
            twist_axis: Vec3::z(),
        }
    }

    #[test]
    fn no_bad_number_passes() {
        let last = entered(Pose::new(Vec3::new(0.01, 0.0, 0.0), Quat::identity()));
        let good = RawPose {
            position: [0.011, 0.0, -0.0],
            orientation: [1.0, 0.0, 0.0, 0.0],
        };
        let (pose, bits) = sanitise(&good, &Params::default(), &last, 1);
        assert_eq!((bits, pose.position.z.to_bits()), (0, 0.0f64.to_bits()));
        for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 1e30] {
            for slot in 0..7 {
                let mut raw = good;
                if slot < 3 {
                    raw.position[slot] = bad
                } else {
                    raw.orientation[slot - 3] = bad
                }
                assert_eq!(
                    sanitise(&raw, &Params::default(), &last, 1),
                    (last.haptic, status::BAD_INPUT)
                );
            }
        }
        let no_rotation = RawPose {
            orientation: [0.0; 4],
            ..good
        };
        assert_eq!(
            sanitise(&no_rotation, &Params::default(), &last, 1).1,
            status::BAD_INPUT
        );
        let denormal = RawPose {
            position: [1e-42, 0.0, 0.0],
            ..good
        };
        assert!(
            sanitise(&denormal, &Params::default(), &last, 1)
                .0
                .position
                .x
                .is_finite()
        );
    }

    #[test]
    fn a_hand_faster_than_believable_is_clamped() {
        let last = entered(Pose::identity());
        let raw = RawPose {
            position: [0.5, 0.0, 0.0],
            ..RawPose::IDENTITY
        };
        let (pose, bits) = sanitise(&raw, &Params::default(), &last, 1);
        assert_eq!(bits, status::SPEED_CLAMPED);
        assert!((pose.position.x - 0.01).abs() < 1e-12);
    }

    #[test]
    fn the_twist_saturates_at_90_and_keeps_its_axis_past_180_degrees() {
        let about_z = |degrees: f64| exp_rotation(&(Vec3::z() * degrees.to_radians()));
        for degrees in [10.0, 89.0, 91.0, 175.0, 185.0, 189.0] {
            let (w, cut) = twist(&about_z(degrees), &Quat::identity(), &Vec3::z());
            let expected = if degrees > 90.0 { 90.0 } else { degrees };
            assert!(
                (w.z.to_degrees() - expected).abs() < 1e-9,
                "{degrees}: {w:?}"
            );
            assert_eq!(cut, degrees > 90.0);
        }
    }

    #[test]
    fn the_wrench_is_the_gradient_of_the_couplings_energy() {
        // E(q_h) = 1/2 kt |x_h - x_g|^2 + 1/2 kr |log(R_h R_g')|^2; the wrench on the hand is -dE/dq_h.
        let (kt, kr) = (500.0, 0.5);
        let working_point = Vec3::new(0.01, -0.02, -0.08);
        let graphic = Pose::new(
            Vec3::new(0.0, 0.001, 0.0),
            exp_rotation(&Vec3::new(0.1, 0.2, -0.1)),
        );
        let haptic = Pose::new(
            Vec3::new(0.001, -0.001, 0.002),
            exp_rotation(&Vec3::new(0.2, 0.1, 0.05)),
        );
        let energy = |h: &Pose| {
            let x = h.transform(&working_point) - graphic.transform(&working_point);
            let w = log_rotation(&(h.orientation * graphic.orientation.inverse()));
            0.5 * kt * x.dot(&x) + 0.5 * kr * w.dot(&w)
        };
        // The contacts balance G (q_h - q_g) at the graphic working point.
        let at = graphic.transform(&working_point);
        let on_object = Wrench {
            force: (haptic.transform(&working_point) - at) * kt,
            torque: log_rotation(&(haptic.orientation * graphic.orientation.inverse())) * kr,
        };
        let load = on_object.moved(&at);
        let tool = crate::tick::tests::rod_tool(working_point);
        let wrench = wrench_at_device(&load, &tool, &graphic, &haptic);
        for axis in 0..3 {
            let h = 1e-6;
            let unit = Vec3::ith(axis, 1.0);
            let moved = |s: f64| {
                energy(&Pose {
                    position: haptic.position + unit * s,
                    ..haptic
                })
            };
            let turned = |s: f64| {
                energy(&Pose {
                    orientation: exp_rotation(&(unit * s)) * haptic.orientation,
                    ..haptic
                })
            };
            assert!((wrench.force[axis] + (moved(h) - moved(-h)) / (2.0 * h)).abs() < 1e-8);
            assert!((wrench.torque[axis] + (turned(h) - turned(-h)) / (2.0 * h)).abs() < 1e-8);
        }
    }
}
