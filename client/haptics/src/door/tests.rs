//! One test for each step of the door, named for the danger that the step excludes.

use std::time::Duration;

use sulcus_core::Quat;

use super::*;
use crate::continuous::ContinuousLimit;
use crate::freshness::Silence;
use crate::limits::SlewLimits;
use crate::mapping::Mapping;
use crate::passivity::PassivityParams;

const MS: u64 = 1_000_000;
const PEAK: f64 = 3.0;
const SLEW: f64 = 0.5;

fn rules() -> DoorRules {
    let motors = |peak: f64| ContinuousLimit {
        lasting: peak,
        peak,
        time_s: 10.0,
    };
    let guard = Guard {
        mapping: Mapping {
            world_from_base: Quat::identity(),
            origin: Vec3::zeros(),
            scale: 1.0,
            gimbal_from_tool: Pose::identity(),
        },
        has_torque: true,
        silence: Silence::DEVICE,
        blend_ns: 0,
        force: motors(PEAK),
        torque: motors(0.2),
        clutch: 0,
    };
    let limits = Limits {
        force_n: PEAK,
        torque_nm: 0.2,
    };
    let slew = SlewLimits {
        force_n_per_ms: SLEW,
        torque_nm_per_ms: 0.05,
    };
    DoorRules::guarded(limits, slew, PassivityParams::default(), guard)
}

/// Performs a period with an order of `force`, 1 ms after the last one.
fn feel(door: &mut Door, force: Vec3) -> Vec3 {
    let now_ns = door.passed_ns.map_or(0, |last| last + MS);
    let hand = door.guard.as_ref().map_or(Pose::identity(), |of| of.hand);
    feel_at(door, now_ns, force, &hand)
}

fn feel_at(door: &mut Door, now_ns: u64, force: Vec3, hand: &Pose) -> Vec3 {
    door.order(&Wanted {
        wrench: Wrench {
            force,
            torque: Vec3::zeros(),
        },
        heard_ns: Some(now_ns),
        ..Wanted::NOTHING
    });
    door.exchange(now_ns, Ok(hand), 0).force
}

/// A door past its start, with open watchdog.
fn live(rules: DoorRules) -> Door {
    let mut door = Door::new(rules);
    feel(&mut door, Vec3::zeros());
    let now_ns = MS;
    door.exchange(now_ns, Ok(&Pose::identity()), 1);
    (0..600).for_each(|_| {
        feel(&mut door, Vec3::zeros());
    });
    assert_eq!((door.stage(), door.gate()), (Stage::Live, 1.0));
    door
}

fn push(newtons: f64) -> Vec3 {
    Vec3::new(newtons, 0.0, 0.0)
}

/// Newest force after `periods` periods.
fn felt(door: &mut Door, force: Vec3, periods: u64) -> Vec3 {
    (0..periods)
        .map(|_| feel(door, force))
        .last()
        .expect("a period")
}

fn guard_of(rules: &mut DoorRules) -> &mut Guard {
    rules.guard.as_mut().expect("a guard")
}

/// Step 1: a device of 4 kHz on a link of 1 kHz would feel each wrench as a stair, and hum.
#[test]
fn a_fast_device_feels_no_stairs() {
    let mut rules = rules();
    guard_of(&mut rules).blend_ns = MS;
    let mut door = live(rules);
    felt(&mut door, push(1.0), 20);
    let at = door.passed_ns.expect("a period") + MS;
    let order = |heard_ns: u64, newtons: f64| Wanted {
        wrench: Wrench {
            force: push(newtons),
            torque: Vec3::zeros(),
        },
        heard_ns: Some(heard_ns),
        ..Wanted::NOTHING
    };
    door.order(&order(at, 1.4));
    for quarter in 0..4_u64 {
        let force = door.interpolated(at + quarter * MS / 4).force.x;
        assert!(
            (force - (1.0 + 0.1 * quarter as f64)).abs() < 1e-12,
            "{force}"
        );
    }
    // The next wrench begins where the blend was.
    door.order(&order(at + MS / 2, 5.0));
    assert!((door.interpolated(at + MS / 2).force.x - 1.2).abs() < 1e-12);
}

/// Step 2: with swapped axes a press to the left is felt as one upwards.
#[test]
fn the_force_has_the_axes_of_the_seat() {
    let mut rules = rules();
    guard_of(&mut rules).mapping.world_from_base = Mapping::seat(6.0);
    let mut door = live(rules);
    // In front of the face: up is z in the world and y at the device.
    let up = felt(&mut door, Vec3::new(0.0, 0.0, 1.0), 20);
    assert!(norm(&(up - Vec3::y())) < 1e-12, "{up}");
    let world = door.displayed_in_world().force;
    assert!(norm(&(world - Vec3::z())) < 1e-12, "{world}");
}

/// Step 3, watchdog: a wrench that returns after a long silence must not come at once.
#[test]
fn a_link_that_returns_after_a_gap_is_felt_slowly() {
    let mut door = live(rules());
    felt(&mut door, push(2.0), 20);
    (0..100).for_each(|_| {
        let now_ns = door.passed_ns.expect("a period") + MS;
        door.exchange(now_ns, Ok(&Pose::identity()), 0);
    });
    assert_eq!(door.displayed(), Wrench::ZERO);
    let force = felt(&mut door, push(2.0), 50);
    assert!(force.x < 0.1, "{force}");
}

/// Step 3, silence: a force of a dead loop would press on.
#[test]
fn a_silent_mailbox_is_zero_within_twenty_milliseconds() {
    let mut door = live(rules());
    felt(&mut door, push(3.0), 20);
    let heard = door.passed_ns.expect("a period");
    let forces: Vec<f64> = (1..=20)
        .map(|ms| {
            norm(
                &door
                    .exchange(heard + ms * MS, Ok(&Pose::identity()), 0)
                    .force,
            )
        })
        .collect();
    assert!(forces[..5].iter().all(|&force| force == PEAK), "{forces:?}");
    assert!(
        forces.is_sorted_by(|a, b| a >= b) && forces[17..] == [0.0; 3],
        "{forces:?}"
    );
}

/// Step 3, interlock: a tool inside a tooth at the start would kick.
#[test]
fn a_tool_that_touches_at_the_start_has_no_force() {
    let mut door = Door::new(rules());
    for period in 0..700_u64 {
        let now_ns = period * MS;
        door.order(&Wanted {
            wrench: Wrench {
                force: push(2.0),
                torque: Vec3::zeros(),
            },
            heard_ns: Some(now_ns),
            presses: period as u32,
            ..Wanted::NOTHING
        });
        let buttons = u16::from(period % 2 == 0);
        assert_eq!(
            door.exchange(now_ns, Ok(&Pose::identity()), buttons),
            Wrench::ZERO
        );
        assert!(period == 0 || door.stage() == Stage::Touching);
    }
}

/// Step 4, clamp: a server that sends a meganewton.
#[test]
fn a_meganewton_is_felt_at_the_smallest_limit() {
    let mut rules = rules();
    rules.limits.force_n = 2.0;
    let mut door = live(rules);
    let force = felt(&mut door, push(1e6), 50);
    assert!((force.x - 2.0).abs() < 1e-9, "{force}");
    assert_eq!(felt(&mut door, Vec3::repeat(f64::NAN), 50), Vec3::zeros());
}

/// Step 4, continuous force: a wall that is pressed for a minute would stop the driver.
#[test]
fn a_lasting_press_falls_to_the_continuous_force() {
    let mut rules = rules();
    guard_of(&mut rules).force = ContinuousLimit {
        lasting: 1.0,
        peak: PEAK,
        time_s: 1.0,
    };
    let mut door = live(rules);
    assert!((felt(&mut door, push(3.0), 20).x - 3.0).abs() < 1e-9);
    let force = felt(&mut door, push(3.0), 10_000);
    assert!(
        (force.x - 1.0).abs() < 0.02 && door.counts().limited > 9_000,
        "{force}"
    );
}

/// Step 5: a wall that returns more energy than it took would shake the hand.
#[test]
fn a_wrench_that_pushes_the_hand_along_is_braked() {
    let mut door = live(rules());
    felt(&mut door, push(1.0), 20);
    let mut hand = Pose::identity();
    let mut force = push(1.0);
    for _ in 0..40 {
        hand.position.x += 0.3e-3;
        let now_ns = door.passed_ns.expect("a period") + MS;
        force = feel_at(&mut door, now_ns, push(1.0), &hand);
    }
    assert!(force.x < 0.5 && door.energy().acted > 10, "{force}");
}

/// Step 6: a contact that begins at once would be a blow.
#[test]
fn a_sudden_wall_comes_step_by_step_and_a_late_call_is_no_blow() {
    let mut door = live(rules());
    for steps in 1..=3 {
        let force = feel(&mut door, push(3.0));
        assert!((force.x - SLEW * f64::from(steps)).abs() < 1e-9, "{force}");
    }
    let late = door.passed_ns.expect("a period") + 4 * MS;
    let force = feel_at(&mut door, late, push(3.0), &Pose::identity());
    assert!((force.x - 2.5).abs() < 1e-9, "{force}");
    // The fall of a wanted force has the limit too.
    let force = feel(&mut door, Vec3::zeros());
    assert!((force.x - 2.0).abs() < 1e-9, "{force}");
}

/// Step 7: the damping has a bound of its own, above the limit of a weak device and above the share of a rise.
#[test]
fn damping_stays_within_the_limit_and_the_rise() {
    let mut rules = rules();
    rules.passivity.max_force = 10.0;
    rules.limits.force_n = 0.4;
    let mut door = live(rules);
    felt(&mut door, push(0.4), 20);
    let mut hand = Pose::identity();
    for _ in 0..100 {
        hand.position.x += 0.9e-3;
        let now_ns = door.passed_ns.expect("a period") + MS;
        let force = feel_at(&mut door, now_ns, push(0.4), &hand);
        assert!(norm(&force) <= 0.4 + 1e-9, "{force}");
    }
    assert!(door.energy().acted > 10);
    let share = 0.25;
    let most = |guarding: &mut Guarding| guarding.most = share;
    door.guard.as_mut().map(most).expect("a guard");
    let clamped = door.last_clamp(&Wrench {
        force: push(-3.0),
        torque: Vec3::zeros(),
    });
    assert!((norm(&clamped.force) - 0.1).abs() < 1e-12);
    assert_eq!(door.displayed(), clamped);
}

/// A device without torque has no torque of the lever either.
#[test]
fn a_device_without_torque_gets_none_and_the_loss_is_counted() {
    let mut rules = rules();
    let guard = guard_of(&mut rules);
    guard.has_torque = false;
    guard.mapping.gimbal_from_tool.position = Vec3::new(0.0, 0.1, 0.0);
    let mut door = live(rules);
    for _ in 0..30 {
        feel(&mut door, push(2.0));
        assert_eq!(door.displayed().torque, Vec3::zeros());
    }
    assert_eq!(door.counts().dropped, 30);
    assert!((door.counts().most_dropped_nm - 0.2).abs() < 1e-12);
}

/// A session that ends must not leave a force.
#[test]
fn leaving_ends_at_zero() {
    let mut door = live(rules());
    felt(&mut door, push(3.0), 20);
    let at = door.passed_ns.expect("a period");
    let mut wanted = door.wanted;
    for ms in 1..=20 {
        (wanted.leaving, wanted.heard_ns) = (true, Some(at + ms * MS));
        door.order(&wanted);
        let force = door.exchange(at + ms * MS, Ok(&Pose::identity()), 0).force;
        let left = fmax_of(PEAK - SLEW * ms as f64);
        assert!((norm(&force) - left).abs() < 1e-9, "{force} after {ms} ms");
    }
}

fn fmax_of(x: f64) -> f64 {
    sulcus_core::math::fmax(x, 0.0)
}

/// A hand that moves back in its workspace must not move the tool.
#[test]
fn a_clutch_holds_the_tool_and_moves_the_base() {
    let mut rules = rules();
    let guard = guard_of(&mut rules);
    (guard.clutch, guard.mapping.scale) = (2, 2.0);
    let mut door = live(rules);
    let place = |door: &Door| door.tool().expect("a pose").position.x;
    let mut x = 0.0;
    let mut step = |door: &mut Door, way: f64, buttons: u16| {
        x += way;
        let now_ns = door.passed_ns.expect("a period") + MS;
        let pose = Pose::new(push(x), Quat::identity());
        door.exchange(now_ns, Ok(&pose), buttons);
    };
    step(&mut door, 1e-3, 0);
    assert!((place(&door) - 2e-3).abs() < 1e-12);
    for _ in 0..10 {
        step(&mut door, 1e-3, 2);
    }
    let held = place(&door);
    step(&mut door, 1e-3, 0);
    assert!((place(&door) - held).abs() < 1e-12);
    step(&mut door, 1e-3, 0);
    assert!((place(&door) - held - 2e-3).abs() < 1e-12);
}

#[test]
fn the_rules_of_a_guard_limit_the_force_to_what_the_slew_limit_takes_away() {
    let fall = Silence::DEVICE.fall();
    assert_eq!(fall, Duration::from_millis(13));
    let mut slow = rules();
    slow.slew.force_n_per_ms = 0.1;
    let guard = slow.guard.expect("a guard");
    let rules = DoorRules::guarded(slow.limits, slow.slew, slow.passivity, guard);
    assert!((rules.limits.force_n - 1.3).abs() < 1e-12);
    assert!(rules.passivity.max_force <= 1.3);
}

/// A simulated class found up to 0.3 N at a hand in a pause: the passivity controller went on to brake the hand for the
/// contact before.
#[test]
fn in_a_pause_no_brake_is_left_of_a_contact() {
    let limits = Limits {
        force_n: PEAK,
        torque_nm: 0.2,
    };
    let slew = SlewLimits {
        force_n_per_ms: SLEW,
        torque_nm_per_ms: 0.05,
    };
    let [braked, paused] = [false, true].map(|paused| {
        let mut door = Door::new(DoorRules::in_step(limits, slew, 1e-3));
        let mut at = Pose::identity();
        for k in 0..758_u64 {
            // The hand gives way by a millimetre at once, behind a loop that has overslept. Then the hand is slow.
            let newtons = if (740..750).contains(&k) { PEAK } else { 0.0 };
            door.order(&Wanted {
                wrench: Wrench {
                    force: Vec3::new(newtons, 0.0, 0.0),
                    torque: Vec3::zeros(),
                },
                heard_ns: Some(k * MS),
                paused: paused && k >= 750,
                ..Wanted::NOTHING
            });
            door.pass(k * MS);
            at.position.x += match k {
                ..749 => 0.0,
                749 => 1e-3,
                _ => 1e-5,
            };
            door.moved(Some(&at), 1);
        }
        norm(&door.displayed().force)
    });
    assert!(
        braked > 0.05,
        "the hand was braked without a pause: {braked}"
    );
    assert_eq!(paused, 0.0);
}
