//! Tests of the whole device against a stand-in of the simulation.

mod bench;

use std::sync::Arc;

use proptest::prelude::*;
use sulcus_proto::datagram::WirePose;

use super::{Coupling, Felt, Guide, Hands, HandsOnScreen, Held, Motion, Steady};
use crate::camera::Vector;
use bench::{Bench, LIMIT_N, STIFFNESS};

#[test]
fn a_free_tool_goes_all_the_way_in_small_steps() {
    for (delay, speed) in [(2, 50.0), (20, 50.0), (2, 140.0)] {
        let mut bench = Bench::new(1e3, delay);
        bench.push(0.4, speed);
        let tip = bench.push(0.5, 0.0);
        assert!(
            (tip.y - 0.4 * speed).abs() < 1e-3,
            "{delay} ms, {speed} mm/s: {tip}"
        );
        assert_eq!(bench.most_force, 0.0);
        assert!(
            bench.most_step < 1.06e-3 * speed,
            "{delay} ms, {speed} mm/s: {}",
            bench.most_step
        );
    }
}

#[test]
fn a_push_that_rests_holds_the_largest_force_of_the_exercise() {
    for delay in [0, 2, 10] {
        let mut bench = Bench::new(5.0, delay);
        // 20 mm in all: 15 mm into the tissue for a hand without a guide, 7.5 N.
        bench.push(1.0, 20.0);
        let held = bench.force;
        assert!((held - LIMIT_N).abs() < 1e-3, "{delay} ms: {held} N");
        bench.push(2.0, 0.0);
        assert!(
            (bench.force - LIMIT_N).abs() < 1e-3,
            "{delay} ms: {} N at rest",
            bench.force
        );
    }
}

#[test]
fn the_way_back_from_a_wall_begins_with_the_first_count() {
    let mut bench = Bench::new(5.0, 2);
    bench.push(1.0, 20.0);
    bench.push(0.3, 0.0);
    // 0.1 mm back is a tenth of a newton less at 500 N/m: 0.05 N.
    bench.push(0.008, -12.5);
    bench.push(0.3, 0.0);
    assert!(
        (bench.force - (LIMIT_N - 0.05)).abs() < 1e-3,
        "{} N",
        bench.force
    );
    // 0.5 mm is the whole lead.
    bench.push(0.1, -5.0);
    bench.push(0.3, 0.0);
    assert_eq!(bench.force, 0.0);
}

#[test]
fn a_pressed_tool_slides_along_the_wall_as_far_as_the_mouse_goes() {
    for (delay, speed) in [(2, 40.0), (10, 20.0)] {
        let mut bench = Bench::new(5.0, delay);
        bench.push(1.0, 20.0);
        bench.glide(0.5, [5.0, speed]);
        let tip = bench.push(0.3, 0.0);
        let off = tip - Vector::new(0.0, 5.5, 0.5 * speed);
        assert!(
            off.norm() < 0.02 * 0.5 * speed,
            "{delay} ms, {speed} mm/s: {tip}"
        );
    }
}

#[test]
fn without_the_guide_the_same_push_is_thirty_times_as_strong() {
    let mut bench = Bench::new(5.0, 2);
    let wide = Guide::new(
        1e3,
        1e3,
        &Coupling {
            stiffness_n_per_m: STIFFNESS,
            stiffness_nm_per_rad: 0.5,
        },
    );
    bench.device = HandsOnScreen::new(Arc::clone(&bench.shared), [wide; 2], 1e-3);
    bench.push(1.0, 20.0);
    bench.push(0.3, 0.0);
    assert!((bench.force - 7.5).abs() < 1e-3, "{} N", bench.force);
}

#[test]
fn a_first_push_is_bounded_by_the_speed_over_the_delay_and_by_the_free_lead() {
    for (delay, speed, most_n) in [
        (2, 20.0, 0.2501),
        (20, 20.0, 0.2501),
        (2, 140.0, 0.2501),
        (20, 140.0, 1.5),
    ] {
        let mut bench = Bench::new(5.0, delay);
        bench.push(0.5, speed);
        assert!(
            bench.most_force <= most_n + 1e-6,
            "{delay} ms, {speed} mm/s: {} N",
            bench.most_force
        );
        assert!(bench.most_force > LIMIT_N - 1e-3);
    }
}

#[test]
fn a_window_that_holds_the_hands_delays_a_motion_and_loses_none() {
    let mut bench = Bench::new(1e3, 0);
    bench
        .shared
        .feed(|hands| hands.apply(&Motion::shift(200.0, 0.0, 0.0)));
    let shared = Arc::clone(&bench.shared);
    let mut during = Vector::zeros();
    shared.feed(|_| {
        for _ in 0..40 {
            during = bench.period();
        }
    });
    // In the precision of the wire.
    assert!(during.norm() < 1e-5, "{during}");
    let after = bench.push(0.5, 0.0);
    assert!((after.y - 5.0).abs() < 1e-3, "{after}");
    assert!(bench.most_step <= 0.15 + 1e-4, "{}", bench.most_step);
}

#[test]
fn the_first_pose_is_that_of_the_home_and_an_empty_slot_has_none() {
    let mut bench = Bench::new(1e3, 0);
    let home = bench.shared.feed(|hands| hands.pose(0)).expect("a tool");
    let nothing = [Felt::NOTHING; 2];
    let absent = Held {
        pose: WirePose::IDENTITY,
        present: false,
    };
    let present = Held {
        pose: home.wire(),
        present: true,
    };
    assert_eq!(bench.device.period(&nothing), [present, absent]);
    bench.shared.feed(Hands::take_or_lay);
    assert!(!bench.device.period(&nothing)[0].present);
    assert!(bench.device.entries().is_empty());
}

proptest! {
    #[test]
    fn any_input_stays_within_the_step_and_the_force(
        inputs in proptest::collection::vec((-400.0f64..400.0, -400.0f64..400.0, 0u8..12, 1usize..60), 1..40),
        delay in 0usize..25, wall in 0.0f64..8.0,
    ) {
        let mut bench = Bench::new(wall, delay);
        for (right, up, other, periods) in inputs {
            bench.shared.feed(|hands| {
                hands.apply(&Motion::shift(right, up, 0.0));
                hands.apply(&Motion::turn(up, 0.0, right));
                match other {
                    0 => hands.set_open(!hands.is_open()),
                    1 => hands.go_home(),
                    2 => hands.deflect(Steady::Keys, &Motion::shift(1.0, 0.0, 0.0)),
                    3 => hands.let_go(),
                    _ => {}
                }
            });
            for _ in 0..periods {
                bench.period();
            }
        }
        prop_assert!(bench.most_step <= 0.15 + 1e-4, "{}", bench.most_step);
        // The free lead of 3 mm.
        prop_assert!(bench.most_force <= 1.5 + 1e-3, "{}", bench.most_force);
    }
}
