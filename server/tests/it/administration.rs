//! Commands of an administrator from outside: what they print, what they keep, and what they never show.

use std::os::unix::fs::PermissionsExt as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use serde_json::Value;

use crate::common::{json, text};

struct Place(tempfile::TempDir);

impl Place {
    fn new() -> Self {
        Self(tempfile::tempdir().expect("temporary folder"))
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn run(&self, arguments: &[&str]) -> Output {
        Command::new(env!("CARGO_BIN_EXE_sulcus-server"))
            .current_dir(self.0.path())
            .env("SULCUS_STATE_DIR", self.path("state"))
            .args(arguments)
            .output()
            .expect("the program runs")
    }

    fn json(&self, arguments: &[&str]) -> Value {
        json(&self.run(&[arguments, &["--json"]].concat()))
    }

    fn refused(&self, arguments: &[&str], words: &[&str]) {
        let ended = self.run(arguments);
        let told = text(&ended.stderr);
        assert_eq!(ended.status.code(), Some(2), "{arguments:?}: {told}");
        for word in words {
            assert!(told.contains(word), "`{word}` is missing: {told}");
        }
        assert!(!told.contains("panicked"), "{told}");
    }

    fn roster(&self, text: &str) {
        std::fs::write(self.path("roster.csv"), text).expect("writes");
    }
}

fn mode(path: &Path) -> u32 {
    let found = std::fs::metadata(path).expect("there");
    found.permissions().mode() & 0o777
}

#[test]
fn a_token_is_shown_once_and_never_listed() {
    let place = Place::new();
    let made = place.json(&["token", "add", "--role", "student", "--learner", "s-17"]);
    let ticket = made["ticket"].as_str().expect("a ticket").to_owned();
    let (token, fingerprint) = ticket.split_once('.').expect("two parts");
    assert_eq!((token.len(), fingerprint.len()), (64, 64));
    assert_eq!(
        (&made["role"], &made["station"]),
        (&"student".into(), &"station".into())
    );
    let shown = place.json(&["certificate", "show"]);
    assert_eq!(shown["certificate_sha256"], fingerprint);

    for arguments in [&["token", "list"][..], &["token", "list", "--json"]] {
        let listed = place.run(arguments);
        let all = text(&listed.stdout) + &text(&listed.stderr);
        assert!(all.contains("s-17") && !all.contains(token), "{all}");
        let hash = blake3::hash(token.as_bytes()).to_hex();
        assert!(!all.contains(hash.as_str()), "{all}");
    }
    for file in std::fs::read_dir(place.path("state")).expect("lists") {
        let path = file.expect("an entry").path();
        assert_eq!(mode(&path), 0o600, "{}", path.display());
        let content = std::fs::read(&path).expect("reads");
        assert!(!text(&content).contains(token), "{}", path.display());
    }
    assert_eq!(mode(&place.path("state")), 0o700);

    let id = made["id"].as_str().expect("an id");
    let revoked = place.json(&["token", "revoke", id]);
    assert_eq!(
        (revoked["valid"].as_bool(), revoked["id"].as_str()),
        (Some(false), Some(id))
    );
    place.refused(&["token", "revoke", "t-none"], &["t-none", "token list"]);
}

#[test]
fn values_of_a_token_are_checked_before_anything_is_made() {
    let place = Place::new();
    for (arguments, words) in [
        (&["--role", "teacher"][..], &["teacher", "instructor"][..]),
        (&["--role", "student", "--station", "any"], &["one station"]),
        (&["--role", "student", "--station", "a/b"], &["a/b"]),
        (
            &["--role", "student", "--learner", "Jane Doe"],
            &["Jane Doe", "opaque"],
        ),
        (&["--role", "admin", "--learner", "s-1"], &["admin"]),
        (&["--role", "student", "--expires", "0"], &["0"]),
        (&[], &["--role"]),
    ] {
        place.refused(&[&["token", "add"], arguments].concat(), words);
    }
    assert!(!place.path("state").exists());
    let listed = place.json(&["token", "list"]);
    assert_eq!(listed["tokens"], serde_json::json!([]));
}

#[test]
fn a_class_is_made_from_a_roster_once() {
    let place = Place::new();
    place.roster("Station;ID\r\na-1;s-1\r\na-2;s-2\r\n");
    let class = ["token", "add", "--class", "roster.csv"];
    let with = |more: &[&'static str]| [&class, more].concat();
    let checked = place.json(&with(&["--check"]));
    assert_eq!(
        (&checked["new"], &checked["faults"]),
        (&2.into(), &0.into())
    );
    assert!(!place.path("state").exists(), "a check makes nothing");
    place.refused(&class, &["--out"]);

    let made = place.json(&with(&["--out", "tickets.csv"]));
    assert_eq!(
        (&made["new"], &made["class"]),
        (&2.into(), &"roster".into())
    );
    let tickets = std::fs::read_to_string(place.path("tickets.csv")).expect("reads");
    assert_eq!(
        (mode(&place.path("tickets.csv")), tickets.lines().count()),
        (0o600, 3)
    );
    assert!(
        !made
            .to_string()
            .contains(&tickets[tickets.len() - 100..tickets.len() - 70])
    );

    let again = place.json(&with(&["--out", "more.csv"]));
    assert_eq!((&again["new"], &again["kept"]), (&0.into(), &2.into()));
    assert!(!place.path("more.csv").exists());
    place.refused(
        &with(&["--renew", "--out", "tickets.csv"]),
        &["tickets.csv"],
    );
    let renewed = place.json(&with(&["--renew", "--out", "new.csv"]));
    assert_eq!(renewed["new"], 2);
    let all = place.json(&["token", "list"]);
    let valid = |token: &&Value| token["valid"] == true;
    let all = all["tokens"].as_array().expect("a list");
    assert_eq!((all.len(), all.iter().filter(valid).count()), (4, 2));
}

#[test]
fn a_roster_with_names_is_refused_line_by_line() {
    let place = Place::new();
    place.roster("id,station\ns-1,a-1\nJane Doe,a-2\ns-1,a-3\n");
    let checked = place.run(&["token", "add", "--class", "roster.csv", "--check"]);
    assert_eq!(checked.status.code(), Some(1));
    let told = text(&checked.stdout);
    for part in [
        "line 2: s-1 at a-1: new",
        "line 3: learner is `Jane Doe`",
        "line 4: learner is `s-1`",
    ] {
        assert!(told.contains(part), "`{part}` is missing: {told}");
    }
    place.refused(
        &["token", "add", "--class", "roster.csv", "--out", "t.csv"],
        &["nothing was made"],
    );
    assert!(!place.path("t.csv").exists() && !place.path("state").exists());
}

#[test]
fn a_rotation_changes_the_fingerprint_and_keeps_tokens() {
    let place = Place::new();
    place.json(&["token", "add", "--role", "instructor"]);
    let before = place.json(&["certificate", "show"]);
    let after = place.json(&["certificate", "rotate", "--out", "cert.der"]);
    assert_ne!(before["certificate_sha256"], after["certificate_sha256"]);
    assert!(
        std::fs::metadata(place.path("cert.der"))
            .expect("there")
            .len()
            > 100
    );
    let shown = place.json(&["certificate", "show"]);
    assert_eq!(shown["certificate_sha256"], after["certificate_sha256"]);
    assert_eq!(place.json(&["token", "list"])["tokens"][0]["valid"], true);
}

#[test]
fn a_plan_is_kept_for_the_next_start_of_the_server() {
    let place = Place::new();
    std::fs::write(
        place.path("stations.toml"),
        "[[station]]\nname = \"a\"\nplan = { exercise = \"bimanual\" }\n[[station]]\nname = \"b\"\n",
    )
    .expect("writes");
    let config = ["--config", "stations.toml"];
    let set = place.run(
        &[
            &["plan", "set", "a", "--mode", "exam", "--json"],
            &config[..],
        ]
        .concat(),
    );
    assert!(
        text(&set.stderr).contains("next start"),
        "{}",
        text(&set.stderr)
    );
    let plan = json(&set);
    assert_eq!(
        (&plan["plan"]["exercise"], &plan["plan"]["mode"]),
        (&"bimanual".into(), &"exam".into())
    );
    assert_eq!(
        (&plan["running"], &plan["revision"]["number"]),
        (&false.into(), &2.into())
    );

    let shown = place.json(&[&["plan", "show"], &config[..]].concat());
    assert_eq!(shown["plans"][0]["plan"], plan["plan"]);
    assert_eq!(shown["plans"][1]["plan"]["exercise"], "crown");
    let kept = place.json(&["plan", "show", "a"]);
    assert_eq!(kept["plans"][0]["revision"], plan["revision"]);

    place.refused(
        &["plan", "set", "a", "--seed", "7"],
        &["patient_seed", "`system`"],
    );
    place.refused(&["plan", "set", "a"], &["--help"]);
    place.refused(&["plan", "set", "a/b", "--seed", "7"], &["a/b"]);
    place.refused(&["plan", "set", "a", "--clear", "limit"], &["`limit`"]);
    place.refused(&["plan", "show", "z"], &["`z`"]);
    let back = place.json(&[&["plan", "set", "a", "--from-config"], &config[..]].concat());
    assert_eq!(
        (&back["plan"]["mode"], &back["is_set"]),
        (&"practice".into(), &false.into())
    );
}

#[test]
fn a_plan_of_a_file_replaces_the_whole_plan() {
    let place = Place::new();
    std::fs::write(
        place.path("exam.toml"),
        "mode = \"exam\"\nrubric = \"r.toml\"\n",
    )
    .expect("writes");
    place.json(&[
        "plan",
        "set",
        "a",
        "--learner",
        "s-1",
        "--time-limit-s",
        "60",
    ]);
    let set = place.json(&[
        "plan",
        "set",
        "a",
        "--file",
        "exam.toml",
        "--time-limit-s",
        "90",
    ]);
    let plan = &set["plan"];
    assert_eq!(
        (&plan["learner"], &plan["time_limit_s"]),
        (&"".into(), &90.into())
    );
    let rubric = plan["rubric"].as_str().expect("a path");
    assert!(
        Path::new(rubric).is_absolute() && rubric.ends_with("r.toml"),
        "{rubric}"
    );
    std::fs::write(place.path("exam.toml"), "\nmode = \"test\"\n").expect("writes");
    place.refused(
        &["plan", "set", "a", "--file", "exam.toml"],
        &["exam.toml, line 2", "`test`"],
    );
}
