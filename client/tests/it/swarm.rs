//! A swarm of simulated hands on a server in its own process.
#![allow(clippy::unwrap_used)]

use std::collections::BTreeSet;
use std::process::Command;

#[test]
fn every_session_of_a_swarm_is_complete_and_replays_identical() {
    let folder = tempfile::tempdir().unwrap();
    let recordings = folder.path().join("recordings");
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
        .arg(&recordings)
        .output()
        .unwrap();
    let text = String::from_utf8(output.stdout).unwrap();
    let told = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{text}{told}");
    let swarm: serde_json::Value = serde_json::from_str(text.lines().last().unwrap()).unwrap();
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
        assert_eq!(session["rows_dropped"], 0, "{session}");
        assert!(session["ticks"].as_u64().unwrap() > 100, "{session}");
        assert!(
            recordings
                .join(session["recording"].as_str().unwrap())
                .exists()
        );
    }
}
