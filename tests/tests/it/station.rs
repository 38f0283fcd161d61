//! What a station offers: an exercise with its scene and rubric, so that what it records can be graded.

use std::io::Write as _;
use std::process::Stdio;

use sulcus_tests::{Ended, Place, Program, Serving, signal};

use crate::viewers::{lines, until};

fn join(place: &Place, server: &Serving, more: &[&str]) -> Ended {
    place.perform(server, &[&["--duration", "3"], more].concat())
}

/// The two commands of the README: their recording had been one of exercise `free`, which nobody grades.
#[test]
fn what_two_commands_record_is_graded() {
    let place = Place::new();
    let server = place.serve(&[]);
    join(&place, &server, &[]).ok();
    let file = place.recording();
    let grade = ["grade", file.to_str().expect("plain"), "--json"];
    let grade = place.run(Program::Sessions, &grade).json();
    assert_eq!(grade["exercise"], "crown", "{grade}");
    assert!(grade["score"].as_f64().is_some(), "{grade}");
    // Who performs something else is told what is offered.
    join(&place, &server, &["--exercise", "probing"]).refused(&["`probing`", "`crown`"]);
}

/// Which mode a session was in was a word of whoever graded it.
#[test]
fn an_exam_is_one_because_the_station_says_so() {
    let place = Place::new();
    let server = place.serve(&["--mode", "exam"]);
    join(&place, &server, &[]).ok();
    let file = place.recording();
    let file = file.to_str().expect("plain");
    // Graded on the station itself, whose key is the trusted one then.
    let grade = place
        .run(Program::Sessions, &["grade", file, "--json"])
        .ok()
        .json();
    assert_eq!(
        (&grade["mode"], &grade["recorded_mode"]),
        (&"exam".into(), &"exam".into())
    );
    assert_eq!(grade["signer_trusted"], true, "{grade}");
    assert!(
        grade["advice"].is_null() && grade["score"].is_f64(),
        "{grade}"
    );
    place
        .run(Program::Sessions, &["grade", file, "--truth"])
        .refused(&["--truth is given", "expected outside of exams"]);
    let info = place
        .run(Program::Sessions, &["info", file, "--json"])
        .ok()
        .json();
    assert_eq!(info["mode"], "exam", "{info}");
}

/// An exercise brings its scene; a station that asks for nothing takes whatever is performed.
#[test]
fn an_exercise_brings_its_scene_and_a_free_station_takes_any() {
    for offered in ["probing", "free"] {
        let place = Place::new();
        let pocket = concat!(env!("CARGO_MANIFEST_DIR"), "/../server/scenes/pocket.toml");
        let serve = match offered {
            "free" => &["--scene", pocket][..],
            offered => &["--exercise", offered],
        };
        let server = place.serve(serve);
        join(&place, &server, &["--exercise", "probing"]).ok();
        let file = place.recording();
        let grade = ["grade", file.to_str().expect("plain"), "--json"];
        let grade = place.run(Program::Sessions, &grade).json();
        assert_eq!(grade["exercise"], offered, "{grade}");
        assert_eq!(grade["gradable"], offered != "free", "{grade}");
    }
}

/// A mistyped exercise had been served as one that asks for nothing, and by a rubric that weighs what nobody asked for a session had
/// 100 points of 100.
#[test]
fn what_cannot_be_offered_or_graded_is_refused_at_the_start() {
    let place = Place::new();
    let serve = |more: &[&str]| {
        let serve = ["serve", "--listen", "127.0.0.1:0"];
        place.run(Program::Server, &[&serve[..], more].concat())
    };
    serve(&["--exercise", "bimanaul"]).refused(&["bimanaul", "bimanual", "free"]);
    let rubric = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../sessions/rubrics/probing.toml"
    );
    serve(&["--exercise", "free", "--rubric", rubric]).refused(&["--rubric", "free"]);
    serve(&["--exercise", "crown", "--rubric", rubric]).refused(&[
        "`probing`",
        "exercise `crown`",
        "zones to probe",
    ]);
    let file = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../sessions/tests/corpus/hard-wedge.mcap"
    );
    let grade = ["grade", file, "--rubric", rubric, "--json"];
    let grade = place.run(Program::Sessions, &grade);
    assert_eq!(grade.code, 1, "{grade:#?}");
    let grade = grade.json();
    assert_eq!(grade["score"], serde_json::Value::Null, "{grade}");
    assert_eq!(grade["gradable"], false, "{grade}");
    assert!(
        grade["reason"]
            .as_str()
            .is_some_and(|why| why.contains("zones to probe")),
        "{grade}"
    );
}

/// An error that named neither the exercise nor how to choose another.
#[test]
fn an_exercise_that_a_scene_has_nothing_for_is_named() {
    let place = Place::new();
    let crown = concat!(env!("CARGO_MANIFEST_DIR"), "/../server/scenes/crown.toml");
    place
        .run(Program::Client, &["demo", "--virtual", "--scene", crown])
        .refused(&["exercise `bimanual`", "scene `crown`", "--exercise"]);
    // The cause of an error is said, too.
    let export = ["info", "absent.mcap"];
    place
        .run(Program::Sessions, &export)
        .refused(&["absent.mcap", "No such file"]);
}

/// Only the simulated operator could call a reading: a person at a device had no way to.
#[test]
fn what_a_person_types_is_called() {
    let place = Place::new();
    let server = place.serve(&["--exercise", "probing"]);
    let mut client = place
        .command(Program::Client.path())
        .args(["run", "--server", &server.address])
        .args(["--ticket", &server.ticket, "--exercise", "probing"])
        .args(["--readings", "--learner", "a7f3", "--tick", "server"])
        .args(["--duration", "600", "--json"])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the client starts");
    let mut typed = client.stdin.take().expect("piped");
    typed
        .write_all(b"36 MB 5 -2 b\nnonsense\n36 b 3 nb f1\n")
        .expect("it reads");
    drop(typed);
    let file = place.begun("recordings");
    until(&file, "two called readings", |recording| {
        let lines = lines(recording);
        let calls = lines.iter().filter(|line| line.starts_with("reading"));
        calls.count() == 2
    });
    signal("-INT", &client);
    let ended = Ended::new(client.wait_with_output().expect("it ends"));
    assert!(
        ended.stderr.contains("not taken: the site is missing"),
        "{ended:#?}"
    );
    ended.ok();
    let file = place.recording();
    let file = file.to_str().expect("plain");
    let grade = place
        .run(Program::Sessions, &["grade", file, "--json"])
        .json();
    assert_eq!(grade["learner_id"], "a7f3");
    let called: Vec<_> = grade["sites"]
        .as_array()
        .expect("sites")
        .iter()
        .filter(|site| !site["called_mm"].is_null())
        .map(|site| {
            (
                site["site"].clone(),
                site["called_mm"].clone(),
                site["furcation_called"].clone(),
            )
        })
        .collect();
    assert_eq!(
        called,
        // (In the order of the exercise.)
        [
            ("buccal".into(), 3.into(), 1.into()),
            ("mesiobuccal".into(), 5.into(), serde_json::Value::Null),
        ],
        "{grade}"
    );
}

/// A class's names went into recordings where an id was asked for.
#[test]
fn a_learner_is_an_id_and_no_name() {
    let place = Place::new();
    for program in [
        &["demo", "--learner", "Jane Doe"][..],
        &["demo", "--learner", "jane"],
    ] {
        let ended = place.run(Program::Client, program);
        ended.refused(&["--learner", "opaque id", "a7f3"]);
    }
}
