//! Modes of the Force Dimension stand-in.

use crate::support::dhd::{Dhd, fresh};
use crate::support::{rig, sleep_ms, wait_until};
use sulcus_standins::Fault;
use sulcus_standins::board::Calibration;
use sulcus_standins::pose::Pose;
use sulcus_standins::setup::{DeviceSetup, Grip, Hand, Motion};

/// An omega.6 whose watchdog waits for `ms`: longer than a busy machine delays a test.
fn omega(ms: f64) -> DeviceSetup {
    DeviceSetup {
        watchdog_ms: ms,
        ..DeviceSetup::omega6(1)
    }
}

/// Mode by the status: reset, idle, force, brake; and the cause of force off.
fn mode(dhd: &Dhd) -> (&'static str, i32) {
    let status = dhd.status_of(0);
    let names = ["reset", "idle", "force", "brake"];
    let on: Vec<_> = (0..4).filter(|i| status[3 + i] == 1).collect();
    assert_eq!(on.len(), 1, "{status:?}");
    (names[on[0]], status[14])
}

#[test]
fn silence_brakes_the_device_until_the_force_is_enabled_again() {
    let rig = rig(vec![omega(300.0)]);
    let (_one, dhd) = fresh(&rig);
    // SAFETY: the functions accept any number.
    unsafe {
        (dhd.open)();
        assert_eq!(mode(dhd), ("idle", 0));
        assert_eq!(
            (dhd.set_force)(1.0, 0.0, 0.0, 0),
            0,
            "without force the driver says nothing"
        );
        (dhd.enable)(1, 0);
        assert_eq!(mode(dhd), ("force", 0));
        (dhd.set_force)(1.0, 0.0, 0.0, 0);
        assert!(wait_until(|| mode(dhd) == ("brake", 3)));
        (dhd.set_force)(1.0, 0.0, 0.0, 0);
        assert_eq!(rig.snapshot(0).expect("a state").force, [0.0; 3]);
        (dhd.enable)(1, 0);
        (dhd.set_force)(2.0, 0.0, 0.0, 0);
        assert_eq!(
            rig.log()
                .expect("a log")
                .motors(0)
                .last()
                .expect("motors")
                .1,
            [2.0, 0.0, 0.0]
        );
        assert_eq!((dhd.enable)(0, 0), 0);
        assert_eq!(mode(dhd), ("idle", 4));
    }
    let log = rig.log().expect("a log");
    assert_eq!(log.watchdogs(0).len(), 1);
    let forces: Vec<_> = log.motors(0).iter().map(|m| m.1[0]).collect();
    assert_eq!(forces, [1.0, 0.0, 2.0, 0.0]);
}

#[test]
fn the_force_button_has_the_last_word() {
    let rig = rig(vec![omega(3000.0)]);
    let (_one, dhd) = fresh(&rig);
    // SAFETY: the functions accept any number.
    unsafe {
        (dhd.open)();
        rig.fault(0, Fault::ForceButton(false)).expect("a fault");
        assert_eq!((dhd.enable)(1, 0), 0);
        assert_eq!(mode(dhd), ("idle", 1));
        rig.fault(0, Fault::ForceButton(true)).expect("a fault");
        (dhd.enable)(1, 0);
        assert_eq!(mode(dhd), ("force", 0));
        (dhd.set_force)(1.0, 0.0, 0.0, 0);
        rig.fault(0, Fault::ForceButton(false)).expect("a fault");
        assert_eq!(mode(dhd), ("brake", 1));
    }
    let log = rig.log().expect("a log");
    assert_eq!(log.output_at(0, u64::MAX), ([0.0; 3], [0.0; 3]));
}

#[test]
fn a_device_in_reset_needs_its_calibration_and_moves_for_it() {
    let device = DeviceSetup::omega6(1).with_calibration(Calibration::NeedsManualInput, 1);
    let rig = rig(vec![device]);
    let (_one, dhd) = fresh(&rig);
    // SAFETY: the functions accept any number.
    unsafe {
        (dhd.drd_open)(0);
        assert_eq!(mode(dhd), ("reset", 0));
        assert!(!(dhd.initialized)(0));
        assert_eq!(((dhd.enable)(1, 0), (dhd.error)()), (-1, 12));
        assert_eq!(((dhd.set_force)(0.0, 0.0, 0.0, 0), (dhd.error)()), (-1, 12));
        let watcher = std::thread::spawn(|| {
            let mut most = 0.0f64;
            for _ in 0..150 {
                most = most.max(dhd.three(dhd.position, 0).1[2].abs());
                sleep_ms(1);
            }
            most
        });
        assert_eq!((dhd.auto_init)(0), 0);
        assert!(watcher.join().expect("no panic") > 0.005);
        assert!((dhd.initialized)(0));
        assert_eq!(mode(dhd), ("idle", 0));
        assert_eq!((dhd.enable)(1, 0), 0);
        rig.fault(0, Fault::Calibration(Calibration::NeedsManualInput))
            .expect("a fault");
        assert_eq!(mode(dhd), ("reset", 0));
        assert_eq!((dhd.drd_close)(0), 0);
    }
}

#[test]
fn gravity_is_compensated_only_while_forces_flow() {
    let hand = Hand::held(Motion::Rest(Pose::default()), Grip::light());
    let rig = rig(vec![DeviceSetup::omega6(1).with_hand(hand)]);
    let (_one, dhd) = fresh(&rig);
    let height = || rig.snapshot(0).expect("a state").pose.position[2];
    assert!(wait_until(|| height() < -0.015), "{} m", height());
    // SAFETY: the functions accept any number.
    unsafe {
        (dhd.open)();
        let mut risen = false;
        for _ in 0..5000 {
            (dhd.enable)(1, 0);
            (dhd.set_force)(0.0, 0.0, 0.0, 0);
            risen = height() > -0.002;
            if risen {
                break;
            }
        }
        assert!(risen, "{} m", height());
        assert!(wait_until(|| mode(dhd) == ("brake", 3)));
    }
    assert!(wait_until(|| height() < -0.015), "{} m", height());
}

#[test]
fn a_fast_handle_trips_the_controller() {
    let mut device = DeviceSetup::omega6(1);
    device.speed_trip = 0.5;
    let rig = rig(vec![device]);
    let (_one, dhd) = fresh(&rig);
    // SAFETY: the functions accept any number.
    unsafe {
        (dhd.open)();
        assert_eq!((dhd.watchdog)(0, 0), -1, "the expert mode is off");
        (dhd.expert)();
        (dhd.watchdog)(0, 0);
        (dhd.enable)(1, 0);
        let motion = Motion::Sine {
            middle: Pose::default(),
            amplitude: [0.05, 0.0, 0.0],
            turn: [0.0; 3],
            hz: 5.0,
        };
        rig.hand(0, Hand::exact(motion)).expect("a hand");
        assert!(wait_until(|| mode(dhd) == ("brake", 2)));
    }
}
