//! What gets a grade and what gets none, from outside: recordings forged, cut off and incomplete; rubrics; what an instructor
//! says; the program.
#![allow(clippy::unwrap_used)]

mod common;

use std::path::{Path, PathBuf};
use std::process::Command;

use common::{BEGAN, input, key, with_messages};
use serde_json::Value;
use sulcus_core::scene::Band;
use sulcus_core::{NoProbe, State, Workspace, tick};
use sulcus_sessions::grade::report::Source;
use sulcus_sessions::grade::revision::{Revision, Sidecar, beside};
use sulcus_sessions::grade::{Grade, Options, grade};
use sulcus_sessions::{
    Exercise, Level, Mode, Recorder, Recording, Row, Rubric, SessionEnd, SessionHeader, StationKey,
};

/// A session of the crown exercise in which a rod sweeps over balls for `ticks` ticks.
fn record(path: &Path, ticks: u64, key: StationKey, dropped_rows: u64) {
    record_with(path, ticks, key, dropped_rows, |_, _| {});
}

/// The same with another header, and with whatever stands in its log.
fn record_with(
    path: &Path,
    ticks: u64,
    key: StationKey,
    dropped_rows: u64,
    change: impl Fn(&mut SessionHeader, &mut Vec<String>),
) {
    let mut scene = common::scene();
    scene.tools[0].bands = vec![Band {
        from: 0.0,
        to: 1e-3,
        dark: true,
    }];
    let mut exercise = Exercise::built_in().remove(0);
    exercise.duration_s = ticks as f64 * 1e-3;
    let mut log = Vec::new();
    let mut header = SessionHeader {
        exercise_name: "crown".into(),
        exercise: exercise.definition(1).unwrap(),
        rubric: Rubric::of(&exercise).unwrap().definition().unwrap(),
        learner_id: "a7f3".into(),
        station: "<b>7</b>".into(),
        started_unix_ns: BEGAN,
        // As before it was said.
        mode: None,
        ..SessionHeader::new(scene.to_bytes().unwrap())
    };
    change(&mut header, &mut log);
    let mut recorder = Recorder::create(path, &header, key).unwrap();
    let (mut state, mut shapes) = (State::new(&scene), Workspace::new(&scene));
    recorder.snapshot(BEGAN, 0, &state.to_bytes()).unwrap();
    for k in 0..ticks {
        let input = input(k);
        let output = tick(&scene, &mut state, &mut shapes, &input, &mut NoProbe);
        let now = BEGAN + (k + 1) * 1_000_000;
        recorder.push(&Row::new(now, &input, &output)).unwrap();
    }
    for line in log {
        recorder.event(BEGAN, Level::Info, &line).unwrap();
    }
    let end = SessionEnd {
        ticks,
        dropped_rows,
        ..SessionEnd::default()
    };
    recorder.finish(end).unwrap();
}

/// An instructor's word.
const REVISE: [&str; 8] = [
    "--revise",
    "81",
    "--by",
    "t04",
    "--at",
    "2026-11-24",
    "--reason",
    "seen",
];

struct Place(tempfile::TempDir);

impl Place {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn session(&self) -> PathBuf {
        let path = self.path("session.mcap");
        record(&path, 3000, key(), 0);
        path
    }

    /// Exit code, standard output, standard error.
    fn run(&self, args: &[&str]) -> (i32, String, String) {
        let output = Command::new(env!("CARGO_BIN_EXE_sulcus-sessions"))
            .args(args)
            .current_dir(self.0.path())
            .env("XDG_STATE_HOME", self.0.path())
            .output()
            .unwrap();
        let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
        let code = output.status.code().unwrap();
        (code, text(output.stdout), text(output.stderr))
    }
}

fn of(bytes: Vec<u8>, options: &Options) -> Grade {
    let recording = Recording::from_bytes(bytes).unwrap();
    grade(&recording, options, &mut |_| {}).unwrap().grade
}

fn plain(bytes: Vec<u8>) -> Grade {
    of(bytes, &Options::default())
}

#[test]
fn a_sound_session_is_graded_by_what_the_replay_felt() {
    let place = Place::new();
    let path = place.session();
    let grade = plain(std::fs::read(&path).unwrap());
    assert!(grade.gradable, "{:?}", grade.reason);
    // The rod presses 1 to 2 mm with 500 N/m: far too heavy for a light hand.
    let force = grade.metric("contact_force").unwrap();
    assert!((0.3..2.0).contains(&force.value.unwrap()), "{force:?}");
    assert_eq!(grade.rubric.as_ref().unwrap().source, Source::Recording);
    // By hand: the score is the mean by weight of the metrics' scores, less what essentials cost.
    let weights = grade.metrics.iter().filter(|m| m.score.is_some());
    let (sum, all) = weights.fold((0.0, 0.0), |(sum, all), m| {
        (sum + m.weight * m.score.unwrap(), all + m.weight)
    });
    let less: f64 = grade.metrics.iter().map(|metric| metric.deducted).sum();
    assert!((grade.score.unwrap() - (sum / all - less).max(0.0)).abs() < 0.11);
}

#[test]
fn a_forged_wrench_buys_no_grade() {
    let place = Place::new();
    let bytes = std::fs::read(place.session()).unwrap();
    let honest = plain(bytes.clone());
    // Every wrench in the file made as good as none; nobody can sign that but the station.
    let forged = with_messages(&bytes, |topic, data| {
        if topic == "/exact/ticks"
            && let Some(mut row) = Row::from_bytes(data)
        {
            row.wrench = row.wrench.map(|wrench| wrench.map(|x| x * 0.01));
            *data = row.to_bytes().to_vec();
        }
        true
    });
    let grade = plain(forged);
    assert!(honest.score.is_some());
    assert_eq!(
        (grade.gradable, grade.score, grade.passed),
        (false, None, None)
    );
    assert!(
        grade
            .reason
            .unwrap()
            .contains("the replay differs from tick")
    );
    assert!(grade.metrics.is_empty() && grade.sites.is_empty());
}

#[test]
fn what_is_cut_off_incomplete_or_signed_by_another_gets_none_and_says_why() {
    let place = Place::new();
    let bytes = std::fs::read(place.session()).unwrap();
    let cut = plain(bytes[..bytes.len() * 2 / 3].to_vec());
    assert!(cut.score.is_none());
    assert!(cut.reason.unwrap().contains("cut off"));
    let lost = place.path("lost.mcap");
    record(&lost, 500, key(), 3);
    let lost = plain(std::fs::read(&lost).unwrap());
    assert!(lost.reason.unwrap().contains("3 rows were dropped"));
    let trusted = Options {
        trust: Some(key().public()),
        ..Options::default()
    };
    assert!(of(bytes.clone(), &trusted).score.is_some());
    let other = Options {
        trust: Some(StationKey::from_seed([1; 32]).public()),
        ..Options::default()
    };
    let refused = of(bytes, &other);
    assert!(refused.score.is_none());
    assert!(refused.reason.unwrap().contains("not the trusted key"));
    // It was asked for, and is not the one.
    assert!(!refused.signer_trusted);
}

#[test]
fn another_rubric_is_used_when_given_and_the_output_says_so() {
    let place = Place::new();
    let bytes = std::fs::read(place.session()).unwrap();
    let exercise = Exercise::built_in().remove(0);
    let mut strict = Rubric::of(&exercise).unwrap();
    strict.version = 9;
    strict.pass_mark = 100.0;
    let options = Options {
        rubric: Some(strict),
        ..Options::default()
    };
    let grade = of(bytes, &options);
    let used = grade.rubric.clone().unwrap();
    assert_eq!((used.version, used.source), (9, Source::File));
    assert!(grade.text(true, false).contains("GIVEN INSTEAD"));
    assert_eq!(grade.passed, Some(false));
}

#[test]
fn an_instructors_word_is_added_and_the_proposal_stays() {
    let place = Place::new();
    let path = place.session();
    let grade = plain(std::fs::read(&path).unwrap());
    let said = |score: f64, reason: &str| Revision {
        score,
        passed: score >= 70.0,
        by: "t04".into(),
        at: "2026-11-23".into(),
        reason: reason.into(),
    };
    assert_eq!(Sidecar::read(&path).unwrap(), None);
    let first = Sidecar::add(&path, &grade, said(80.0, "device slipped")).unwrap();
    let second = Sidecar::add(&path, &grade, said(75.0, "seen again")).unwrap();
    assert_eq!(first.proposal, second.proposal);
    assert_eq!(second.proposal.score, grade.score);
    assert_eq!(second.revisions[..1], first.revisions);
    assert_eq!(second.latest().unwrap().score, 75.0);
    assert_eq!(Sidecar::read(&path).unwrap(), Some(second.clone()));
    for (revision, words) in [
        (said(101.0, "x"), "score is 101, expected 0 to 100"),
        (said(50.0, " "), "reason is 1 bytes long"),
    ] {
        let told = Sidecar::add(&path, &grade, revision)
            .unwrap_err()
            .to_string();
        assert!(told.contains(words), "{told}");
    }
    let other = Grade {
        learner_id: "b1".into(),
        ..grade.clone()
    };
    let told = Sidecar::add(&path, &other, said(50.0, "x")).unwrap_err();
    assert!(told.to_string().contains("of learner `a7f3`"), "{told}");
    assert_eq!(Sidecar::read(&path).unwrap(), Some(second));
    std::fs::write(beside(&path), "{}").unwrap();
    assert!(Sidecar::read(&path).is_err());
}

#[test]
fn the_program_writes_the_same_bytes_again_and_pages_that_need_no_network() {
    let place = Place::new();
    place.session();
    std::fs::write(place.path("names.csv"), "learner_id,name\na7f3,Doe & Co\n").unwrap();
    let json = ["grade", "session.mcap", "--json"];
    let (code, once, _) = place.run(&json);
    assert_eq!((code, &once), (0, &place.run(&json).1));
    let object: Value = serde_json::from_str(once.lines().last().unwrap()).unwrap();
    assert!(object["score"].is_f64());
    for key in [
        "name",
        "value",
        "unit",
        "target",
        "score",
        "definition",
        "source",
    ] {
        assert!(object["metrics"][0].get(key).is_some(), "{key}");
    }
    assert!(!once.contains("Doe"));
    let args = [
        "grade",
        "session.mcap",
        "--html",
        "pages",
        "--csv",
        "class.csv",
        "--names",
        "names.csv",
    ];
    let (code, table, _) = place.run(&args);
    assert_eq!(code, 0);
    let version = Rubric::of(&Exercise::built_in()[0]).unwrap().version;
    let says = format!("rubric     crown, version {version}");
    assert!(table.contains(&says), "{table}");
    for page in ["session.html", "class.html"] {
        let page = std::fs::read_to_string(place.path("pages").join(page)).unwrap();
        for outside in ["http:", "https:", "<script", "url(h", "@import", "src="] {
            assert!(!page.contains(outside), "{outside}");
        }
        assert!(
            page.contains("Doe &amp; Co (a7f3)") && page.contains("crown"),
            "{page}"
        );
        assert!(!page.contains("<b>7</b>"));
    }
    let table = std::fs::read_to_string(place.path("class.csv")).unwrap();
    assert!(
        table.starts_with("file,learner_id,name,exercise,attempt,"),
        "{table}"
    );
    assert!(
        table.contains("session.mcap,a7f3,Doe & Co,crown,1,"),
        "{table}"
    );
}

/// The pages and the JSON of a whole class were lost with a table that could not be written, and the cause was not said.
#[test]
fn a_table_that_cannot_be_written_takes_nothing_else_with_it() {
    let place = Place::new();
    place.session();
    let args = [
        "grade",
        "session.mcap",
        "--csv",
        "absent/class.csv",
        "--html",
        "pages",
        "--json",
    ];
    let (code, once, said) = place.run(&args);
    assert_eq!(code, 2);
    assert!(said.contains("class.csv`: No such file"), "{said}");
    let object: Value = serde_json::from_str(once.lines().last().unwrap()).unwrap();
    assert!(object["score"].is_f64(), "{object}");
    assert!(place.path("pages").join("class.html").exists());
}

#[test]
fn modes_ask_for_what_they_need() {
    let place = Place::new();
    place.session();
    let told = |args: &[&str]| {
        let (code, _, said) = place.run(args);
        assert_eq!(code, 2, "{said}");
        said
    };
    let own = ["grade", "session.mcap", "--mode", "self-assessment"];
    assert!(told(&own).contains("--self-score is missing, expected 0 to 100"));
    let (code, table, _) = place.run(&[&own[..], &["--self-score", "60"]].concat());
    assert_eq!(code, 0);
    // Its own score stands first.
    assert!(
        table.find("own score").unwrap() < table.find("score      ").unwrap(),
        "{table}"
    );
    // It is kept, and none that comes after the grade replaces it.
    let (code, again, _) = place.run(&own);
    assert_eq!((code, &again), (0, &table));
    let beside = place.path("session.mcap.grade.json");
    let before = std::fs::read(&beside).unwrap();
    let other = [&own[..], &["--self-score", "90"]].concat();
    assert!(told(&other).contains("self_score is 90, expected 60"));
    assert_eq!(std::fs::read(&beside).unwrap(), before);
    let wrong = String::from_utf8(before.clone()).unwrap();
    std::fs::write(&beside, wrong.replace("60.0", "160.0")).unwrap();
    assert!(told(&own).contains("self_score is 160, expected 0 to 100"));
    std::fs::write(&beside, before).unwrap();
    let exam = ["grade", "session.mcap", "--mode", "exam"];
    assert!(told(&exam).contains("--signer is missing"));
    std::fs::write(place.path("rubric.toml"), "").unwrap();
    assert!(
        told(&[&exam[..], &["--rubric", "rubric.toml"]].concat()).contains("--rubric is given")
    );
    let signer = key().public().fingerprint();
    let (code, table, _) = place.run(&[&exam[..], &["--signer", &signer]].concat());
    assert_eq!(code, 0);
    assert!(!table.contains("practise next"), "{table}");
    assert!(told(&["grade", "session.mcap", "--rubric", "rubric.toml"]).contains("rubric.toml"));
    assert!(told(&["grade", "session.mcap", "--revise", "70"]).contains("--reason"));
    let revise = [
        "grade",
        "session.mcap",
        "--revise",
        "70",
        "--by",
        "t04",
        "--at",
        "2026-11-23",
        "--reason",
        "seen",
    ];
    let (code, table, _) = place.run(&revise);
    assert_eq!(code, 0);
    assert!(table.contains("REVISED    70.0, passed, by t04"), "{table}");
    assert!(place.path("session.mcap.grade.json").exists());
}

impl Place {
    fn recorded_as(&self, name: &str, mode: Mode) -> PathBuf {
        let path = self.path(name);
        record_with(&path, 3000, key(), 0, |header, _| {
            header.mode = Some(mode);
            header.learner_id = format!("{mode}-1");
        });
        path
    }

    /// What it says where something is wrong with what was asked for.
    fn told(&self, args: &[&str]) -> String {
        let (code, out, said) = self.run(args);
        assert_eq!(code, 2, "{out}{said}");
        said
    }

    fn json(&self, args: &[&str]) -> Value {
        let (code, out, said) = self.run(args);
        assert_eq!(code, 0, "{said}");
        serde_json::from_str(out.lines().last().unwrap()).unwrap()
    }
}

#[test]
fn what_was_recorded_as_an_exam_is_shown_as_one_unless_something_else_is_asked_for() {
    let place = Place::new();
    place.recorded_as("exam.mcap", Mode::Exam);
    place.recorded_as("practice.mcap", Mode::Practice);
    let signer = key().public().fingerprint();
    let exam = ["grade", "exam.mcap", "--signer", &signer];
    assert!(
        place
            .told(&["grade", "exam.mcap"])
            .contains("--signer is missing")
    );
    let shown = place.json(&[&exam[..], &["--json"]].concat());
    assert_eq!(
        (&shown["mode"], &shown["recorded_mode"]),
        (&"exam".into(), &"exam".into())
    );
    assert!(shown.get("advice").is_none());
    assert!(
        place
            .told(&[&exam[..], &["--truth"]].concat())
            .contains("--truth is given")
    );
    let after = ["--json", "--truth", "--mode", "practice"];
    let after = place.json(&[&exam[..], &after].concat());
    assert_eq!(
        (&after["mode"], &after["recorded_mode"]),
        (&"practice".into(), &"exam".into())
    );
    assert_eq!(after["score"], shown["score"]);
    let (_, table, _) = place.run(&[&exam[..], &["--mode", "practice"]].concat());
    assert!(
        table.contains("mode       exam, shown as practice"),
        "{table}"
    );
    // The other way it would let somebody practise until it is good.
    let made = [
        "grade",
        "practice.mcap",
        "--mode",
        "exam",
        "--signer",
        &signer,
    ];
    let told = place.told(&made);
    assert!(
        told.contains("practice.mcap: mode is practice in the recording, expected exam"),
        "{told}"
    );
    // A class of both: each as what it was.
    let both = [
        "grade",
        "exam.mcap",
        "practice.mcap",
        "--signer",
        &signer,
        "--csv",
        "class.csv",
    ];
    assert_eq!(place.run(&both).0, 0);
    let table = std::fs::read_to_string(place.path("class.csv")).unwrap();
    let mut reader = csv::Reader::from_reader(table.as_bytes());
    let header = reader.headers().unwrap().clone();
    let rows: Vec<csv::StringRecord> = reader.records().map(Result::unwrap).collect();
    let of = |row: usize, name: &str| {
        let column = header.iter().position(|one| one == name).unwrap();
        rows[row][column].to_owned()
    };
    assert_eq!(rows.len(), 2);
    let modes = [0, 1].map(|row| (of(row, "mode"), of(row, "recorded_mode")));
    let both = |mode: &str| (mode.to_owned(), mode.to_owned());
    assert_eq!(modes, [both("exam"), both("practice")]);
    assert_eq!(of(0, "final_score"), shown["score"].to_string());
    let mark = shown["pass_mark"].as_f64().unwrap();
    assert_eq!(of(0, "pass_mark"), mark.to_string());
}

#[test]
fn an_own_score_is_asked_for_first_where_the_session_was_recorded_so() {
    let place = Place::new();
    place.recorded_as("own.mcap", Mode::SelfAssessment);
    place.session();
    let own = ["grade", "own.mcap"];
    assert!(
        place
            .told(&own)
            .contains("own.mcap: --self-score is missing")
    );
    assert!(!place.path("own.mcap.grade.json").exists());
    assert_eq!(
        place.run(&[&own[..], &["--self-score", "55"]].concat()).0,
        0
    );
    let json = place.json(&[&own[..], &["--json"]].concat());
    // The first one counts.
    let second = [&own[..], &["--self-score", "90"]].concat();
    assert!(
        place
            .told(&second)
            .contains("own.mcap: revision: self_score is 90, expected 55")
    );
    assert_eq!(
        (&json["self_score"], &json["mode"]),
        (&55.0.into(), &"self-assessment".into())
    );
    let other = ["grade", "session.mcap", "--self-score", "55"];
    assert!(
        place
            .told(&other)
            .contains("expected in self-assessment only")
    );
    assert!(
        place
            .told(&[&own[..], &["--self-score", "-1"]].concat())
            .contains("`-1` is not a score")
    );
    // There is nothing to have an opinion of where there is no grade.
    let bytes = std::fs::read(place.path("own.mcap")).unwrap();
    std::fs::write(place.path("torn.mcap"), &bytes[..bytes.len() / 2]).unwrap();
    assert_eq!(
        place.run(&["grade", "torn.mcap", "--self-score", "50"]).0,
        1
    );
    assert!(!place.path("torn.mcap.grade.json").exists());
}

/// `--csv class/*.mcap` wrote the table over the first recording, and said nothing.
#[test]
fn no_recording_and_nothing_that_is_read_is_written_over() {
    let place = Place::new();
    let path = place.session();
    let before = std::fs::read(&path).unwrap();
    std::fs::copy(&path, place.path("other.mcap")).unwrap();
    let names = "learner_id,name\na7f3,Doe\n";
    std::fs::write(place.path("session.mcap.grade.json"), "kept").unwrap();
    std::fs::write(place.path("names.csv"), names).unwrap();
    let around = format!(
        "./../{}/session.mcap",
        place.0.path().file_name().unwrap().display()
    );
    for (table, word) in [
        ("session.mcap", "which is read as"),
        (around.as_str(), "which is read as"),
        ("names.csv", "which is read as"),
        ("other.mcap", "which is a recording"),
        ("session.mcap.grade.json", "which is read as"),
    ] {
        let args = [
            "grade",
            "session.mcap",
            "--names",
            "names.csv",
            "--csv",
            table,
        ];
        let told = place.told(&args);
        assert!(told.contains("--csv is") && told.contains(word), "{told}");
    }
    assert!(std::fs::read(&path).unwrap() == before);
    assert!(std::fs::read(place.path("other.mcap")).unwrap() == before);
    assert_eq!(
        std::fs::read_to_string(place.path("names.csv")).unwrap(),
        names
    );
}

/// The first of two copies counted, torn or not, and whatever an instructor had said beside the other was not seen.
#[test]
fn of_copies_the_one_that_says_most_counts() {
    let place = Place::new();
    let bytes = std::fs::read(place.session()).unwrap();
    std::fs::write(place.path("a-torn.mcap"), &bytes[..bytes.len() / 2]).unwrap();
    std::fs::copy(place.path("session.mcap"), place.path("b-copy.mcap")).unwrap();
    assert_eq!(
        place
            .run(&[&["grade", "session.mcap"][..], &REVISE].concat())
            .0,
        0
    );
    let all = ["a-torn.mcap", "b-copy.mcap", "session.mcap"];
    for order in [[0, 1, 2], [2, 1, 0], [1, 0, 2]] {
        let files = order.map(|k| all[k]);
        let args = [&["grade"][..], &files, &["--csv", "class.csv"]].concat();
        let (code, _, said) = place.run(&args);
        assert_eq!(code, 1, "{said}");
        assert_eq!(said.matches("counted once").count(), 2, "{said}");
        let table = std::fs::read_to_string(place.path("class.csv")).unwrap();
        let row = table.lines().nth(1).unwrap();
        assert!(
            row.starts_with("session.mcap,") && row.contains(",81,true,"),
            "{row}"
        );
        assert_eq!(table.lines().count(), 2);
    }
    let told = place.told(&[
        "grade",
        "session.mcap",
        "--revise",
        "8",
        "--by",
        "Dr. Doe",
        "--at",
        "x",
        "--reason",
        "y",
    ]);
    assert!(told.contains("never a name"), "{told}");
}

#[test]
fn what_cannot_be_kept_does_not_hide_the_grade() {
    let place = Place::new();
    place.session();
    // Where the draft would be written is a folder.
    std::fs::create_dir(place.path("session.mcap.grade.json.new")).unwrap();
    let (code, table, said) = place.run(&[&["grade", "session.mcap"][..], &REVISE].concat());
    assert_eq!(code, 2);
    assert!(
        table.contains("score      ") && !table.contains("REVISED"),
        "{table}"
    );
    assert!(said.contains("to keep it, grade a copy"), "{said}");
    // What is wrong with the word itself is said before anything is done.
    let blank = [
        "--revise",
        "81",
        "--by",
        "t04",
        "--at",
        "2026-11-24",
        "--reason",
        " ",
    ];
    let told = place.told(&[&["grade", "session.mcap"][..], &blank].concat());
    assert!(
        told.contains("session.mcap: revision: reason is 1 bytes long"),
        "{told}"
    );
    assert!(!told.contains("grade a copy"), "{told}");
}

#[test]
fn a_revision_says_what_was_proposed_then_where_that_was_something_else() {
    let place = Place::new();
    place.session();
    let (_, table, _) = place.run(&[&["grade", "session.mcap"][..], &REVISE].concat());
    assert!(!table.contains("THEN"), "{table}");
    let mut other = Rubric::of(&Exercise::built_in()[0]).unwrap();
    let was = other.version;
    other.version = 77;
    std::fs::write(place.path("other.toml"), other.definition().unwrap()).unwrap();
    let args = [
        "grade",
        "session.mcap",
        "--rubric",
        "other.toml",
        "--html",
        "pages",
    ];
    let (_, table, _) = place.run(&args);
    let then = format!("by rubric crown, version {was} was proposed");
    assert!(table.contains(&then), "{table}");
    let page = std::fs::read_to_string(place.path("pages/session.html")).unwrap();
    assert!(page.contains(&then), "{page}");
}

/// A client that was cut off got a grade that said nothing of it.
#[test]
fn a_session_that_ended_early_says_so_in_its_grade() {
    let place = Place::new();
    let path = place.path("lost.mcap");
    record_with(&path, 3000, key(), 0, |_, log| {
        log.push("session ended: ConnectionLost".into());
    });
    let grade = plain(std::fs::read(&path).unwrap());
    assert_eq!(
        grade.ended_early,
        Some("the connection to the client was lost, or it closed it")
    );
    assert!(grade.score.is_some());
    let (_, table, _) = place.run(&["grade", "lost.mcap", "--html", "pages"]);
    assert!(
        table.contains("WARNING    ended early: the connection"),
        "{table}"
    );
    let page = std::fs::read_to_string(place.path("pages/lost.html")).unwrap();
    assert!(page.contains("ended early: the connection"));
}

/// One metric that a later program calls otherwise took the whole grade of a recording.
#[test]
fn a_recorded_rubric_is_graded_by_as_far_as_its_metrics_are_known() {
    let place = Place::new();
    let path = place.path("old.mcap");
    record_with(&path, 3000, key(), 0, |header, _| {
        let text = header.rubric.replace("\"probe_peak\"", "\"probe_push\"");
        let was = "Largest mean of the force on the probe";
        assert!(text != header.rubric && text.contains(was));
        // And another one that was defined otherwise.
        header.rubric = text.replace("Share of twelve sectors", "Share of six sectors");
    });
    let grade = plain(std::fs::read(&path).unwrap());
    assert!(grade.score.is_some(), "{:?}", grade.reason);
    let used = grade.rubric.clone().unwrap();
    assert_eq!(
        (used.unknown, used.redefined),
        (
            vec!["probe_push".to_owned()],
            vec!["crown_covered".to_owned()]
        )
    );
    let covered = grade.metric("crown_covered").unwrap();
    assert!(covered.definition.contains("twelve sectors"));
    assert!(
        covered
            .recorded_definition
            .as_ref()
            .unwrap()
            .contains("six sectors")
    );
    let text = grade.text(false, false);
    for words in [
        "(nor what would fail by it): probe_push",
        "defined otherwise in the recording: crown_covered",
    ] {
        assert!(text.contains(words), "{text}");
    }
}
