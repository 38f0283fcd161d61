//! The log is complete, and its judgements are right.

use crate::support::hd::{OUTPUT, fresh};
use crate::support::rig;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;
use sulcus_standins::pose::Pose;
use sulcus_standins::setup::{DeviceSetup, Grip, Hand, Motion};

#[test]
fn the_log_has_every_frame_of_both_devices() {
    let rig = rig(vec![
        DeviceSetup::touch("Left", "L1"),
        DeviceSetup::touch("Right", "R1"),
    ]);
    let (_one, hd) = fresh(&rig);
    let (left, right) = (hd.open("Left"), hd.open("Right"));
    for hhd in [left, right] {
        // SAFETY: the handle is open.
        unsafe {
            (hd.make_current)(hhd);
            (hd.enable)(OUTPUT);
        }
    }
    let ticks = AtomicU64::new(0);
    let running = hd.run(|| {
        let n = ticks.fetch_add(1, Ordering::AcqRel) + 1;
        hd.frame(left, [(n as f64 * 0.01).min(2.0), 0.0, 0.0]);
        hd.frame(right, [0.0, -0.5, 0.0]);
    });
    rig.wait_log(Duration::from_secs(20), |log| log.frames(0) > 1000)
        .expect("a log");
    drop(running);
    let ended = rig.log().expect("a log");
    let count = ticks.load(Ordering::Acquire) as usize;
    assert_eq!((ended.frames(0), ended.frames(1)), (count, count));
    assert_eq!(ended.flaws(rig.setup()), Vec::<String>::new());
    assert_eq!((ended.largest_asked(0), ended.largest_force(0)), (2.0, 2.0));
    assert_eq!(ended.largest_force(1), 0.5);
    assert!((ended.largest_step(0) - 0.01).abs() < 1e-9);
    assert!(ended.largest_change_per_ms(0) >= 0.0099);
    for device in 0..2 {
        // SAFETY: the handle is open.
        unsafe { (hd.disable_device)(if device == 0 { left } else { right }) };
    }
    let closed = rig.log().expect("a log");
    assert!(closed.last_command_to_zero(0).is_some());
    assert_eq!(closed.output_at(0, u64::MAX), ([0.0; 3], [0.0; 3]));
    let shown = closed.commands(0);
    assert!(
        shown
            .windows(2)
            .all(|pair| pair[0].1.pose_stamp <= pair[1].1.pose_stamp)
    );
    let fresh = shown
        .windows(2)
        .filter(|pair| pair[0].1.pose_stamp < pair[1].1.pose_stamp)
        .count();
    assert!(fresh > shown.len() / 2, "{fresh} of {}", shown.len());
}

#[test]
fn the_motors_push_a_held_handle() {
    let hand = Hand::held(Motion::Rest(Pose::default()), Grip::light());
    let rig = rig(vec![DeviceSetup::touch("Left", "L1").with_hand(hand)]);
    let (_one, hd) = fresh(&rig);
    let left = hd.open("Left");
    // SAFETY: a device is current.
    unsafe { (hd.enable)(OUTPUT) };
    let running = hd.run(|| hd.frame(left, [0.0, 1.0, 0.0]));
    rig.wait_log(Duration::from_secs(20), |log| log.frames(0) > 700)
        .expect("a log");
    let y = rig.snapshot(0).expect("a state").pose.position[1];
    drop(running);
    assert!(y > 0.006 && y < 0.014, "{y} m");
}

#[test]
fn a_slow_servo_delays_the_motors() {
    let mut device = DeviceSetup::touch("Left", "L1");
    device.latency_us = 3000.0;
    let rig = rig(vec![device]);
    let (_one, hd) = fresh(&rig);
    let left = hd.open("Left");
    // SAFETY: a device is current.
    unsafe { (hd.enable)(OUTPUT) };
    hd.frame(left, [1.0, 0.0, 0.0]);
    let (log, on) = rig
        .wait_log(Duration::from_secs(5), |log| log.largest_force(0) > 0.0)
        .expect("a log");
    assert!(on);
    let delay = log.motors(0)[0].0 - log.commands(0)[0].0;
    assert!((3_000_000..3_200_000).contains(&delay), "{delay} ns");
}
