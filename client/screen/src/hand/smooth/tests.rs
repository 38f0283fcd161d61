//! Tests of the smoother.

use super::*;
use crate::hand::pose::Turn;
use proptest::prelude::*;

fn at(x: f64) -> HandPose {
    HandPose {
        position: Vector::new(x, 0.0, 0.0),
        orientation: Turn::identity(),
    }
}

fn smoother() -> Smoother {
    Smoother::new(SmootherRule::mouse(150.0, 4.0), Vector::zeros(), at(0.0))
}

/// Largest step of the output, and largest change between two steps, mm, for a mouse of `mouse_hz` that moves at
/// `speed` mm/s, in a loop of `loop_hz`. The first quarter of a second is left out.
fn steps(mouse_hz: f64, loop_hz: f64, speed: f64) -> (f64, f64) {
    let (mut smoother, period) = (smoother(), 1.0 / loop_hz);
    let (mut last, mut last_step, mut most) = (0.0, None, (0.0f64, 0.0f64));
    for k in 0..loop_hz as usize {
        let time = k as f64 * period;
        let target = (time * mouse_hz).floor() / mouse_hz * speed;
        let x = smoother.next(&at(target), period).position.x;
        let step = x - last;
        if time > 0.25 {
            most.0 = most.0.max(step);
            most.1 = most.1.max((step - last_step.unwrap_or(step)).abs());
        }
        (last, last_step) = (x, Some(step));
    }
    most
}

#[test]
fn steps_of_a_mouse_become_a_smooth_motion() {
    // Without a smoother the largest step is 0.4 mm at 125 Hz and 0.833 mm at 60 Hz.
    for (mouse_hz, step_mm, change_mm) in [
        (60.0, 0.056, 0.0032),
        (125.0, 0.052, 0.0012),
        (1000.0, 0.0501, 0.0001),
    ] {
        let (step, change) = steps(mouse_hz, 1000.0, 50.0);
        assert!((0.0499..step_mm).contains(&step), "{mouse_hz} Hz: {step}");
        assert!(change < change_mm, "{mouse_hz} Hz: {change}");
    }
}

#[test]
fn the_delay_is_two_over_the_frequency_at_any_rate() {
    for loop_hz in [250.0, 1000.0, 8000.0] {
        let (mut smoother, period) = (smoother(), 1.0 / loop_hz);
        for k in 0..=(loop_hz as usize) {
            smoother.next(&at(20.0 * k as f64 * period), period);
        }
        let delay = 1.0 - smoother.pose().position.x / 20.0;
        // The target of a period is constant: half a period of uncertainty on each side.
        assert!((delay - 0.025).abs() < period, "{loop_hz} Hz: {delay}");
    }
}

#[test]
fn a_jump_is_followed_at_the_greatest_speed_and_without_overshoot() {
    let mut smoother = smoother();
    let (mut last, mut most) = (0.0, 0.0f64);
    for _ in 0..1000 {
        let x = smoother.next(&at(30.0), 1e-3).position.x;
        assert!(x >= last - 1e-12 && x <= 30.0 + 1e-9, "{x}");
        most = most.max(x - last);
        last = x;
    }
    assert!((most - 0.15).abs() < 1e-9, "{most}");
    assert!((last - 30.0).abs() < 1e-6);
}

#[test]
fn an_allowed_set_holds_the_pose_back() {
    let mut smoother = smoother();
    let allowed = |pose: &HandPose| at(pose.position.x.min(2.0));
    for _ in 0..1000 {
        assert!(smoother.next_within(&at(10.0), 1e-3, allowed).position.x <= 2.0);
    }
    assert_eq!(smoother.pose().position.x, 2.0);
    // The pose leaves the bound at once when the target returns.
    smoother.next_within(&at(1.0), 1e-3, allowed);
    assert!(smoother.pose().position.x < 2.0 - 1e-3);
}

proptest! {
    #[test]
    fn steps_are_bounded_for_any_targets(
        targets in proptest::collection::vec(
            ([-200.0f64..200.0, -200.0..200.0, -200.0..200.0], [-3.0f64..3.0, -3.0..3.0, -3.0..3.0]), 1..60),
        loop_hz in 250.0f64..8000.0,
    ) {
        let (pivot, period) = (Vector::new(1.0, -2.0, 80.0), 1.0 / loop_hz);
        let mut smoother = Smoother::new(SmootherRule::mouse(150.0, 4.0), pivot, at(0.0));
        for (place, by) in targets {
            let target = HandPose::with_point_at(&pivot, &Vector::from(place), turn(&Vector::from(by)));
            for _ in 0..5 {
                let before = smoother.pose();
                let after = smoother.next(&target, period);
                prop_assert!((after.point(&pivot) - before.point(&pivot)).norm() <= 150.0 * period + 1e-9);
                prop_assert!(turned(&before.orientation, &after.orientation).norm() <= 4.0 * period + 1e-7);
            }
        }
    }
}
