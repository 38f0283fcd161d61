use sulcus_core::{Quat, Vec3};

use super::*;
use crate::limits::{Limits, SlewLimits};

const MS: u64 = 1_000_000;

/// Both ends of a door without a guard: this file tests the mailboxes.
fn ends() -> (HandPort, HandEnd) {
    let limits = Limits {
        force_n: 3.0,
        torque_nm: 0.2,
    };
    let slew = SlewLimits {
        force_n_per_ms: 0.5,
        torque_nm_per_ms: 0.05,
    };
    door(DoorRules::in_step(limits, slew, 1e-3))
}

fn pose() -> Pose {
    Pose::new(Vec3::new(0.01, 0.02, 0.03), Quat::identity())
}

#[test]
fn a_sample_before_the_first_period_is_that_of_no_device() {
    let (_port, mut end) = ends();
    assert_eq!(end.sample(), Sample::NOTHING);
    assert!(!end.sample().present && end.buttons() == 0);
}

#[test]
fn the_newest_order_of_a_flood_is_taken() {
    let (mut port, mut end) = ends();
    for presses in 0..1000 {
        end.order(&Wanted {
            heard_ns: Some(u64::from(presses)),
            presses,
            ..Wanted::NOTHING
        });
    }
    port.exchange(MS, Ok(&pose()), 0);
    assert_eq!(port.orders.read().presses, 999);
}

#[test]
fn a_click_between_two_samples_is_not_lost() {
    let (mut port, mut end) = ends();
    for (ms, buttons) in [(1, 0), (2, 1), (3, 0), (4, 4), (5, 0)] {
        port.exchange(ms * MS, Ok(&pose()), buttons);
    }
    assert_eq!((end.buttons(), end.buttons()), (5, 0));
}

#[test]
fn a_button_is_told_to_the_loop_without_a_pose_too() {
    let (mut port, mut end) = ends();
    port.exchange(MS, Err(Unready::NoPose), 2);
    assert_eq!(end.buttons(), 2);
}

#[test]
fn samples_are_numbered_and_the_number_wraps() {
    let (mut port, mut end) = ends();
    port.sequence = u32::MAX - 1;
    for (ms, number) in [(1, u32::MAX), (2, 0), (3, 1)] {
        port.exchange(ms * MS, Ok(&pose()), 0);
        let sample = end.sample();
        assert_eq!((sample.sequence, sample.at_ns), (number, ms * MS));
    }
}

#[test]
fn a_device_thread_goes_on_without_its_loop_and_a_loop_without_its_device() {
    let (mut port, end) = ends();
    drop(end);
    port.exchange(MS, Ok(&pose()), 1);
    let (port, mut end) = ends();
    drop(port);
    end.order(&Wanted::NOTHING);
    assert_eq!(end.sample(), Sample::NOTHING);
}

#[test]
fn both_ends_go_to_threads() {
    fn goes<T: Send>(_: &T) {}
    let (port, end) = ends();
    goes(&port);
    goes(&end);
}

/// A back-end that forgets the guard once had a door without an interlock.
#[test]
fn rules_without_a_guard_let_no_force_pass() {
    let limits = Limits {
        force_n: 3.0,
        torque_nm: 0.2,
    };
    let slew = SlewLimits {
        force_n_per_ms: 0.5,
        torque_nm_per_ms: 0.03,
    };
    let (mut port, mut end) = door(DoorRules::in_step(limits, slew, 1e-3));
    let pose = Pose::identity();
    for ms in 1..=2000_u64 {
        let now_ns = ms * 1_000_000;
        end.order(&Wanted {
            wrench: Wrench {
                force: Vec3::new(0.0, 0.0, 2.0),
                torque: Vec3::new(0.1, 0.0, 0.0),
            },
            heard_ns: Some(now_ns),
            ..Wanted::NOTHING
        });
        let wrench = port.exchange(now_ns, Ok(&pose), 1);
        assert_eq!(wrench, Wrench::ZERO, "{ms} ms");
    }
}
