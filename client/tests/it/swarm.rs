//! A swarm of simulated hands on a server in its own process.
#![allow(clippy::unwrap_used)]

use std::collections::BTreeSet;
use std::path::Path;
use std::process::{Command, ExitStatus};

use crate::common::until;

/// Runs three stations, one of them with leaps, with recordings in `folder`. Returns the exit status of the program,
/// its object of JSON and all its lines.
fn swarm(folder: &Path) -> (ExitStatus, serde_json::Value, String) {
    let output = Command::new(env!("CARGO_BIN_EXE_sulcus-client"))
        .args([
            "swarm",
            "--stations",
            "3",
            "--leaps",
            "1",
            "--duration",
            "2",
        ])
        .args(["--exercise", "crown", "--replay", "--json", "--recordings"])
        .arg(folder)
        .output()
        .unwrap();
    let said = String::from_utf8(output.stdout).unwrap();
    let lines = format!("{said}{}", String::from_utf8_lossy(&output.stderr));
    let last = said.lines().last().unwrap_or_default();
    let swarm = serde_json::from_str(last).unwrap_or_else(|error| panic!("{error}: {lines}"));
    (output.status, swarm, lines)
}

#[test]
fn every_session_of_a_swarm_is_complete_and_replays_identical() {
    let folder = tempfile::tempdir().unwrap();
    let recordings = folder.path().join("recordings");
    let mut ended = None;
    // A recorder that a busy machine keeps from its core for seconds loses rows: another run then decides.
    until("a swarm whose recordings have all rows", || {
        let (status, swarm, lines) = swarm(&recordings);
        println!("{lines}");
        let mut sessions = swarm["sessions"].as_array().unwrap().iter();
        let is_whole = sessions.all(|session| session["rows_dropped"] == 0);
        ended = Some((status, swarm, lines));
        is_whole
    });
    let (status, swarm, lines) = ended.unwrap();
    assert!(status.success(), "{lines}");
    assert_eq!(swarm["stations"], 3);
    assert_eq!(swarm["not_identical"], 0);
    let sessions = swarm["sessions"].as_array().unwrap();
    let names: BTreeSet<_> = sessions
        .iter()
        .map(|session| session["recording"].as_str().unwrap())
        .collect();
    assert_eq!(names.len(), 3, "{names:?}");
    for session in sessions {
        assert_eq!(session["complete"], true, "{session}");
        let count = |name: &str| session[name].as_u64().unwrap();
        assert!(count("ticks") > 0, "{session}");
        assert!(count("ticks") + count("skipped") > 100, "{session}");
        assert!(
            recordings
                .join(session["recording"].as_str().unwrap())
                .exists()
        );
    }
}
