//! Every exercise, every habit, both hands in the whole mouth: recorded, replayed bit for bit, also from a snapshot.

use serde_json::Value;
use sulcus_tests::{Place, Program};

const HABITS: [&str; 7] = [
    "heavy-hand",
    "wrong-angle",
    "skips-sites",
    "impatient",
    "spot-probes",
    "misreads",
    "lets-tongue-go",
];

/// Performs in virtual time, in release; the demo's own replay at its end must be identical.
fn perform(place: &Place, exercise: &str, seconds: &str, more: &[&str]) -> Value {
    let arguments = [
        "demo",
        "--virtual",
        "--exercise",
        exercise,
        "--duration",
        seconds,
        "--json",
    ];
    let demo = place
        .run_path(
            Program::Client.release_path(),
            &[&arguments[..], more].concat(),
        )
        .ok()
        .json();
    assert_eq!(
        (&demo["identical"], &demo["gradable"]),
        (&true.into(), &true.into()),
        "{exercise} {more:?}: {demo}"
    );
    demo
}

fn replay(place: &Place, files: &[&str], more: &[&str]) -> Value {
    let arguments = [&["replay", "--json"], more, files].concat();
    place
        .run_path(Program::Sessions.release_path(), &arguments)
        .ok()
        .json()
}

#[test]
fn every_exercise_replays_whole_and_from_a_snapshot() {
    let place = Place::new();
    // A little over a snapshot's ten seconds.
    let demos = ["crown", "probing", "retraction", "bimanual"]
        .map(|exercise| perform(&place, exercise, "11", &[]));
    let files: Vec<&str> = demos
        .iter()
        .map(|demo| demo["recording"].as_str().expect("a path"))
        .collect();
    // All of them at once, on however many cores there are.
    let all = replay(&place, &files, &[]);
    assert_eq!(
        (&all["identical"], &all["ticks"]),
        (&true.into(), &44_000.into()),
        "{all}"
    );
    let parts = replay(&place, &files, &["--from", "10.5", "--to", "10.9"]);
    assert_eq!(
        (&parts["identical"], &parts["ticks"]),
        (&true.into(), &(4 * 900).into()),
        "{parts}"
    );
    for part in parts["files"].as_array().expect("files") {
        assert_eq!(part["part"]["snapshot_tick"], 10_000, "{part}");
    }
    // The mouth with both hands, in the other build.
    let bimanual = files[3];
    let debug = place
        .run(
            Program::Sessions,
            &["replay", "--json", "--from", "10.2", "--to", "11", bimanual],
        )
        .ok()
        .json();
    assert_eq!(debug["identical"], true, "{debug}");
    assert_eq!(debug["replayed_by"]["build"], "debug");
    assert_eq!(debug["recorded_by"]["build"], "release");
}

#[test]
fn every_habit_replays() {
    let place = Place::new();
    for habit in HABITS {
        perform(&place, "bimanual", "5", &["--habit", habit]);
    }
}
