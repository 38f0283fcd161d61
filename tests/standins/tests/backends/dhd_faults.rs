//! Force Dimension: faults of controller and driver during a session.

use sulcus_standins::Fault;
use sulcus_standins::board::{Calibration, Mode};
use sulcus_standins::pose::Pose;
use sulcus_standins::setup::{DeviceSetup, Hand, Motion, Setup};

use crate::dhd::{NAME, one, two};
use crate::judge::{self, Steps};
use crate::session::{Options, Session, sleep_ms};

fn in_contact() -> Session {
    let mut session = Session::new(NAME, one());
    session.live(&["1234"]);
    session.force(0, [1.0, 0.0, 0.0], 0.0);
    session.until(|hands| hands[0].displayed[0] > 0.9);
    session
}

fn mode(session: &Session) -> Mode {
    session.rig.snapshot(0).expect("a state").mode
}

#[test]
fn the_force_button_takes_the_force_and_returns_it_with_a_button() {
    let mut session = in_contact();
    session
        .rig
        .fault(0, Fault::ForceButton(false))
        .expect("a fault");
    session.wait(0, "Tripped(Driver)");
    session.wait_said("press the FORCE button");
    session.force(0, [0.0; 3], 0.0);
    session.press_once(0);
    sleep_ms(200);
    // The base has no force still.
    assert_eq!(session.hands()[0].stage, "Tripped(Driver)");
    session
        .rig
        .fault(0, Fault::ForceButton(true))
        .expect("a fault");
    sleep_ms(100);
    session.press(0);
    session.wait(0, "Live");
    assert_eq!(mode(&session), Mode::Force);
    session.rig.fault(0, Fault::DeadMan).expect("a fault");
    session.force(0, [1.0, 0.0, 0.0], 0.0);
    session.wait(0, "Tripped(Driver)");
    session.wait_said("dead man");
    session.stop().expect("an orderly end");
    judge::sound(&session.rig.log().expect("a log"), session.rig.setup());
}

#[test]
fn a_dark_force_button_at_the_start_is_told() {
    let mut setup = one();
    setup.devices[0].lit = false;
    let mut session = Session::new(NAME, setup);
    session.start(&["1234"]);
    session.wait_said("press the FORCE button");
    session.press(0);
    session.wait(0, "Tripped(Driver)");
    session
        .rig
        .fault(0, Fault::ForceButton(true))
        .expect("a fault");
    session.press(0);
    session.wait(0, "Live");
    assert_eq!(mode(&session), Mode::Force);
}

#[test]
fn a_device_without_calibration_tells_the_way_and_moves_only_if_allowed() {
    let mut setup = one();
    setup.devices[0] = setup.devices[0]
        .clone()
        .with_calibration(Calibration::NeedsManualInput, 1);
    let mut session = Session::new(NAME, setup.clone());
    assert_eq!(session.list()[0].state, "Uncalibrated");
    session.start(&["1234"]);
    session.wait(0, "Uncalibrated");
    session.wait_said("calibration pole");
    session
        .rig
        .fault(0, Fault::Calibration(Calibration::Ok))
        .expect("a fault");
    session.press(0);
    session.wait(0, "Live");
    assert_eq!(mode(&session), Mode::Force);
    drop(session);
    let options = Options {
        variables: vec![("SULCUS_DHD_AUTO_INIT", "1".into())],
        ..Options::default()
    };
    let mut session = Session::with(NAME, setup, &options);
    session.live(&["1234"]);
    session.wait_said("let go of the handle");
    assert_eq!(mode(&session), Mode::Force);
    session.stop().expect("an orderly end");
}

#[test]
fn an_unplugged_device_returns_while_the_other_hand_feels_its_force() {
    let mut session = Session::new(NAME, two());
    session.live(&["1234", "77"]);
    session.force(0, [1.0, 0.0, 0.0], 0.0);
    session.force(1, [0.0, 0.5, 0.0], 0.0);
    session.until(|hands| hands[0].displayed[0] > 0.9 && hands[1].displayed[1] > 0.4);
    session.rig.fault(0, Fault::Unplug).expect("a fault");
    session.wait(0, "Absent");
    session.wait_said("the connection is lost");
    sleep_ms(300);
    session.rig.fault(0, Fault::Replug).expect("a fault");
    let returned = sulcus_standins::clock::now_ns();
    session.wait(0, "Touching");
    session.force(0, [0.0; 3], 0.0);
    session.press(0);
    session.wait(0, "Rising");
    session.force(0, [1.0, 0.0, 0.0], 0.0);
    session.wait(0, "Live");
    sleep_ms(200);
    let log = session.rig.log().expect("a log");
    let first = log.first_force_after(0, returned).expect("a force");
    for (at, command) in log.commands(0).iter().filter(|(at, _)| *at >= first) {
        let x = ((at - first + 5_000_000) as f64 * 1e-9 / 0.5).min(1.0);
        let most = x * x * (3.0 - 2.0 * x) + 0.01;
        let force = command.asked_force[1];
        assert!(force <= most, "{force} N at {x}");
    }
    let hands = session.hands();
    assert_eq!((hands[1].stage.as_str(), hands[1].trips), ("Live", 0));
    assert!(hands[1].displayed[1] > 0.4);
    session.stop().expect("an orderly end");
    judge::sound(&session.rig.log().expect("a log"), session.rig.setup());
}

#[test]
fn errors_of_one_command_are_told_and_a_saturated_motor_is_no_error() {
    let mut setup = Setup::new(vec![DeviceSetup::omega6(5)]);
    setup.devices[0].traits.max_force = 0.8;
    setup.devices[0].traits.continuous_force = 0.8;
    let mut session = Session::new(NAME, setup);
    session.live(&["5"]);
    session.force(0, [1.0, 0.0, 0.0], 0.0);
    session.wait_said("cannot follow");
    session.rig.fault(0, Fault::Error(3)).expect("a fault");
    session.wait_said("(error 3)");
    let hands = session.hands();
    assert_eq!((hands[0].stage.as_str(), hands[0].trips), ("Live", 0));
}

#[test]
fn numbers_that_are_no_pose_and_a_jump_take_the_force() {
    let mut session = in_contact();
    session.rig.fault(0, Fault::PoseNan(true)).expect("a fault");
    session.wait(0, "NoPose");
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

#[test]
fn a_fast_handle_is_braked_and_the_person_turns_the_force_on_again() {
    let mut setup = one();
    setup.devices[0].speed_trip = 0.2;
    let rest = setup.devices[0].hand.clone();
    let mut session = Session::new(NAME, setup);
    session.live(&["1234"]);
    session.force(0, [0.5, 0.0, 0.0], 0.0);
    let hand = Hand::exact(Motion::Sine {
        middle: Pose::default(),
        amplitude: [0.04, 0.0, 0.0],
        turn: [0.0; 3],
        hz: 2.0,
    });
    session.rig.hand(0, hand).expect("a hand");
    session.wait(0, "Tripped");
    session.wait_said("after a fast motion");
    session.rig.hand(0, rest).expect("a hand");
    session.force(0, [0.0; 3], 0.0);
    sleep_ms(200);
    session.press(0);
    session.wait(0, "Live");
    assert_eq!(mode(&session), Mode::Force);
}

#[test]
fn the_gripper_is_a_button() {
    let mut session = Session::new(NAME, Setup::new(vec![DeviceSetup::sigma7(77)]));
    session.start(&["77"]);
    session.wait(0, "Waiting");
    session.rig.fault(0, Fault::Buttons(1)).expect("a fault");
    session.wait(0, "Live");
    session.stop().expect("an orderly end");
}
