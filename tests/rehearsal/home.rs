//! The student at home: a line of a home, ticks at the hand.

use std::path::Path;
use std::time::Duration;

use serde_json::Value;
use sulcus_connection::instructor::Instructor;
use sulcus_proto::control::Instruction;
use sulcus_proto::station::Phase;
use sulcus_relay::{Network, Relay};

use crate::{Class, HOME, ended, until};

/// Lag of the recording behind the hand that is more than a line of a home causes, milliseconds.
const FAR_BEHIND_MS: u32 = 2000;

/// Performs a session at home. The instructor pauses it, and the line is cut for a moment.
pub fn perform(class: &Class, instructor: &mut Instructor) {
    let (name, ..) = HOME;
    let server = class.address.parse().expect("an address");
    let relay = Relay::through(Network::HomeDsl, server, 5).expect("a relay");
    let student = class.at_home(&relay.address().to_string());
    until(instructor, name, "ticks at the hand", |at| {
        at.phase == Phase::Running && at.tick > 3000 && at.behind_ms.is_some()
    });
    let paused = instructor
        .instruct(name, Instruction::Pause)
        .expect("an answer");
    assert!(paused.taken && paused.tick > 0, "{paused:?}");
    until(instructor, name, "a hand without force", |at| {
        at.paused && at.tick > paused.tick + 500
    });
    let resumed = instructor
        .instruct(name, Instruction::Resume)
        .expect("an answer");
    assert!(resumed.taken && resumed.tick > paused.tick, "{resumed:?}");
    relay.cut(true);
    std::thread::sleep(Duration::from_millis(1500));
    relay.cut(false);
    let cut = resumed.tick + 1500;
    until(instructor, name, "the ticks of the outage", |at| {
        at.tick > cut && at.behind_ms.is_some_and(|ms| ms < FAR_BEHIND_MS)
    });
    let said = ended(instructor, name, student).json();
    assert!(
        said["link"]["bytes_per_tick"].as_f64() > Some(1.0),
        "{said}"
    );
    assert_eq!(said["session"]["complete"], true, "{said}");
}

/// The recording of the session at home replays identically, has a grade, and names its ticks.
pub fn check(class: &Class, recording: &Path) {
    let name = recording.to_str().expect("plain");
    let replay: Value = class.sessions(&["replay", name, "--json"]).json();
    assert_eq!(replay["gradable"], true, "{replay}");
    let grade: Value = class.sessions(&["grade", name, "--json"]).json();
    assert_eq!(grade["learner_id"], Value::from(HOME.1), "{grade}");
    assert!(grade["score"].is_f64(), "{grade}");
}
