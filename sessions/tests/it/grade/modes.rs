//! Practice, self-assessment and exams.

use sulcus_sessions::Mode;

use super::place::Place;
use crate::common::key;

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
    assert!(!table.contains("\n  advice\n"), "{table}");
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
    assert!(place.told(&other).contains("expected mode self-assessment"));
    assert!(
        place
            .told(&[&own[..], &["--self-score", "-1"]].concat())
            .contains("score is `-1`, expected 0 to 100")
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
