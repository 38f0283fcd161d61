//! Force Dimension: sessions that go well, and ways in which the force ends.

use sulcus_standins::Fault;
use sulcus_standins::board::Call;
use sulcus_standins::log::{Closed, Event};
use sulcus_standins::pose::Pose;
use sulcus_standins::setup::{DeviceSetup, Hand, Motion, Setup};

use crate::commands::Command;
use crate::hd::{FRAMES, wait_for};
use crate::judge::{self, Steps, ZERO_WITHIN};
use crate::session::{Options, Session, sleep_ms};

pub const NAME: &str = "forcedimension";

/// An omega.6 and a sigma.7 at different places.
pub fn two() -> Setup {
    let left = Pose::at([0.01, 0.02, 0.03]).turned([1.0, 0.0, 0.0], 0.5);
    let right = Pose::at([-0.02, 0.01, -0.01]);
    Setup::new(vec![
        DeviceSetup::omega6(1234).with_hand(Hand::rest(left)),
        DeviceSetup::sigma7(77).with_hand(Hand::rest(right)),
    ])
}

pub fn one() -> Setup {
    Setup::new(two().devices.into_iter().take(1).collect())
}

#[test]
fn each_hand_feels_its_own_force_at_four_kilohertz() {
    let mut session = Session::new(NAME, two());
    let opened = session.start(&["77", "1234"]);
    assert_eq!((opened[0].dof, opened[1].dof), ([7, 3, 3], [6, 3, 0]));
    assert!(opened.iter().all(|one| one.period_ns == 250_000));
    for at in 0..2 {
        session.press(at);
        session.wait(at, "Live");
    }
    // To the right: y of the library. Up: z of the library.
    session.force(0, [1.2, 0.0, 0.0], 0.4);
    session.force(1, [0.0, 0.7, 0.0], 0.4);
    assert_eq!(session.number(&Command::Watch("dhd-".into())), 2);
    wait_for(&session, FRAMES);
    assert_eq!(
        session.number(&Command::Counted),
        0,
        "allocations in the loop"
    );
    let hands = session.hands();
    let near =
        |found: [f64; 3], wanted: [f64; 3]| (0..3).all(|i| (found[i] - wanted[i]).abs() < 2e-4);
    assert!(near(hands[0].position, [0.01, -0.01, -0.02]), "{hands:?}");
    assert!(near(hands[1].position, [0.02, 0.03, 0.01]), "{hands:?}");
    // About the library's x, which points toward the person.
    let turn = [0.25f64.cos(), 0.0, 0.0, 0.25f64.sin()];
    for (found, wanted) in hands[1].orientation.iter().zip(turn) {
        assert!((found - wanted).abs() < 5e-3, "{hands:?}");
    }
    session.stop().expect("an orderly end");
    let log = session.rig.log().expect("a log");
    judge::sound(&log, session.rig.setup());
    let [left, right] = [log.largest_axes(0), log.largest_axes(1)];
    assert!(
        left[2] > 0.9 && left[0] == 0.0 && left[1] == 0.0,
        "{left:?}"
    );
    assert!(
        right[1] > 1.5 && right[0] == 0.0 && right[2] == 0.0,
        "{right:?}"
    );
    for (device, sets) in [(0, 1), (1, 3)] {
        let median = log.median_interval(device);
        assert!((200_000..320_000).contains(&median), "{median}");
        assert!(log.commands(device).iter().all(|(_, c)| c.sets == sets));
        ended_in_order(&log, device);
        let watchdog = log.times(device, |event| {
            matches!(event, Event::Call { call: Call::Watchdog, value, .. } if (1.0..=160.0).contains(value))
        });
        assert_eq!(watchdog.len(), 1);
    }
}

/// Asserts zero commands for 30 ms, then the stop and the close.
fn ended_in_order(log: &sulcus_standins::Log, device: usize) {
    let last = log.last_force(device).unwrap_or(0);
    let end = log.commands(device).last().expect("a command").0;
    assert!(
        end - last >= 30_000_000,
        "{} ns without a force",
        end - last
    );
    let stops = log.times(device, |event| {
        matches!(
            event,
            Event::Call {
                call: Call::Stop,
                ..
            }
        )
    });
    let closes = log.times(device, |event| {
        matches!(
            event,
            Event::Close {
                way: Closed::Call,
                ..
            }
        )
    });
    assert!(stops.last() > Some(&last) && closes.last() > stops.last());
    assert_eq!(log.output_at(device, u64::MAX), ([0.0; 3], [0.0; 3]));
}

#[test]
fn a_falcon_has_three_axes_and_one_kilohertz() {
    let middle = Pose::default();
    let hand = Hand::exact(Motion::Sine {
        middle,
        amplitude: [0.01, 0.0, 0.0],
        turn: [0.0; 3],
        hz: 0.5,
    });
    let mut session = Session::new(
        NAME,
        Setup::new(vec![DeviceSetup::falcon(9).with_hand(hand)]),
    );
    let opened = session.start(&["9"]);
    assert_eq!((opened[0].dof, opened[0].period_ns), ([3, 3, 0], 1_000_000));
    session.press(0);
    session.wait(0, "Live");
    session.force(0, [0.0, 0.0, 1.0], 0.0);
    sleep_ms(1000);
    let log = session.rig.log().expect("a log");
    assert!((900_000..1_100_000).contains(&log.median_interval(0)));
    assert!(
        (log.largest_axes(0)[0] - 1.0).abs() < 0.05,
        "toward the person"
    );
    session.stop().expect("an orderly end");
}

#[test]
fn the_list_names_the_devices_and_moves_none() {
    let mut session = Session::new(NAME, two());
    let items = session.list();
    let serials: Vec<_> = items.iter().map(|item| item.serial.as_str()).collect();
    assert_eq!(serials, ["1234", "77"], "{items:?}");
    assert!(items.iter().all(|item| item.state == "Ready"), "{items:?}");
    assert_eq!((items[0].dof, items[1].dof), ([6, 3], [7, 6]));
    let log = session.rig.log().expect("a log");
    assert_eq!(log.frames(0) + log.frames(1), 0);
    let error = session.open(&["99"]).expect_err("unknown");
    assert!(error.contains("99") && error.contains("1234"), "{error}");
    session.rig.fault(0, Fault::OpenError(20)).expect("a fault");
    let items = session.list();
    assert_eq!(items[0].state, "InUse", "{items:?}");
    assert!(items[0].message.contains("another program"), "{items:?}");
    session.rig.fault(0, Fault::OpenError(0)).expect("a fault");
    for _ in 0..2 {
        session.live(&["1234"]);
        assert_eq!(session.list()[0].state, "InUse");
        session.stop().expect("an orderly end");
    }
}

#[test]
fn the_force_is_zero_twenty_milliseconds_after_the_last_order() {
    let mut session = Session::new(NAME, one());
    session.live(&["1234"]);
    session.force(0, [1.5, 1.0, 0.0], 0.0);
    session.until(|hands| hands[0].displayed[0] > 1.4);
    let last = session.number(&Command::Silence(true));
    sleep_ms(200);
    let log = session.rig.log().expect("a log");
    let force = log.last_force(0).expect("a force");
    let after = force.saturating_sub(last);
    println!("last force {after} ns after the last order");
    assert!(after <= 25_000_000, "{after} ns");
    session.ask(&Command::Silence(false));
    session.until(|hands| hands[0].displayed[0] > 1.4);
    judge::sound(&session.rig.log().expect("a log"), session.rig.setup());
}

#[test]
fn a_killed_client_leaves_no_force() {
    let mut session = Session::new(NAME, one());
    session.live(&["1234"]);
    session.force(0, [1.5, 0.0, 0.0], 0.0);
    session.until(|hands| hands[0].displayed[0] > 1.4);
    session.kill();
    sleep_ms(200);
    let log = session.rig.log().expect("a log");
    let zero = log.last_command_to_zero(0).expect("zero");
    assert!(zero < ZERO_WITHIN, "{zero} ns");
    // The watchdog of the controller brakes; the next session turns the force on again.
    session.again(NAME, &Options::default());
    session.live(&["1234"]);
    session.stop().expect("an orderly end");
}
