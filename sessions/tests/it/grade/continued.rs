//! A session that a stop of the station has divided into several recordings.

use std::path::{Path, PathBuf};

use sulcus_sessions::grade::{Grade, Options, grade, grade_session};
use sulcus_sessions::{
    Ending, Predecessor, Recording, ReplayOptions, SessionEnd, SessionHeader, StationKey, recover,
    replay,
};

use super::place::{Place, begun, record_with};
use crate::common::{BEGAN, key};

/// Length of the whole session, ticks.
const WHOLE: u64 = 3000;

/// The first part, torn as by kill -9: without its end, and in the middle of its last chunk.
fn torn(path: &Path, ticks: u64, change: impl Fn(&mut SessionHeader)) {
    drop(begun(path, 0..ticks, WHOLE, key(), |header, _| {
        change(header)
    }));
    let bytes = std::fs::read(path).unwrap();
    std::fs::write(path, &bytes[..bytes.len() - 40]).unwrap();
}

/// A part that continues the recording at `before`.
fn continued(
    path: &Path,
    before: &Path,
    part: std::ops::Range<u64>,
    key: StationKey,
    change: impl Fn(&mut SessionHeader),
) {
    let ticks = part.end - part.start;
    let recorder = begun(path, part, WHOLE, key, |header, _| {
        header.started_unix_ns = BEGAN + 9_000_000_000;
        header.predecessor = Some(Predecessor::of(before).unwrap());
        change(header);
    });
    let end = SessionEnd {
        ticks,
        ..SessionEnd::default()
    };
    recorder.finish(end).unwrap();
}

fn unchanged(_: &mut SessionHeader) {}

/// A folder with both parts of a session.
fn pair() -> (Place, PathBuf, PathBuf) {
    let place = Place::new();
    // The second part comes first by its name.
    let (first, second) = (place.path("b-first.mcap"), place.path("a-second.mcap"));
    torn(&first, 1800, unchanged);
    continued(&second, &first, 1800..WHOLE, key(), unchanged);
    (place, first, second)
}

fn graded(last: &Path, before: &[&Path]) -> Grade {
    let last = Recording::open(last).unwrap();
    let before: Vec<_> = before
        .iter()
        .map(|path| Recording::open(path).unwrap())
        .collect();
    let before: Vec<&Recording> = before.iter().collect();
    let graded = grade_session(&last, &before, &Options::default(), &mut |_| {});
    graded.unwrap().grade
}

fn refused(last: &Path, before: &[&Path]) -> String {
    let grade = graded(last, before);
    assert_eq!((grade.gradable, grade.score), (false, None));
    grade.reason.unwrap()
}

#[test]
fn both_parts_are_one_session_and_each_replays_by_itself() {
    let (place, first, second) = pair();
    let parts = [&first, &second].map(|path| Recording::open(path).unwrap());
    assert!(matches!(parts[0].ending(), Ending::CutOff { .. }));
    for part in &parts {
        let report = replay(part, &ReplayOptions::default(), &mut |_| {}).unwrap();
        assert!(report.identical && report.chain_ok, "{report:?}");
    }
    let rows = parts.iter().map(|part| part.facts().rows);
    assert!(rows.clone().sum::<u64>() + 200 >= WHOLE);
    let grade = graded(&second, &[&first]);
    assert!(grade.gradable, "{:?}", grade.reason);
    let ticks: Vec<u64> = grade.parts.iter().map(|part| part.ticks).collect();
    assert_eq!(ticks, rows.collect::<Vec<_>>());
    assert_eq!(grade.started_unix_ns, BEGAN);
    let gaps = grade.gaps.unwrap();
    assert_eq!((gaps.count, gaps.clock_ran), (1, false));
    let said = grade.reservations();
    let kinds: Vec<&str> = said.iter().map(|(kind, _)| *kind).collect();
    assert!(
        kinds.contains(&"continued after a stop of the station"),
        "{said:?}"
    );
    // The measures are those of the whole session in one recording, but for the tail and the way back to the hand.
    let whole = place.path("whole.mcap");
    record_with(&whole, WHOLE, key(), 0, |_, _| {});
    let whole = graded(&whole, &[]);
    assert!((grade.score.unwrap() - whole.score.unwrap()).abs() <= 1.0);
    for (ours, theirs) in grade.metrics.iter().zip(&whole.metrics) {
        let (a, b) = (ours.value.unwrap_or(0.0), theirs.value.unwrap_or(0.0));
        let near = (a - b).abs() <= 0.1 * b.abs().max(1.0);
        // The reach of the hand at the beginning of the second part is no move of the session.
        assert!(near || ours.name == "smoothness", "{}: {a} {b}", ours.name);
    }
}

#[test]
fn a_part_alone_gets_no_grade() {
    let (_place, first, second) = pair();
    let reason = refused(&second, &[]);
    assert!(
        reason.contains("continues b-first.mcap") && reason.contains("grade both together"),
        "{reason}"
    );
    assert!(refused(&first, &[]).contains("cut off"));
    // A grade of the part's own replay refuses it, too.
    let alone = grade(
        &Recording::open(&second).unwrap(),
        &Options::default(),
        &mut |_| {},
    );
    assert!(alone.unwrap().grade.score.is_none());
}

#[test]
fn only_the_very_file_that_is_named_is_the_first_part() {
    let (place, first, second) = pair();
    let other = place.path("other.mcap");
    // One byte less, or another session of the same learner.
    let bytes = std::fs::read(&first).unwrap();
    std::fs::write(&other, &bytes[..bytes.len() - 1]).unwrap();
    assert!(refused(&second, &[&other]).contains("expected the recording before it"));
    let other = place.path("another.mcap");
    torn(&other, 1700, unchanged);
    assert!(refused(&second, &[&other]).contains("expected the recording before it"));
    // What was recovered has other bytes, and its note is not signed.
    let (out, recording) = (
        place.path("recovered.mcap"),
        Recording::open(&first).unwrap(),
    );
    recover(&recording, &out, &mut |_| {}).unwrap();
    assert!(refused(&second, &[&out]).contains("expected the recording before it"));
    // The order is that of the session.
    assert!(refused(&first, &[&second]).contains("continues b-first.mcap"));
}

#[test]
fn both_parts_are_of_one_learner_one_exercise_and_one_station() {
    let place = Place::new();
    let (first, second) = (place.path("first.mcap"), place.path("second.mcap"));
    torn(&first, 1000, unchanged);
    type Change = fn(&mut SessionHeader);
    let changes: [(&str, Change); 4] = [
        ("learner", |header| header.learner_id = "b1".into()),
        ("exercise", |header| header.exercise.push('\n')),
        ("patient", |header| header.patient.push('x')),
        ("seed", |header| header.seed += 1),
    ];
    for (what, change) in changes {
        continued(&second, &first, 1000..WHOLE, key(), change);
        let reason = refused(&second, &[&first]);
        assert!(reason.starts_with(&format!("{what} differs")), "{reason}");
        std::fs::remove_file(&second).unwrap();
    }
    let other = StationKey::from_seed([3; 32]);
    continued(&second, &first, 1000..WHOLE, other, unchanged);
    assert!(refused(&second, &[&first]).starts_with("signer differs"));
}

#[test]
fn a_forged_first_part_is_found_out_by_its_own_replay() {
    let place = Place::new();
    let (first, second) = (place.path("first.mcap"), place.path("second.mcap"));
    let recorder = begun(&first, 0..1500, WHOLE, key(), |_, _| {});
    let end = SessionEnd {
        ticks: 1500,
        ..SessionEnd::default()
    };
    recorder.finish(end).unwrap();
    // Before the station names it, on the same machine: the replay still tells.
    let bytes = crate::common::with_messages(&std::fs::read(&first).unwrap(), |topic, data| {
        if topic == "/exact/ticks" && data[..8] == 700u64.to_le_bytes() {
            data[31] ^= 4;
        }
        true
    });
    std::fs::write(&first, bytes).unwrap();
    continued(&second, &first, 1500..WHOLE, key(), unchanged);
    let reason = refused(&second, &[&first]);
    assert!(reason.contains("differs from tick 700"), "{reason}");
}

#[test]
fn the_program_puts_the_parts_of_a_folder_together_in_any_order() {
    let (place, ..) = pair();
    for args in [
        &["grade", "a-second.mcap", "b-first.mcap", "--json"][..],
        &["grade", "b-first.mcap", "a-second.mcap", "--json"],
        &["grade", ".", "--json"],
    ] {
        let json = place.json(args);
        assert_eq!(json["file"], "a-second.mcap", "{args:?}");
        assert_eq!(json["parts"].as_array().unwrap().len(), 2, "{json}");
        assert!(json["score"].is_f64());
    }
    place.session();
    let json = place.json(&["grade", ".", "--json"]);
    assert_eq!(json["sessions"], 2);
    let (code, out, _) = place.run(&["grade", "a-second.mcap"]);
    assert_eq!(code, 1);
    assert!(out.contains("NO GRADE   the recording continues"), "{out}");
    let (code, out, _) = place.run(&["info", "a-second.mcap"]);
    assert_eq!(code, 0);
    assert!(out.contains("continues  b-first.mcap (blake3 "), "{out}");
    // A part by itself replays without a finding.
    assert_eq!(place.run(&["replay", "a-second.mcap"]).0, 0);
}

#[test]
fn a_second_stop_makes_a_third_part() {
    let place = Place::new();
    let [one, two, three] = ["1.mcap", "2.mcap", "3.mcap"].map(|name| place.path(name));
    torn(&one, 900, unchanged);
    let recorder = begun(&two, 900..1900, WHOLE, key(), |header, _| {
        header.predecessor = Some(Predecessor::of(&one).unwrap());
    });
    drop(recorder);
    continued(&three, &two, 1900..WHOLE, key(), unchanged);
    let grade = graded(&three, &[&one, &two]);
    assert!(grade.gradable, "{:?}", grade.reason);
    assert_eq!((grade.parts.len(), grade.gaps.unwrap().count), (3, 2));
    assert!(refused(&three, &[&two]).contains("continues 1.mcap"));
    assert_eq!(
        place.json(&["grade", ".", "--json"])["parts"][2]["ending"],
        "finished"
    );
}
