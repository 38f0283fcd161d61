//! End of a school year from the shell: what ends, what stays; old recordings that go; a folder with a quota.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Stdio;
use std::time::{Duration, Instant, SystemTime};

use sulcus_sessions::record::statement::SessionEnd;
use sulcus_sessions::{Mode, Recorder, SessionHeader, StationKey};
use sulcus_tests::{Ended, LIMIT, Place, Program, Serving, files_with, page};

/// Runs a command of the server; words are split at blanks.
fn run(place: &Place, line: &str) -> Ended {
    let words: Vec<&str> = line.split_whitespace().collect();
    place.run(Program::Server, &words)
}

/// Content of every file below a folder. Sockets have none.
fn bytes(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut all = BTreeMap::new();
    let mut open = vec![folder.to_owned()];
    while let Some(folder) = open.pop() {
        for entry in std::fs::read_dir(&folder).expect("lists") {
            let path = entry.expect("an entry").path();
            if path.is_dir() {
                open.push(path.clone());
                all.insert(path, Vec::new());
            } else {
                all.insert(path.clone(), std::fs::read(&path).unwrap_or_default());
            }
        }
    }
    all
}

/// Actions of the audit log with their objects, oldest first.
fn log(place: &Place) -> Vec<(String, String)> {
    let text = std::fs::read_to_string(place.path("state/audit.jsonl")).expect("a log");
    let entry = |line: &str| {
        let entry: serde_json::Value = serde_json::from_str(line).expect("an entry");
        let of = |field: &str| entry[field].as_str().expect(field).to_owned();
        (of("action"), of("object"))
    };
    text.lines().map(entry).collect()
}

/// A hand with a ticket, for some seconds.
fn hand(place: &Place, server: &Serving, ticket: &str, seconds: &str) -> std::process::Child {
    place
        .command(Program::Client.path())
        .args(["run", "--server", &server.address, "--ticket", ticket])
        .args(["--duration", seconds, "--json"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the client starts")
}

/// Waits until a folder has this number of recordings.
fn wait_for(folder: &Path, count: usize) {
    let begin = Instant::now();
    while files_with(folder, "mcap").len() < count {
        assert!(begin.elapsed() < LIMIT, "no session");
        std::thread::sleep(Duration::from_millis(20));
    }
}

fn ticket(place: &Place, more: &str, file: &str) -> String {
    run(
        place,
        &format!("token add --role student {more} --out {file}"),
    )
    .ok();
    let text = std::fs::read_to_string(place.path(file)).expect("a ticket");
    text.trim().to_owned()
}

#[test]
fn a_year_ends_with_its_tickets_and_codes_and_loses_no_result_and_no_name() {
    let place = Place::new();
    let table = "sourcedId,givenName,familyName,class\n1,Zoe,Neill,Year-4\n2,Mei,Li,Year-4\n";
    std::fs::write(place.path("year.csv"), table).expect("a table");
    run(&place, "class import year.csv").ok();
    run(&place, "class assign Year-4 --exercise crown").ok();
    let codes = run(&place, "class codes Year-4 --json").ok().json();
    let learner = codes["codes"][0]["learner"]
        .as_str()
        .expect("an id")
        .to_owned();
    let code = codes["codes"][1]["code"]
        .as_str()
        .expect("a code")
        .to_owned();
    let own = ticket(
        &place,
        &format!("--station station --learner {learner}"),
        "own",
    );
    let other = ticket(&place, "--station station", "other");
    let server = place.serve(&["--exercise", "crown"]);
    let session = hand(&place, &server, &own, "4");
    wait_for(&place.path("recordings"), 1);
    let archive = "rollover Year-4 --backup year.backup";
    run(&place, archive).refused(&["a session of learner", &learner, "station"]);
    let without = run(&place, "rollover --all");
    assert!(
        without.code == 2 && without.stderr.contains("--backup"),
        "{without:#?}"
    );
    assert!(!place.path("year.backup").exists());
    Ended::new(session.wait_with_output().expect("it ends")).ok();
    let file = place.recording();
    let file = file.to_str().expect("plain").to_owned();
    std::fs::write(format!("{file}.grade.json"), "{}").expect("scores of persons");
    // The status of the station follows the end of the session.
    let begin = Instant::now();
    while run(&place, "rollover --all --dry-run").code != 0 {
        assert!(begin.elapsed() < LIMIT, "the session goes on");
    }

    // A dry run changes no byte, also while the server runs.
    run(&place, &format!("class seat station {learner}")).ok();
    let before = bytes(&place.path("state"));
    let dry = run(&place, "rollover --all --dry-run").ok().stdout;
    assert_eq!(bytes(&place.path("state")), before, "a dry run");
    let results = bytes(&place.path("recordings"));
    let names = std::fs::read(place.path("state/names.json")).expect("names");
    let (first, lines) = (log(&place).len(), dry.lines().count());
    let done = run(&place, archive).ok().stdout;
    assert_eq!(
        done.lines().skip(1).collect::<Vec<_>>(),
        dry.lines().collect::<Vec<_>>()
    );

    // An entry for the backup, and one for each line of the report.
    let entries = log(&place).split_off(first);
    assert_eq!(entries.len(), 1 + lines, "{entries:?}");
    let count = |action: &str| entries.iter().filter(|(found, _)| found == action).count();
    let actions = [
        "backup",
        "revoke token",
        "end plan",
        "end code",
        "end seat",
        "archive class",
    ];
    assert_eq!(actions.map(count), [1, 1, 2, 2, 1, 1], "{entries:?}");
    assert_eq!(
        bytes(&place.path("recordings")),
        results,
        "recordings and scores"
    );
    assert_eq!(
        std::fs::read(place.path("state/names.json")).expect("names"),
        names
    );

    // The running server knows at once: the own ticket and the code open nothing, the other ticket does.
    let join = |ticket: &str, more: &[&str]| {
        let begin = ["run", "--server", &server.address, "--ticket", ticket];
        place.run(
            Program::Client,
            &[&begin[..], &["--duration", "1"], more].concat(),
        )
    };
    join(&own, &[]).refused(&["was revoked"]);
    join(&other, &["--code", &code]).refused(&["this code is wrong"]);
    join(&other, &[]).ok();
    let plans = run(&place, "plan show --json").ok().json();
    assert_eq!(plans["plans"][0]["plan"]["learner"], "", "{plans}");
    let listed = run(&place, "class list --json").ok().json();
    assert_eq!(listed["classes"], serde_json::json!([]));
    assert_eq!(listed["archived"][0]["learners"], 2, "{listed}");
    run(&place, "class codes Year-4").refused(&["`Year-4`"]);

    // A second call makes nothing, and the next year has the name again, with the same ids.
    let before = bytes(&place.path("state"));
    let again = run(&place, "rollover Year-4 --backup second.backup").ok();
    assert!(again.stdout.contains("archived already"), "{again:#?}");
    assert_eq!(bytes(&place.path("state")), before);
    assert!(!place.path("second.backup").exists());
    run(&place, "class import year.csv").ok();
    let shown = run(&place, "class show Year-4 --json").ok().json();
    assert_eq!(shown["learners"][0]["id"], learner.as_str(), "{shown}");

    // The backup has the year as it was.
    let restored = Place::new();
    let from = place.path("year.backup");
    let from = from.to_str().expect("plain");
    restored.run(Program::Server, &["restore", from]).ok();
    let old = run(&restored, "class list --json").ok().json();
    assert_eq!(old["classes"][0]["name"], "Year-4", "{old}");
}

/// Finished recording of a session that began so many days ago; its path.
fn recorded(place: &Place, learner: &str, days: u64, mode: Mode) -> PathBuf {
    let folder = place.path("recordings");
    std::fs::create_dir_all(&folder).expect("makes");
    let now = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH);
    let began_s = now.expect("after 1970").as_secs() - days * 86_400;
    let mut header = SessionHeader::new(Vec::new());
    header.exercise_name = "crown".into();
    header.learner_id = learner.into();
    header.mode = Some(mode);
    header.started_unix_ns = began_s * 1_000_000_000;
    let key = StationKey::from_seed([7; 32]);
    let (recorder, path) = Recorder::create_in(&folder, &header, &key).expect("creates");
    recorder.finish(SessionEnd::default()).expect("finishes");
    std::fs::write(path.with_extension("mcap.grade.json"), "{}").expect("writes");
    path
}

#[test]
fn old_recordings_of_a_class_go_by_a_command_and_exams_and_scores_stay() {
    let place = Place::new();
    std::fs::write(
        place.path("ids.csv"),
        "learner,class\ns-1,Year-4\ns-2,Year-5\n",
    )
    .expect("a table");
    run(&place, "class import ids.csv").ok();
    let old = recorded(&place, "s-1", 41, Mode::Practice);
    let exam = recorded(&place, "s-1", 42, Mode::Exam);
    let young = recorded(&place, "s-1", 39, Mode::Practice);
    let other = recorded(&place, "s-2", 400, Mode::Practice);
    let unknown = recorded(&place, "", 399, Mode::Practice);
    let expire = "class expire --recordings recordings";
    let none = run(&place, expire).ok().stdout;
    assert!(
        none.contains("removed: 0"),
        "forever without a limit: {none}"
    );
    run(&place, "class keep Year-4 0").refused(&["1 to 36500"]);
    run(&place, "class keep Year-4 40").ok();
    run(&place, "rollover Year-4 --backup year.backup").ok();
    run(&place, "class keep Year-4 40").ok();
    let (state, recordings) = (
        bytes(&place.path("state")),
        bytes(&place.path("recordings")),
    );
    let dry = run(&place, &format!("{expire} --dry-run")).ok().stdout;
    assert!(
        dry.contains("remove ") && dry.contains("exam is not released"),
        "{dry}"
    );
    assert_eq!(bytes(&place.path("state")), state, "a dry run");
    assert_eq!(bytes(&place.path("recordings")), recordings, "a dry run");
    let done = run(&place, expire).ok().stdout;
    assert!(done.contains("removed: 1"), "{done}");
    for (path, is_there) in [
        (&old, false),
        (&exam, true),
        (&young, true),
        (&other, true),
        (&unknown, true),
    ] {
        assert_eq!(path.exists(), is_there, "{path:?}");
        assert!(path.with_extension("mcap.grade.json").exists(), "{path:?}");
    }
    let entries = log(&place);
    let removed = entries
        .iter()
        .filter(|(action, _)| action == "expire recording");
    assert_eq!(removed.count(), 1, "{entries:?}");

    // A recording from the future says that the clock is behind.
    let future = recorded(&place, "s-1", 0, Mode::Practice);
    let mut header = SessionHeader::new(Vec::new());
    header.started_unix_ns = u64::MAX / 4;
    header.learner_id = "s-1".into();
    let key = StationKey::from_seed([7; 32]);
    let later = Recorder::create(&place.path("recordings/later.mcap"), &header, key);
    later
        .expect("creates")
        .finish(SessionEnd::default())
        .expect("finishes");
    run(&place, expire).refused(&["the clock says", "later.mcap", "nothing is removed"]);
    assert!(future.exists());
}

#[test]
fn a_session_beyond_the_quota_is_refused_and_the_running_one_is_complete() {
    let place = Place::new();
    let stations = "listen = \"127.0.0.1:0\"\nrecordings = \"recordings\"\nrecordings_quota_gb = 0.007\n\
        [class]\nhours = 0.1\n[defaults]\nexercise = \"crown\"\ntime_limit_s = 20\n\
        [[station]]\nname = \"a\"\n[[station]]\nname = \"b\"\n";
    std::fs::write(place.path("class.toml"), stations).expect("a file");
    let tickets = ["a", "b"].map(|name| ticket(&place, &format!("--station {name}"), name));
    let teacher = "token add --role instructor --out teacher";
    run(&place, teacher).ok();
    let checked = run(&place, "serve --config class.toml --check --no-realtime").stdout;
    assert!(
        checked.contains("Quota of the recordings: 0.000 GB used"),
        "{checked}"
    );
    let arguments = ["--config", "class.toml", "--console", "127.0.0.1:0"];
    let server = place.serve(&arguments);
    let first = hand(&place, &server, &tickets[0], "6");
    wait_for(&place.path("recordings"), 1);
    // The first session may still write its whole forecast: the second one has no room.
    let begin = ["run", "--server", &server.address, "--ticket", &tickets[1]];
    let second = |seconds: &str| {
        let more = ["--duration", seconds, "--json"];
        place.run(Program::Client, &[&begin[..], &more].concat())
    };
    second("1").refused(&["reached their quota", "0.007 GB", "tell the instructor"]);
    if page::can().is_ok() {
        let secret = std::fs::read_to_string(place.path("teacher")).expect("a ticket");
        let secret = secret.trim().split('.').next().expect("a token").to_owned();
        let ready = page::asked(&place, &server, &secret, "/readyz");
        assert!(ready.contains("\"ready\":false"), "{ready}");
    }
    let told = Ended::new(first.wait_with_output().expect("it ends"))
        .ok()
        .json();
    assert_eq!(told["session"]["complete"], true, "{told}");
    // The rest of the first forecast is free again.
    let begin = Instant::now();
    while second("1").code != 0 {
        assert!(begin.elapsed() < LIMIT, "no room after the end");
    }
    assert_eq!(files_with(&place.path("recordings"), "mcap").len(), 2);
    let bad = stations.replace("0.007", "0");
    std::fs::write(place.path("class.toml"), bad).expect("a file");
    run(&place, "serve --config class.toml --check").refused(&[
        "line 3",
        "recordings_quota_gb is 0",
        "0.001",
    ]);
}
