//! OpenHaptics: faults of the driver during a session.

use sulcus_standins::Fault;
use sulcus_standins::board::{Calibration, Call};
use sulcus_standins::log::Event;

use crate::hd::{NAME, one};
use crate::judge::{self, Steps};
use crate::session::{Session, sleep_ms};

/// Session of a hand with a force.
fn in_contact() -> Session {
    let mut session = Session::new(NAME, one());
    session.live(&["L1"]);
    session.force(0, [1.0, 0.0, 0.0], 0.0);
    session.until(|hands| hands[0].displayed[0] > 0.9);
    session
}

fn calls(session: &Session, wanted: Call) -> usize {
    let log = session.rig.log().expect("a log");
    log.times(
        0,
        |event| matches!(event, Event::Call { call, .. } if *call == wanted),
    )
    .len()
}

#[test]
fn warm_motors_have_no_force_until_they_are_cool_and_a_button_is_pressed() {
    let mut session = in_contact();
    session.rig.fault(0, Fault::Warm).expect("a fault");
    session.wait(0, "Tripped(Driver)");
    session.wait_said("the motors are warm");
    let off = sulcus_standins::clock::now_ns();
    sleep_ms(100);
    assert_eq!(
        session.rig.log().expect("a log").first_force_after(0, off),
        None
    );
    assert!(calls(&session, Call::Disable) >= 1);
    session.force(0, [0.0; 3], 0.0);
    session.press_once(0);
    sleep_ms(200);
    assert_eq!(session.hands()[0].stage, "Tripped(Driver)");
    session.rig.fault(0, Fault::Cool).expect("a fault");
    sleep_ms(300);
    assert_eq!(session.hands()[0].stage, "Tripped(Driver)");
    session.press(0);
    session.wait(0, "Live");
    session.force(0, [1.0, 0.0, 0.0], 0.0);
    session.until(|hands| hands[0].displayed[0] > 0.9);
    sleep_ms(100);
    let log = session.rig.log().expect("a log");
    assert!((log.output_at(0, u64::MAX).0[0] - 1.0).abs() < 0.05);
    judge::sound(&log, session.rig.setup());
}

#[test]
fn one_refusal_takes_the_force_and_another_error_does_not() {
    let mut session = in_contact();
    session.rig.fault(0, Fault::Error(0x102)).expect("a fault");
    session.wait_said("0x102");
    assert_eq!(session.hands()[0].stage, "Live");
    session.rig.fault(0, Fault::Error(0x203)).expect("a fault");
    session.wait(0, "Tripped(Driver)");
    session.wait_said("0x203");
    session.force(0, [0.0; 3], 0.0);
    sleep_ms(200);
    session.press(0);
    session.wait(0, "Live");
}

#[test]
fn a_calibration_goes_on_until_the_library_is_content() {
    let mut setup = one();
    setup.devices[0] = setup.devices[0]
        .clone()
        .with_calibration(Calibration::NeedsUpdate, 200);
    let mut session = Session::new(NAME, setup);
    session.start(&["L1"]);
    session.wait(0, "Uncalibrated");
    session.wait_said("is being calibrated");
    session.wait(0, "Waiting");
    let updates = calls(&session, Call::UpdateCalibration);
    assert!((200..260).contains(&updates), "{updates}");
    session.press(0);
    session.wait(0, "Live");
    session
        .rig
        .fault(0, Fault::Calibration(Calibration::NeedsManualInput))
        .expect("a fault");
    session.wait(0, "Uncalibrated");
    session.wait_said("is not calibrated");
    session
        .rig
        .fault(0, Fault::Calibration(Calibration::Ok))
        .expect("a fault");
    session.press(0);
    session.wait(0, "Live");
    let said = session.said();
    assert_eq!(said.matches("is not calibrated and").count(), 1, "{said}");
    session.stop().expect("an orderly end");
}

/// Session in contact after a stall of 6 ms, and the longest time between two commands since, ns.
fn after_a_short_stall() -> (Session, u64) {
    let session = in_contact();
    let before = session.rig.log().expect("a log").intervals(0).len();
    session.rig.fault(0, Fault::Stall(6)).expect("a fault");
    sleep_ms(100);
    let intervals = session.rig.log().expect("a log").intervals(0);
    let longest = intervals.iter().skip(before).max().copied();
    (session, longest.unwrap_or(u64::MAX))
}

#[test]
fn a_long_stall_takes_the_force_and_a_short_one_does_not() {
    // A busy machine may make a stall longer than it was asked for.
    let mut tries = (0..5).map(|_| after_a_short_stall());
    let short = tries.find(|(_, longest)| *longest < 12_000_000);
    let (mut session, _) = short.expect("a stall below 12 ms in five tries");
    assert_eq!(session.hands()[0].stage, "Live");
    session.rig.fault(0, Fault::Stall(60)).expect("a fault");
    session.wait(0, "Tripped(Driver)");
    session.wait_said("stopped for more than 15 ms");
    let log = session.rig.log().expect("a log");
    assert!(!log.watchdogs(0).is_empty());
    assert_eq!(log.output_at(0, u64::MAX).0, [0.0; 3]);
    judge::sound(&log, session.rig.setup());
    // Without a force nothing is lost.
    session.force(0, [0.0; 3], 0.0);
    session.press(0);
    session.wait(0, "Live");
    session.rig.fault(0, Fault::Stall(60)).expect("a fault");
    sleep_ms(200);
    assert_eq!(session.hands()[0].stage, "Live");
    session.rig.fault(0, Fault::Rate(300)).expect("a fault");
    session.wait_said("below 500 Hz");
    sleep_ms(1000);
    let said = session.said();
    assert_eq!(said.matches("below 500 Hz").count(), 1, "{said}");
}

#[test]
fn jitter_costs_neither_force_nor_slew() {
    let mut session = in_contact();
    session.rig.fault(0, Fault::Jitter(3000)).expect("a fault");
    session.force(0, [1.0, 0.0, 0.0], 0.5);
    sleep_ms(3000);
    let hands = session.hands();
    assert_eq!((hands[0].stage.as_str(), hands[0].trips), ("Live", 0));
    judge::sound(&session.rig.log().expect("a log"), session.rig.setup());
}

#[test]
fn numbers_that_are_no_pose_take_the_force() {
    let mut session = in_contact();
    session.rig.fault(0, Fault::PoseNan(true)).expect("a fault");
    let hands = session.wait(0, "NoPose");
    assert!(!hands[0].present);
    session
        .rig
        .fault(0, Fault::PoseNan(false))
        .expect("a fault");
    session.wait(0, "Touching");
    session.force(0, [0.0; 3], 0.0);
    session.press(0);
    session.wait(0, "Live");
    session
        .rig
        .fault(0, Fault::Jump([0.02, 0.0, 0.0]))
        .expect("a fault");
    session.wait(0, "Tripped(Jump)");
    judge::sound(&session.rig.log().expect("a log"), session.rig.setup());
}
