//! Every exercise, every habit, both hands in the whole mouth: recorded, replayed bit for bit, also from a snapshot.

use std::collections::BTreeMap;

use serde_json::Value;
use sulcus_operator::Habit;
use sulcus_sessions::{Message, Recording};
use sulcus_tests::{Place, Program};

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
        .run(Program::Client, &[&arguments[..], more].concat())
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
    place.run(Program::Sessions, &arguments).ok().json()
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

/// Where a habit shows: exercise and seconds. What it does differently it does by then.
fn shows(habit: Habit) -> (&'static str, &'static str) {
    match habit {
        // Within the first zones; misreads in what is called.
        Habit::HeavyHand
        | Habit::WrongAngle
        | Habit::Impatient
        | Habit::SpotProbes
        | Habit::StopsShort
        | Habit::Misreads => ("probing", "12"),
        // Behind the first zones; and half-way through the tour.
        Habit::SkipsSites | Habit::LetsTongueGo => ("bimanual", "36"),
    }
}

/// What a performance came to: the hash after its last tick, and the readings that were called.
fn came_to(place: &Place, demo: &Value) -> (u64, Vec<String>) {
    let file = demo["recording"].as_str().expect("a path");
    let recording = Recording::open(&place.path(file)).expect("it opens");
    let (mut hash, mut called) = (None, Vec::new());
    for message in recording.messages() {
        match message.expect("a message") {
            Message::Row(row) => hash = Some(row.hash),
            Message::Event(event) if event.text.starts_with("reading_called") => {
                called.push(event.text);
            }
            _ => {}
        }
    }
    (hash.expect("a row"), called)
}

#[test]
fn every_habit_acts_and_replays() {
    let place = Place::new();
    let mut good = BTreeMap::new();
    for habit in Habit::ALL {
        let (exercise, seconds) = shows(habit);
        let good = good
            .entry((exercise, seconds))
            .or_insert_with(|| came_to(&place, &perform(&place, exercise, seconds, &[])));
        let bad = perform(&place, exercise, seconds, &["--habit", habit.name()]);
        let bad = came_to(&place, &bad);
        if habit == Habit::Misreads {
            // The hand is the good one's: he says another number.
            assert_eq!(bad.0, good.0, "{habit:?}");
            assert_ne!(bad.1, good.1, "{habit:?}");
            assert_eq!(bad.1.len(), good.1.len(), "{habit:?}");
        } else {
            assert_ne!(bad.0, good.0, "{habit:?}");
        }
    }
}

#[test]
fn a_replay_is_many_times_as_fast_as_the_session() {
    let place = Place::new();
    // What is promised is 10 and 4 times on a core of its own; found are 25 and 21 beside other work. Half is asked here, where nobody
    // knows what else the machine does: enough to see a replay that became some times slower.
    for (exercise, seconds, least) in [("probing", "12", 5.0), ("bimanual", "20", 2.0)] {
        let demo = perform(&place, exercise, seconds, &[]);
        let file = demo["recording"].as_str().expect("a path");
        // The best of three: others may have the processor meanwhile.
        let factors = [(); 3].map(|()| {
            let report = replay(&place, &[file], &["--jobs", "1"]);
            report["realtime_factor"].as_f64().expect("a number")
        });
        let best = factors.into_iter().fold(0.0, f64::max);
        assert!(best >= least, "{exercise}: {factors:?}, expected {least}");
    }
}
