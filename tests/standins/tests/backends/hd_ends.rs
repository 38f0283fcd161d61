//! OpenHaptics: ways in which the force ends.

use sulcus_standins::Fault;
use sulcus_standins::log::Event;

use crate::commands::Command;
use crate::hd::{NAME, ended_in_order, one, two};
use crate::judge::{self, Steps, ZERO_WITHIN};
use crate::session::{Options, Session, sleep_ms};

#[test]
fn the_force_is_zero_twenty_milliseconds_after_the_last_order() {
    let mut session = Session::new(NAME, one());
    session.live(&["L1"]);
    session.force(0, [1.5, 1.0, 0.0], 0.0);
    sleep_ms(300);
    let last = session.number(&Command::Silence(true));
    sleep_ms(200);
    let log = session.rig.log().expect("a log");
    let force = log.last_force(0).expect("a force");
    // The last order may be a few milliseconds later than the command that ends the orders.
    let after = force.saturating_sub(last);
    println!("last force {after} ns after the last order");
    assert!(after <= 25_000_000, "{after} ns");
    session.ask(&Command::Silence(false));
    session.until(|hands| hands[0].displayed[0] > 1.4);
    judge::sound(&session.rig.log().expect("a log"), session.rig.setup());
}

#[test]
fn a_killed_client_leaves_no_force_and_a_sentence_for_the_next() {
    let mut session = Session::new(NAME, one());
    session.live(&["L1"]);
    session.force(0, [1.5, 0.0, 0.0], 0.0);
    session.until(|hands| hands[0].displayed[0] > 1.4);
    session.kill();
    sleep_ms(200);
    let log = session.rig.log().expect("a log");
    let zero = log.last_command_to_zero(0).expect("zero");
    assert!(zero < ZERO_WITHIN, "{zero} ns");
    assert!(!log.watchdogs(0).is_empty());
    session.again(NAME, &Options::default());
    let error = session.open(&["L1"]).expect_err("locked");
    assert!(
        error.contains("0x303") && error.contains("plug it in again"),
        "{error}"
    );
    session.rig.fault(0, Fault::Unplug).expect("a fault");
    session.rig.fault(0, Fault::Replug).expect("a fault");
    session.live(&["L1"]);
    session.stop().expect("an orderly end");
}

#[test]
fn an_unplugged_device_returns_and_the_other_hand_goes_on() {
    let mut session = Session::new(NAME, two());
    session.live(&["L1", "R1"]);
    session.force(0, [1.0, 0.0, 0.0], 0.0);
    session.force(1, [0.0, 0.5, 0.0], 0.0);
    session.until(|hands| hands[0].displayed[0] > 0.9 && hands[1].displayed[1] > 0.4);
    session.rig.fault(0, Fault::Unplug).expect("a fault");
    let hands = session.wait(0, "Absent");
    assert!(!hands[0].present);
    session.rig.fault(0, Fault::Replug).expect("a fault");
    session.wait_said("the connection is lost");
    sleep_ms(1500);
    // The library opens a device between two services: not while the other hand has a force.
    let hands = session.hands();
    assert!(
        hands[0].stage.contains("Absent") && hands[1].stage == "Live",
        "{hands:?}"
    );
    assert!(hands[1].displayed[1] > 0.4, "{hands:?}");
    session.force(0, [0.0; 3], 0.0);
    session.force(1, [0.0; 3], 0.0);
    let hands = session.wait(0, "Waiting");
    assert_eq!(hands[1].stage, "Live");
    assert_eq!((hands[0].trips, hands[1].trips), (0, 0), "{hands:?}");
    let returned = sulcus_standins::clock::now_ns();
    session.force(1, [0.0, 0.5, 0.0], 0.0);
    session.press(0);
    session.wait(0, "Rising");
    session.force(0, [1.0, 0.0, 0.0], 0.0);
    session.wait(0, "Live");
    sleep_ms(200);
    let log = session.rig.log().expect("a log");
    let first = log.first_force_after(0, returned).expect("a force");
    for (at, command) in log.commands(0).iter().filter(|(at, _)| *at >= first) {
        // A smooth rise over half a second.
        let x = ((at - first + 5_000_000) as f64 * 1e-9 / 0.5).min(1.0);
        let most = x * x * (3.0 - 2.0 * x) + 0.01;
        assert!(
            command.asked_force[0] <= most,
            "{} N at {x}",
            command.asked_force[0]
        );
    }
    assert!(log.errors(0).contains(&0x302));
    session.stop().expect("an orderly end");
    let log = session.rig.log().expect("a log");
    judge::sound(&log, session.rig.setup());
    ended_in_order(&log, 0);
}

#[test]
fn a_device_alone_returns_after_an_unplug_in_contact() {
    let mut session = Session::new(NAME, one());
    session.live(&["L1"]);
    session.force(0, [1.0, 0.0, 0.0], 0.0);
    session.until(|hands| hands[0].displayed[0] > 0.9);
    session.rig.fault(0, Fault::Unplug).expect("a fault");
    let before = session.wait(0, "Absent")[0].sequence;
    sleep_ms(300);
    // The hand goes on without a pose, at about the device's rate.
    let periods = session.hands()[0].sequence.wrapping_sub(before);
    assert!((150..600).contains(&periods), "{periods}");
    sleep_ms(1500);
    session.rig.fault(0, Fault::Replug).expect("a fault");
    // The tool touches still: no force before it is free and a button is pressed.
    session.wait(0, "Touching");
    session.force(0, [0.0; 3], 0.0);
    session.press(0);
    session.wait(0, "Live");
    session.stop().expect("an orderly end");
    judge::sound(&session.rig.log().expect("a log"), session.rig.setup());
}

#[test]
fn the_force_is_zero_before_a_driver_ends_the_process() {
    let mut setup = two();
    setup.driver.crash_on_disable = true;
    let mut session = Session::new(NAME, setup.clone());
    session.live(&["L1"]);
    session.force(0, [1.0, 0.0, 0.0], 0.0);
    session.until(|hands| hands[0].displayed[0] > 0.9);
    assert!(session.try_ask(&Command::Stop).is_none());
    assert!(!session.ended().success());
    let log = session.rig.log().expect("a log");
    assert_eq!(log.output_at(0, u64::MAX), ([0.0; 3], [0.0; 3]));
    assert_eq!(log.watchdogs(0).len(), 0);
    drop(session);
    let options = Options {
        variables: vec![("SULCUS_HD_KEEP_DEVICE", "1".into())],
        ..Options::default()
    };
    let mut session = Session::with(NAME, setup, &options);
    for _ in 0..2 {
        session.live(&["L1"]);
        session.stop().expect("an orderly end");
    }
    let log = session.rig.log().expect("a log");
    assert_eq!(
        log.times(0, |event| matches!(event, Event::Open { .. }))
            .len(),
        1
    );
    assert_eq!(
        log.times(0, |event| matches!(event, Event::Close { .. }))
            .len(),
        0
    );
}
