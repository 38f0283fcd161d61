//! Faults in use: the run goes on, the stage is the right one, and the force returns without a kick.

use std::fmt::Debug;

use sulcus_core::Vec3;
use sulcus_haptics::{Stage, Unready};
use sulcus_standin_haply::{BadNumber, Fault, Log, Omit, Options, Place, now_ns};

use crate::capture::warnings;
use crate::judged::judge_forces;
use crate::rig::Rig;

pub const ARM: &str = "049D";
pub const GRIP: &str = "61576";
pub const ABSENT: Stage = Stage::Unready(Unready::Absent);
pub const NO_POSE: Stage = Stage::Unready(Unready::NoPose);

pub fn id(id: &str) -> String {
    id.into()
}

pub fn start() -> Rig {
    let options = Options {
        watchdog_ms: 40.0,
        ..Options::default()
    };
    let rig = Rig::start(&options, &[ARM], Box::new(|_, _| Vec3::new(0.0, 0.8, 0.6)));
    rig.wait_live();
    rig.sleep(50);
    rig
}

/// Judges the log: sizes, changes, and rules of the protocol but for a second message to a silent service.
pub fn judge(log: &Log, what: &dyn Debug) {
    judge_stale(log, 0, what);
}

/// Judges a log in which a stall let some messages wait.
fn judge_stale(log: &Log, stale: usize, what: &dyn Debug) {
    judge_forces(log, ARM, stale, what);
    use sulcus_standin_haply::Violation::{AbsentDevice, Pipelined};
    let other: Vec<_> = log
        .violations()
        .into_iter()
        .filter(|(_, rule)| !matches!(rule, Pipelined | AbsentDevice))
        .collect();
    assert_eq!(other, [], "{what:?}");
}

/// A fault leads to `stage`; after its end the force returns. `warned` is the number of warnings.
pub fn leads_to(fault: Fault, end: Option<Fault>, stage: Stage, warned: usize) {
    let mut rig = start();
    let before = warnings().len();
    let t_ns = now_ns();
    rig.service.fault(fault.clone()).unwrap();
    let seen = || rig.stages_since(0, t_ns).contains(&stage);
    rig.wait(&format!("{stage:?} after {fault:?}"), seen);
    if let Some(end) = end {
        rig.sleep(100);
        assert_ne!(rig.stage(0), Stage::Live, "{fault:?}");
        rig.service.fault(end).unwrap();
    }
    rig.wait_live();
    rig.sleep(50);
    assert_eq!(rig.end(), Ok(()));
    let all = warnings();
    assert_eq!(all.len() - before, warned, "{fault:?}: {all:?}");
    let stale = if matches!(fault, Fault::Stall { .. }) {
        2
    } else {
        0
    };
    judge_stale(&rig.service.log().unwrap(), stale, &fault);
}

/// A fault changes nothing; a pause of the machine may take the force away once, but nothing is logged.
fn survives(fault: Fault) {
    let mut rig = start();
    let t_ns = now_ns();
    rig.service.fault(fault.clone()).unwrap();
    rig.sleep(150);
    let stages = rig.stages_since(0, t_ns);
    let paused = rig.seen(0).stages.len();
    assert!(
        stages.is_empty()
            || stages.iter().all(|stage| matches!(
                stage,
                Stage::Unready(Unready::NoPose) | Stage::Waiting | Stage::Rising | Stage::Live
            )),
        "{fault:?}: {stages:?} {paused}"
    );
    if !stages.is_empty() {
        println!("{fault:?}: {stages:?}");
    }
    rig.wait_live();
    assert_eq!(rig.end(), Ok(()));
    judge(&rig.service.log().unwrap(), &fault);
}

#[test]
fn a_stall_and_lost_replies_are_survived() {
    leads_to(Fault::Stall { ms: 60 }, None, NO_POSE, 1);
    leads_to(Fault::Silence { messages: 1 }, None, NO_POSE, 1);
    leads_to(Fault::Silence { messages: 4 }, None, NO_POSE, 1);
    leads_to(Fault::Stall { ms: 900 }, None, ABSENT, 2);
}

#[test]
fn bad_replies_of_a_moment_change_nothing() {
    survives(Fault::Malformed { replies: 5 });
    survives(Fault::Truncated { replies: 5 });
    survives(Fault::TwiceReply { replies: 50 });
    survives(Fault::TwiceDevice { replies: 50 });
    survives(Fault::DropEvents);
    for value in [
        BadNumber::Missing,
        BadNumber::Null,
        BadNumber::Text,
        BadNumber::NanWord,
        BadNumber::Overflow,
        BadNumber::Absurd(1e9),
    ] {
        for (device, place) in [
            (ARM, Place::Position),
            (ARM, Place::Velocity),
            (GRIP, Place::Orientation),
        ] {
            survives(Fault::BadNumber {
                device: device.into(),
                place,
                value,
                replies: 5,
            });
        }
    }
}

#[test]
fn parts_left_out_for_a_moment_change_nothing() {
    let array = |name: &str| Omit::Array(name.into());
    let whats = [
        Omit::Config,
        Omit::State,
        Omit::Status,
        array("inverse3"),
        array("wireless_verse_grip"),
        Omit::Field("cursor_position".into()),
        Omit::Field("current_cursor_force".into()),
        Omit::Device(ARM.into()),
    ];
    for what in whats {
        survives(Fault::Omit { what, replies: 5 });
    }
    survives(Fault::Omit {
        what: Omit::Status,
        replies: 2000,
    });
    survives(Fault::Event {
        name: id("device-battery-low"),
        level: id("warning"),
        device: id(GRIP),
    });
}

#[test]
fn bad_replies_for_long_take_the_pose_away() {
    leads_to(Fault::Malformed { replies: 400 }, None, NO_POSE, 0);
    leads_to(
        Fault::BadNumber {
            device: id(ARM),
            place: Place::Position,
            value: BadNumber::Null,
            replies: 400,
        },
        None,
        NO_POSE,
        0,
    );
    leads_to(
        Fault::BadNumber {
            device: id(GRIP),
            place: Place::Orientation,
            value: BadNumber::Absurd(50.0),
            replies: 400,
        },
        None,
        NO_POSE,
        0,
    );
    leads_to(
        Fault::Omit {
            what: Omit::Array(id("inverse3")),
            replies: 400,
        },
        None,
        NO_POSE,
        0,
    );
    leads_to(
        Fault::Omit {
            what: Omit::Device(id(ARM)),
            replies: 400,
        },
        None,
        ABSENT,
        0,
    );
}
