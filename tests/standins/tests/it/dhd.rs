//! The Force Dimension stand-in: its binary interface, ids, poses and forces.

use crate::support::dhd::fresh;
use crate::support::{rig, sleep_ms};
use std::ffi::CStr;
use sulcus_standins::Fault;
use sulcus_standins::pose::Pose;
use sulcus_standins::setup::{DeviceSetup, Hand, Motion};

/// The device with a watchdog that waits longer than a busy machine delays a test.
fn patient(device: DeviceSetup) -> DeviceSetup {
    DeviceSetup {
        watchdog_ms: 3000.0,
        ..device
    }
}

#[test]
fn eight_arguments_with_a_trailing_id_arrive_in_order() {
    let rig = rig(vec![
        patient(DeviceSetup::omega6(1001)),
        patient(DeviceSetup::sigma7(1002)),
    ]);
    let (_one, dhd) = fresh(&rig);
    // SAFETY: the functions accept any number.
    unsafe {
        let sigma = (dhd.open_serial)(1002);
        let omega = (dhd.open_id)(0);
        assert_eq!((sigma, omega), (0, 1), "ids follow the order of opening");
        assert_eq!(
            ((dhd.kind)(0), (dhd.kind)(1), (dhd.kind)(-1)),
            (104, 34, 34)
        );
        assert_eq!(CStr::from_ptr((dhd.name)(0)), c"sigma.7");
        let mut serial = 0;
        assert_eq!((dhd.serial)(&mut serial, 0), 0);
        assert_eq!(serial, 1002);
        assert!((dhd.active_wrist)(0) && !(dhd.active_wrist)(1) && (dhd.wrist)(1));
        for id in [0, 1] {
            assert_eq!((dhd.enable)(1, id), 0);
            assert_eq!((dhd.set_all)(1.0, 2.0, 3.0, 0.1, 0.2, 0.3, 4.0, id), 0);
        }
        assert_eq!((dhd.set_force)(4.0, 5.0, 6.0, -1), 0);
        (dhd.close)(1);
        assert_eq!(
            (dhd.kind)(-1),
            104,
            "another device is the default after a close"
        );
        assert_eq!((dhd.set_force)(0.0, 0.0, 0.0, 1), -1);
        assert_eq!((dhd.error)(), 6);
    }
    let log = rig.log().expect("a log");
    let (omega, sigma) = (log.commands(0), log.commands(1));
    assert_eq!((omega.len(), sigma.len()), (2, 1));
    assert_eq!(
        (sigma[0].1.force, sigma[0].1.torque),
        ([1.0, 2.0, 3.0], [0.1, 0.2, 0.3])
    );
    assert_eq!(
        (omega[0].1.asked_torque, omega[0].1.torque),
        ([0.1, 0.2, 0.3], [0.0; 3])
    );
    assert_eq!(omega[1].1.force, [4.0, 5.0, 6.0]);
    assert_eq!(log.largest_torque(0), 0.0);
    assert!(log.largest_torque(1) > 0.37);
}

#[test]
fn the_frame_has_its_rows_first_and_a_second_reading_is_the_same() {
    let mut device = DeviceSetup::omega6(1);
    device.angle_step = 0.0;
    let pose = Pose::at([0.01, 0.02, -0.03]).turned([1.0, 2.0, -0.5], 0.9);
    let falcon = DeviceSetup::falcon(2).with_hand(Hand::rest(pose));
    let rig = rig(vec![device.with_hand(Hand::rest(pose)), falcon]);
    let (_one, dhd) = fresh(&rig);
    let (mut x, mut y, mut z, mut r) = (0.0, 0.0, 0.0, [[0.0; 3]; 3]);
    // SAFETY: the pointers are valid.
    unsafe {
        assert_eq!((dhd.open)(), 0);
        assert_eq!((dhd.time_guard)(1_000_000, 0), 0);
        assert_eq!((dhd.frame)(&mut x, &mut y, &mut z, &mut r, 0), 0);
        assert_eq!((dhd.frame)(&mut x, &mut y, &mut z, &mut r, 0), 1);
        assert_eq!((dhd.time_guard)(0, 0), 0);
        assert_eq!((dhd.frame)(&mut x, &mut y, &mut z, &mut r, 0), 0);
        assert_eq!(
            (dhd.frame)(&mut x, &mut y, &mut z, std::ptr::null_mut(), 0),
            -1
        );
        assert_eq!((dhd.error)(), 17);
    }
    assert!((x - 0.01).abs() < 1e-5 && (z + 0.03).abs() < 1e-5);
    for (row, expected) in r.iter().zip(pose.matrix()) {
        assert!((0..3).all(|i| (row[i] - expected[i]).abs() < 1e-12));
    }
    // SAFETY: the pointers are valid.
    unsafe {
        let falcon = (dhd.open_type)(60);
        assert_eq!(
            (dhd.frame)(&mut x, &mut y, &mut z, &mut r, falcon as i8 as _),
            0
        );
    }
    assert_eq!(r, Pose::default().matrix());
}

#[test]
fn the_first_velocity_is_an_error_and_errors_belong_to_their_thread() {
    let motion = Motion::Path(vec![
        (0.0, Pose::default()),
        (60.0, Pose::at([0.05, 0.0, 0.0])),
    ]);
    let rig = rig(vec![DeviceSetup::omega6(1).with_hand(Hand::exact(motion))]);
    let (_one, dhd) = fresh(&rig);
    // SAFETY: the functions accept any number.
    unsafe {
        (dhd.open)();
        assert_eq!(dhd.three(dhd.linear_velocity, 0).0, -1);
        assert_eq!((dhd.error)(), 7);
        let other = std::thread::spawn(|| (dhd.error)())
            .join()
            .expect("no panic");
        assert_eq!(other, 0);
        assert_eq!(dhd.three(dhd.linear_velocity, 0).0, 0);
        assert!(!CStr::from_ptr((dhd.error_text)()).is_empty());
        assert_eq!((dhd.watchdog)(80, 0), -1);
        assert_eq!((dhd.error)(), 9);
        assert_eq!((dhd.expert)(), 0);
        assert_eq!((dhd.watchdog)(80, 0), 0);
    }
}

#[test]
fn a_force_above_the_limit_is_saturated_and_not_an_error() {
    let rig = rig(vec![patient(DeviceSetup::omega6(1))]);
    let (_one, dhd) = fresh(&rig);
    // SAFETY: the functions accept any number.
    unsafe {
        (dhd.open)();
        (dhd.enable)(1, 0);
        assert_eq!((dhd.set_force)(100.0, 0.0, 0.0, 0), 2);
        assert_eq!((dhd.max_force)(3.0, 0), 0);
        assert_eq!((dhd.set_force)(4.0, 0.0, 0.0, 0), 2);
        assert_eq!((dhd.set_force)(2.0, 0.0, 0.0, 0), 0);
        assert_eq!((dhd.set_force)(f64::NAN, 0.0, 0.0, 0), -1);
    }
    let log = rig.log().expect("a log");
    let sent: Vec<_> = log.commands(0).iter().map(|c| c.1.force[0]).collect();
    assert_eq!(sent, [12.0, 3.0, 2.0, 0.0]);
    assert_eq!(log.largest_force(0), 12.0);
    assert!(log.largest_asked(0).is_nan());
    assert_eq!(log.flaws(rig.setup()), Vec::<String>::new());
}

#[test]
fn an_unplugged_device_is_dead_until_it_is_opened_anew() {
    let rig = rig(vec![DeviceSetup::omega6(1), DeviceSetup::omega6(2)]);
    let (_one, dhd) = fresh(&rig);
    // SAFETY: the functions accept any number.
    unsafe {
        assert_eq!((dhd.open_serial)(1), 0);
        rig.fault(0, Fault::Unplug).expect("a fault");
        assert_eq!((dhd.count)(), 1);
        assert_eq!((dhd.set_force)(0.0, 0.0, 0.0, 0), -1);
        assert_eq!((dhd.error)(), 2);
        assert_eq!(dhd.status_of(0)[1], 0);
        rig.fault(0, Fault::Replug).expect("a fault");
        assert_eq!(dhd.three(dhd.position, 0).0, -1);
        (dhd.close)(0);
        assert_eq!((dhd.open_serial)(1), 0);
        assert_eq!(dhd.three(dhd.position, 0).0, 0);
        rig.fault(0, Fault::Buttons(0b101)).expect("a fault");
        sleep_ms(1);
        assert_eq!(
            ((dhd.button)(0, 0), (dhd.button)(1, 0), (dhd.buttons)(0)),
            (1, 0, 0b101)
        );
    }
}
