//! A class from the shell: roster, plan, codes; a learner who signs in at a station by a code.

use sulcus_tests::{Place, Program, files_with};

const ROSTER: &str = "sourcedId;givenName;familyName;username;email;class\r\n\
    1;Zoë;O'Neill;zoe;z@school.example;Year 4 B\r\n\
    2;Mei;Li;mei;;Year 4 B\r\n\
    3;Ida;Roe;;;\r\n";

#[test]
fn a_roster_is_checked_imported_once_and_shown() {
    let place = Place::new();
    std::fs::write(place.path("roster.csv"), ROSTER).expect("writes");
    let class = |more: &[&str]| place.run(Program::Server, &[&["class"], more].concat());
    let dry = class(&["import", "roster.csv", "--dry-run", "--json"]);
    assert_eq!(dry.code, 1, "a line is refused");
    assert_eq!(dry.json()["imported"], false);
    assert_eq!(
        class(&["list", "--json"]).ok().json()["classes"],
        serde_json::json!([])
    );
    let made = class(&["import", "roster.csv", "--json"]).json();
    let verdicts: Vec<&str> = made["lines"]
        .as_array()
        .expect("lines")
        .iter()
        .filter_map(|line| line["verdict"].as_str())
        .collect();
    assert_eq!(verdicts, ["new", "new", "refused"]);
    let whole = class(&["import", "roster.csv", "--class", "Year 4 B", "--json"])
        .ok()
        .json();
    let verdicts: Vec<&str> = whole["lines"]
        .as_array()
        .expect("lines")
        .iter()
        .filter_map(|line| line["verdict"].as_str())
        .collect();
    assert_eq!(verdicts, ["kept", "kept", "new"]);
    let text = class(&["import", "roster.csv", "--class", "Year 4 B"])
        .ok()
        .stdout;
    assert!(
        text.contains("line 2: kept") && text.contains("3 kept"),
        "{text}"
    );
    let shown = class(&["show", "year 4 b", "--json"]).ok().json();
    assert_eq!(shown["learners"][0]["name"], "Zoë O'Neill", "{shown}");
    class(&["names", "Year 4 B", "--out", "key.csv"]).ok();
    let key = std::fs::read_to_string(place.path("key.csv")).expect("a table");
    assert!(
        key.starts_with("learner_id,name\r\n\"s-") && key.contains("\"Zoë O'Neill\""),
        "{key}"
    );
    class(&["names", "Year 4 B", "--out", "key.csv"]).refused(&["key.csv"]);
    class(&["show", "Year 5"]).refused(&["`Year 5`", "Year 4 B"]);
    class(&["import", "none.csv"]).refused(&["none.csv"]);
    std::fs::write(place.path("bad.csv"), "name,room\nx,y\n").expect("writes");
    class(&["import", "bad.csv"]).refused(&["bad.csv", "line 1", "`sourcedId`"]);
    class(&["assign", "Year 4 B", "--case", "none"]).refused(&["case is `none`"]);
    class(&[
        "assign",
        "Year 4 B",
        "--exercise",
        "probing",
        "--mode",
        "exam",
    ])
    .ok();
    class(&["release", "e-1"]).refused(&["still the present plan"]);
    class(&["assign", "Year 4 B", "--none"]).ok();
    class(&["release", "e-1"]).ok();
    let exams = class(&["exams", "--json"]).ok().json();
    assert!(exams["exams"][0]["released"]["unix_s"].is_u64(), "{exams}");
    let id = shown["learners"][1]["id"].as_str().expect("an id");
    class(&["reassign", "a.mcap", id, "--why", "wrong seat"]).ok();
    class(&["reassign", "../a.mcap", id, "--why", "wrong seat"]).refused(&["`../a.mcap`"]);
    class(&["seat", "station", id]).refused(&["no server runs"]);
    class(&["remove", "Year 4 B", "--learner", id]).ok();
    class(&["remove", "Year 4 B"]).ok();
    let log = std::fs::read_to_string(place.path("state/audit.jsonl")).expect("a log");
    for action in [
        "import roster",
        "assign plan",
        "release exam",
        "reassign",
        "remove class",
    ] {
        assert!(log.contains(action), "{action}: {log}");
    }
    assert!(!log.contains("Neill"), "{log}");
}

#[test]
fn a_code_gives_the_station_the_plan_and_the_recording_the_id_of_its_learner() {
    let place = Place::new();
    std::fs::write(place.path("ids.csv"), "learner,class\ns-17,B\ns-18,B\n").expect("writes");
    let class = |more: &[&str]| place.run(Program::Server, &[&["class"], more].concat());
    class(&["import", "ids.csv"]).ok();
    class(&[
        "assign",
        "B",
        "--exercise",
        "probing",
        "--mode",
        "self-assessment",
    ])
    .ok();
    let codes = class(&["codes", "B", "--json"]).ok().json();
    let code = codes["codes"][0]["code"]
        .as_str()
        .expect("a code")
        .to_owned();
    let server = place.serve(&["--exercise", "crown"]);
    let wrong = if code == "000000" { "000001" } else { "000000" };
    place
        .perform(
            &server,
            &["--duration", "1", "--exercise", "probing", "--code", wrong],
        )
        .refused(&["this code is wrong"]);
    place
        .perform(&server, &["--duration", "1", "--code", "12345"])
        .refused(&["six digits"]);
    let spaced = format!("{} {}", &code[..3], &code[3..]);
    place
        .perform(
            &server,
            &[
                "--duration",
                "1",
                "--exercise",
                "probing",
                "--code",
                &spaced,
            ],
        )
        .ok();
    let file = place.recording();
    let file = file.to_str().expect("plain");
    let info = place
        .run(Program::Sessions, &["info", file, "--json"])
        .ok()
        .json();
    assert_eq!(
        (&info["learner_id"], &info["mode"]),
        (&"s-17".into(), &"self-assessment".into()),
        "{info}"
    );
    let bytes = std::fs::read(file).expect("reads");
    let claim = format!("code-{code}");
    assert!(
        !bytes
            .windows(claim.len())
            .any(|part| part == claim.as_bytes()),
        "no recording has a code"
    );
    free(&place);
    // The instructor's own seat, while the server runs.
    class(&["seat", "station", "s-18"]).ok();
    let shown = class(&["show", "B", "--json"]).ok().json();
    assert_eq!(shown["learners"][1]["station"], "station", "{shown}");
    place
        .perform(&server, &["--duration", "1", "--exercise", "probing"])
        .ok();
    free(&place);
    let learners: Vec<String> = files_with(&place.path("recordings"), "mcap")
        .iter()
        .filter_map(|file| {
            let info = place
                .run(Program::Sessions, &["info", file.to_str()?, "--json"])
                .ok()
                .json();
            info["learner_id"].as_str().map(str::to_owned)
        })
        .collect();
    assert!(
        learners.contains(&"s-17".into()) && learners.contains(&"s-18".into()),
        "{learners:?}"
    );
    let log = std::fs::read_to_string(place.path("state/audit.jsonl")).expect("a log");
    assert!(
        log.contains("\"code\"") && log.contains("s-17 at station"),
        "{log}"
    );
}

/// Waits until the station has its own plan again: the seat of a learner ends with the session.
fn free(place: &Place) {
    let begin = std::time::Instant::now();
    loop {
        let plans = place.run(Program::Server, &["plan", "show", "--json"]);
        let plans = plans.ok().json();
        let plan = &plans["plans"][0]["plan"];
        if plan["learner"] == "" && plan["exercise"] == "crown" {
            break;
        }
        assert!(begin.elapsed() < sulcus_tests::LIMIT, "{plans}");
        std::thread::sleep(std::time::Duration::from_millis(50));
    }
    let shown = place.run(Program::Server, &["class", "show", "B", "--json"]);
    let shown = shown.ok().json();
    for learner in shown["learners"].as_array().expect("learners") {
        assert!(learner["station"].is_null(), "{shown}");
    }
}
