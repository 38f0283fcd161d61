//! OpenHaptics: two hands in a session that goes well.

use sulcus_standins::board::Call;
use sulcus_standins::log::{Closed, Event};
use sulcus_standins::pose::Pose;
use sulcus_standins::setup::{DeviceSetup, Hand, Setup};

use crate::commands::Command;
use crate::judge::{self, Steps};
use crate::session::{Session, sleep_ms};

pub const NAME: &str = "openhaptics";

/// A Touch for the left hand and a Touch X for the right, at different places.
pub fn two() -> Setup {
    let left = Pose::at([-0.02, 0.01, 0.03]).turned([0.3, 1.0, -0.2], 0.7);
    let right = Pose::at([0.03, -0.02, 0.01]);
    Setup::new(vec![
        DeviceSetup::touch("Left Device", "L1").with_hand(Hand::rest(left)),
        DeviceSetup::touch_x("Right Device", "R1").with_hand(Hand::rest(right)),
    ])
}

pub fn one() -> Setup {
    Setup::new(two().devices.into_iter().take(1).collect())
}

/// Number of frames of the cross-check. The session in the whole mouth compares more of them.
pub const FRAMES: usize = 20_000;

#[test]
fn each_hand_feels_its_own_force() {
    let mut session = Session::new(NAME, two());
    // The order of the ports is that of the serial numbers, not that of the library.
    let opened = session.start(&["R1", "Left Device"]);
    assert_eq!(
        (opened[0].serial.as_str(), opened[1].serial.as_str()),
        ("R1", "L1")
    );
    assert_eq!(opened[0].model, "Touch X");
    assert_eq!(opened[0].reported, [Some(7.9), Some(1.75), Some(1860.0)]);
    assert_eq!(opened[1].reported, [Some(3.3), Some(0.88), Some(500.0)]);
    assert_eq!(opened[1].dof, [6, 3, 0]);
    for at in 0..2 {
        session.press(at);
        session.wait(at, "Live");
    }
    session.force(0, [1.2, 0.0, 0.0], 0.4);
    session.force(1, [0.0, 0.7, 0.0], 0.4);
    assert_eq!(session.number(&Command::Watch("standin-hd".into())), 1);
    let wanted = FRAMES;
    let began = session.rig.log().expect("a log").frames(0);
    while session.rig.log().expect("a log").frames(0) < began + wanted {
        sleep_ms(1000);
    }
    assert_eq!(
        session.number(&Command::Counted),
        0,
        "allocations in the callback"
    );
    let hands = session.hands();
    let near =
        |found: [f64; 3], wanted: [f64; 3]| (0..3).all(|i| (found[i] - wanted[i]).abs() < 2e-4);
    assert!(near(hands[0].position, [0.03, -0.02, 0.01]), "{hands:?}");
    assert!(near(hands[1].position, [-0.02, 0.01, 0.03]), "{hands:?}");
    let turned = session.rig.setup().devices[0].hand.clone();
    let sulcus_standins::setup::Motion::Rest(pose) = turned.motion else {
        panic!("at rest");
    };
    for i in 0..4 {
        assert!(
            (hands[1].orientation[i] - pose.rotation[i]).abs() < 5e-3,
            "{hands:?}"
        );
    }
    assert_eq!((hands[0].trips, hands[1].trips), (0, 0));
    session.stop().expect("an orderly end");
    let log = session.rig.log().expect("a log");
    judge::sound(&log, session.rig.setup());
    // Device 0 is the left one, hand 1.
    let [left, right] = [log.largest_axes(0), log.largest_axes(1)];
    assert!(
        left[1] > 0.9 && left[0] == 0.0 && left[2] == 0.0,
        "{left:?}"
    );
    assert!(
        right[0] > 1.5 && right[1] == 0.0 && right[2] == 0.0,
        "{right:?}"
    );
    for device in 0..2 {
        let median = log.median_interval(device);
        assert!((900_000..1_100_000).contains(&median), "{median}");
        assert!(log.commands(device).iter().all(|(_, c)| c.sets <= 1));
        ended_in_order(&log, device);
    }
    let calls = |wanted: Call| {
        let of = |e: &&sulcus_standins::log::Entry| matches!(e.event, Event::Call { call, .. } if call == wanted);
        log.entries.iter().filter(of).count()
    };
    assert_eq!(calls(Call::StartScheduler), 1);
    assert_eq!(calls(Call::StopScheduler), 1);
    // The callback, and the end of the output of force.
    assert_eq!(calls(Call::Schedule), 2);
}

/// Waits until the first device has had so many commands more.
pub fn wait_for(session: &Session, frames: usize) {
    let commands = || session.rig.snapshot(0).expect("a state").commands;
    let end = commands() + frames as u64;
    while commands() < end {
        sleep_ms(200);
    }
}

/// Asserts thirty zero commands, then no output, then the close.
pub fn ended_in_order(log: &sulcus_standins::Log, device: usize) {
    let last = log.last_force(device).unwrap_or(0);
    let zeros = log
        .commands(device)
        .iter()
        .filter(|(at, _)| *at > last)
        .count();
    assert!(zeros >= 30, "{zeros} commands without a force");
    let off = log.times(device, |event| {
        matches!(event, Event::Call { call: Call::Disable, value, .. } if *value == f64::from(0x4000))
    });
    let closed = log.times(device, |event| {
        matches!(
            event,
            Event::Close {
                way: Closed::Call,
                ..
            }
        )
    });
    let (Some(off), Some(closed)) = (off.last(), closed.last()) else {
        panic!("no output off or no close of device {device}");
    };
    assert!(last < *off && off < closed);
    assert_eq!(log.output_at(device, u64::MAX), ([0.0; 3], [0.0; 3]));
    assert_eq!(log.watchdogs(device).len(), 0);
}

#[test]
fn a_premium_displays_torque_and_a_touch_does_not() {
    let setup = Setup::new(vec![DeviceSetup::premium("Premium", "P1")]);
    let mut session = Session::new(NAME, setup);
    let opened = session.start(&["P1"]);
    assert_eq!(opened[0].dof, [6, 3, 3]);
    session.press(0);
    session.wait(0, "Live");
    session.force(0, [0.0, 0.0, 1.0], 0.0);
    sleep_ms(300);
    let log = session.rig.log().expect("a log");
    assert!(log.commands(0).iter().all(|(_, c)| c.sets == 2));
    assert!((log.output_at(0, u64::MAX).0[2] - 1.0).abs() < 1e-6);
    session.stop().expect("an orderly end");
}

#[test]
fn a_session_runs_again_in_the_same_process() {
    let mut session = Session::new(NAME, one());
    for _ in 0..3 {
        session.live(&["L1"]);
        assert_eq!(session.list()[0].state, "InUse");
        assert!(session.open(&["L1"]).is_err());
        session.stop().expect("an orderly end");
        assert_eq!(session.list()[0].state, "Ready");
    }
    let log = session.rig.log().expect("a log");
    assert_eq!(
        log.times(0, |event| matches!(event, Event::Open { .. }))
            .len(),
        3
    );
    judge::sound(&log, session.rig.setup());
}

#[test]
fn the_button_of_the_stylus_starts_the_force() {
    let mut session = Session::new(NAME, one());
    session.start(&["L1"]);
    session.wait(0, "Waiting");
    session
        .rig
        .fault(0, sulcus_standins::Fault::Buttons(2))
        .expect("a fault");
    let hands = session.wait(0, "Rising");
    assert_eq!(hands[0].buttons & 2, 2);
    session.stop().expect("an orderly end");
}
