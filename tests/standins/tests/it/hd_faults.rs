//! Faults of HD devices.

use crate::support::hd::{NONE, OUTPUT, fresh};
use crate::support::{rig, sleep_ms, wait_until};
use std::time::Duration;
use sulcus_standins::log::{Cause, Event};
use sulcus_standins::pose::Pose;
use sulcus_standins::setup::{DeviceSetup, Hand};
use sulcus_standins::{Fault, Log};

const LONG: Duration = Duration::from_secs(5);

#[test]
fn warm_motors_are_off_until_they_are_cool() {
    let rig = rig(vec![DeviceSetup::touch("Left", "L1")]);
    let (_one, hd) = fresh(&rig);
    let left = hd.open("Left");
    // SAFETY: a device is current.
    unsafe { (hd.enable)(OUTPUT) };
    let running = hd.run(|| hd.frame(left, [1.0, 0.0, 0.0]));
    rig.wait_log(LONG, |log| log.frames(0) > 5).expect("a log");
    assert!(wait_until(
        || rig.snapshot(0).expect("a state").force == [1.0, 0.0, 0.0]
    ));
    rig.fault(0, Fault::Warm).expect("a fault");
    let (log, warm) = rig
        .wait_log(LONG, |log| log.errors(0).contains(&0x200))
        .expect("a log");
    assert!(warm);
    assert!(!log.times(0, |e| *e == Event::Warm(true)).is_empty());
    assert_eq!(rig.snapshot(0).expect("a state").force, [0.0; 3]);
    rig.fault(0, Fault::Cool).expect("a fault");
    assert!(wait_until(
        || rig.snapshot(0).expect("a state").force == [1.0, 0.0, 0.0]
    ));
    drop(running);
}

#[test]
fn a_force_above_the_continuous_force_warms_the_motors() {
    let mut device = DeviceSetup::touch("Left", "L1");
    device.heat_budget = 0.5;
    let rig = rig(vec![device]);
    let (_one, hd) = fresh(&rig);
    let left = hd.open("Left");
    // SAFETY: a device is current.
    unsafe { (hd.enable)(OUTPUT) };
    let running = hd.run(|| hd.frame(left, [3.0, 0.0, 0.0]));
    let (_, warm) = rig
        .wait_log(LONG, |log| {
            !log.times(0, |e| *e == Event::Warm(true)).is_empty()
        })
        .expect("a log");
    assert!(warm);
    drop(running);
}

#[test]
fn an_unplugged_device_gets_nothing_until_it_is_opened_anew() {
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
    let running = hd.run(|| {
        hd.frame(left, [1.0, 0.0, 0.0]);
        hd.frame(right, [0.0, 1.0, 0.0]);
    });
    rig.wait_log(LONG, |log| log.frames(0) > 5).expect("a log");
    rig.fault(0, Fault::Unplug).expect("a fault");
    let pulled = |log: &Log| log.times(0, |e| *e == Event::Fault(Fault::Unplug))[0];
    let (log, cut) = rig
        .wait_log(LONG, |log| {
            log.watchdogs(0).iter().any(|t| *t > pulled(log))
        })
        .expect("a log");
    assert!(cut);
    assert!(log.errors(0).iter().all(|code| *code == 0x302));
    assert!(log.errors(1).is_empty());
    let unplugged = pulled(&log);
    let since = |t: &u64| *t > unplugged;
    assert!(
        log.commands(0)
            .iter()
            .filter(|c| since(&c.0))
            .all(|c| c.1.ignored == Some(Cause::Unplugged))
    );
    assert_eq!(rig.snapshot(0).expect("a state").force, [0.0; 3]);
    assert!(wait_until(
        || rig.snapshot(1).expect("a state").force == [0.0, 1.0, 0.0]
    ));
    rig.fault(0, Fault::Replug).expect("a fault");
    sleep_ms(20);
    assert_eq!(rig.snapshot(0).expect("a state").force, [0.0; 3]);
    drop(running);
    assert!(hd.errors().iter().all(|e| *e == (0x302, left)));
    // SAFETY: the handle is open.
    unsafe { (hd.disable_device)(left) };
    let anew = hd.open("Left");
    assert_ne!(anew, NONE);
    // SAFETY: a device is current.
    unsafe { (hd.enable)(OUTPUT) };
    hd.frame(anew, [0.5, 0.0, 0.0]);
    let log = rig.log().expect("a log");
    assert_eq!(log.commands(0).last().expect("a command").1.ignored, None);
}

#[test]
fn faults_of_the_pose_show_in_the_frames() {
    let pose = Pose::at([0.01, 0.02, 0.03]);
    let rig = rig(vec![
        DeviceSetup::touch("Left", "L1").with_hand(Hand::rest(pose)),
    ]);
    let (_one, hd) = fresh(&rig);
    let left = hd.open("Left");
    let position = || {
        hd.frame(left, [0.0; 3]);
        hd.doubles::<3>(0x2050)
    };
    let near = |p: [f64; 3], q: [f64; 3]| (0..3).all(|i| (p[i] - q[i]).abs() < 0.06);
    assert!(near(position(), [10.0, 20.0, 30.0]));
    rig.fault(0, Fault::Jump([0.02, 0.0, 0.0]))
        .expect("a fault");
    assert!(near(position(), [30.0, 20.0, 30.0]));
    rig.fault(0, Fault::PoseNan(true)).expect("a fault");
    assert!(position().iter().all(|c| c.is_nan()));
    rig.fault(0, Fault::PoseNan(false)).expect("a fault");
    assert!(near(position(), [30.0, 20.0, 30.0]));
    rig.fault(0, Fault::Buttons(0b10)).expect("a fault");
    hd.frame(left, [0.0; 3]);
    let mut buttons = 0;
    // SAFETY: the pointer has room for the parameter.
    unsafe { (hd.get_integer)(0x2000, &mut buttons) };
    assert_eq!(buttons, 2);
    rig.fault(0, Fault::Error(0x203)).expect("a fault");
    hd.frame(left, [0.0; 3]);
    hd.frame(left, [0.0; 3]);
    assert_eq!(hd.errors(), [(0x203, left)]);
}
