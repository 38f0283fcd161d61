//! Every exercise, every habit, both hands in the whole mouth: recorded, replayed bit for bit, also from a snapshot.

use std::collections::BTreeMap;

use serde_json::Value;
use sulcus_operator::Habit;
use sulcus_sessions::{Message, Recording};
use sulcus_tests::{Place, Program};

/// Performs in virtual time; the demo's own replay at its end must be identical.
pub fn perform(place: &Place, exercise: &str, seconds: &str, more: &[&str]) -> Value {
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

pub fn replay(place: &Place, files: &[&str], more: &[&str]) -> Value {
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
fn a_habit_of_the_hand_and_one_of_the_eye_act_and_replay() {
    act_and_replay(&[Habit::HeavyHand, Habit::Misreads]);
}

/// Performs with each habit, and well: each session replays, and the habit shows in it.
pub fn act_and_replay(habits: &[Habit]) {
    let place = Place::new();
    let mut good = BTreeMap::new();
    for &habit in habits {
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
