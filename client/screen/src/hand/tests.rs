//! Tests of the whole device against a stand-in of the simulation: a wall, a coupling, and a link with a delay.

use std::collections::VecDeque;
use std::sync::Arc;

use proptest::prelude::*;
use sulcus_proto::datagram::WirePose;

use super::device::{Felt, HandsOnScreen, Held};
use super::guide::{Coupling, Guide};
use super::hands::{Hands, Scales, Steady};
use super::limits::Limits;
use super::motion::Motion;
use super::one::Hand;
use super::pose::{HandPose, Turn};
use super::shared::Shared;
use crate::camera::Vector;

/// Stiffness of the coupling, N/m.
const STIFFNESS: f64 = 500.0;
/// Largest force of the exercise, newtons.
const LIMIT_N: f64 = 0.25;
/// Tip in the tool's frame, mm.
const TIP: [f64; 3] = [0.0, -8.0, 90.0];

/// Device before a wall. The tip starts at the origin; the tissue fills all places beyond `wall` along y.
struct Bench {
    shared: Arc<Shared>,
    device: HandsOnScreen,
    wall: f64,
    /// Answers of the simulation on their way.
    link: VecDeque<Felt>,
    /// Answer that the device has.
    felt: Felt,
    last: Option<Vector>,
    /// Largest step of the tip in a period, mm.
    most_step: f64,
    /// Largest force of the coupling, newtons.
    most_force: f64,
    /// Force of the coupling, newtons.
    force: f64,
}

impl Bench {
    /// Bench with the wall at `wall` mm, a delay of `delay` periods of 1 ms.
    fn new(wall: f64, delay: usize) -> Self {
        let tip = Vector::from(TIP);
        let home = HandPose::with_point_at(&tip, &Vector::zeros(), Turn::identity());
        let hand = Hand::new(home, tip, Limits::around([Vector::zeros()], 60.0));
        let mut hands = Hands::new([Some(hand), None], Scales::default());
        hands.set_open(false);
        let coupling = Coupling {
            stiffness_n_per_m: STIFFNESS,
            stiffness_nm_per_rad: 0.5,
        };
        let guide = Guide::new(LIMIT_N, 0.005, &coupling);
        let shared = Arc::new(Shared::new(hands));
        Self {
            device: HandsOnScreen::new(Arc::clone(&shared), [guide; 2], 1e-3),
            shared,
            wall,
            link: vec![Felt::NOTHING; delay].into(),
            felt: Felt::NOTHING,
            last: None,
            most_step: 0.0,
            most_force: 0.0,
            force: 0.0,
        }
    }

    /// Period of device, link and simulation. Returns the place of the tip, mm.
    fn period(&mut self) -> Vector {
        let [held, other] = self.device.period(&[self.felt, Felt::NOTHING]);
        assert!(held.present && !other.present);
        let pose = HandPose::of(&held.pose).expect("a pose");
        let tip = pose.point(&Vector::from(TIP));
        let step = self.last.map_or(0.0, |last| (tip - last).norm());
        self.most_step = self.most_step.max(step);
        self.last = Some(tip);
        let mut outside = tip;
        outside.y = outside.y.min(self.wall);
        self.force = (tip - outside).norm() * 1e-3 * STIFFNESS;
        self.most_force = self.most_force.max(self.force);
        let graphic = HandPose::with_point_at(&Vector::from(TIP), &outside, pose.orientation);
        self.link.push_back(Felt {
            graphic: Some(graphic.wire()),
            force_n: self.force,
        });
        self.felt = self.link.pop_front().unwrap_or(Felt::NOTHING);
        tip
    }

    /// Time in seconds with a mouse of 125 Hz that moves the tip by `speed` mm/s along y. Returns the tip's place, mm.
    fn push(&mut self, seconds: f64, speed: f64) -> Vector {
        self.glide(seconds, [speed, 0.0])
    }

    /// The same with speeds along y and z, to the right and upwards for a person before the patient.
    fn glide(&mut self, seconds: f64, speeds: [f64; 2]) -> Vector {
        let mut tip = Vector::zeros();
        for k in 0..(seconds * 1000.0) as usize {
            if k % 8 == 0 {
                // 0.025 mm for a count.
                let [right, up] = speeds.map(|speed| speed * 0.008 / 0.025);
                self.shared
                    .feed(|hands| hands.apply(&Motion::shift(right, up, 0.0)));
            }
            tip = self.period();
        }
        tip
    }
}

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
