//! `sulcus-server case` from outside: made, checked, compiled, stopped half way, planned, removed.

use std::io::{BufRead as _, BufReader};
use std::os::unix::fs::PermissionsExt as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use serde_json::Value;
use sulcus_core::Scene;

use crate::common::{json, text};

struct Place(tempfile::TempDir);

impl Place {
    fn new() -> Self {
        Self(tempfile::tempdir().expect("temporary folder"))
    }

    fn command(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_sulcus-server"));
        command
            .current_dir(self.0.path())
            .env("SULCUS_STATE_DIR", self.0.path().join("state"))
            .args(arguments);
        command
    }

    fn run(&self, arguments: &[&str]) -> Output {
        self.command(arguments).output().expect("the program runs")
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
    }

    fn file(&self, name: &str) -> PathBuf {
        self.0.path().join("state/cases").join(name)
    }

    /// Changes a patient file as an editor does.
    fn edit(&self, name: &str, from: &str, to: &str) {
        let path = self.file(&format!("{name}.patient.toml"));
        let text = std::fs::read_to_string(&path).expect("a patient file");
        assert!(text.contains(from), "{text}");
        std::fs::write(&path, text.replacen(from, to, 1)).expect("writes");
    }
}

fn mode(path: &Path) -> u32 {
    let found = std::fs::metadata(path).expect("there");
    found.permissions().mode() & 0o777
}

#[test]
fn a_case_is_made_checked_listed_and_removed() {
    let place = Place::new();
    let made = place.json(&["case", "new", "deep-1", "--seed", "7"]);
    assert_eq!(
        (&made["name"], &made["state"]),
        (&"deep-1".into(), &"new".into())
    );
    assert_eq!(mode(&place.file("deep-1.patient.toml")), 0o600);
    place.refused(&["case", "new", "deep-1"], &["deep-1", "exists already"]);
    place.refused(
        &["case", "new", "../x"],
        &["../x", "expected a case's name"],
    );
    place.refused(&["case", "show", "none"], &["`none`", "deep-1"]);
    place.refused(
        &["case", "show", "deep-1", "--path"],
        &["not compiled", "case compile"],
    );
    place.json(&["case", "new", "copied", "--copy", "deep-1"]);
    place.edit("copied", "mobility = 0", "mobility = 7");
    let checked = place.run(&["case", "check", "copied"]);
    let told = text(&checked.stdout);
    assert_eq!(checked.status.code(), Some(1), "a finding: {told}");
    assert!(
        told.contains("`mobility` of tooth") && told.contains("is 7"),
        "{told}"
    );
    place.refused(&["case", "compile", "copied"], &["copied", "mobility"]);
    assert_eq!(
        place.run(&["case", "check", "deep-1"]).status.code(),
        Some(0)
    );
    let list = place.json(&["case", "list"]);
    let states: Vec<_> = list["cases"]
        .as_array()
        .expect("cases")
        .iter()
        .map(|case| {
            (
                case["name"].as_str().expect("a name"),
                case["state"].as_str().expect("a state"),
            )
        })
        .collect();
    assert_eq!(states, [("copied", "faulty"), ("deep-1", "new")]);
    place.json(&["case", "remove", "copied"]);
    assert_eq!(
        place.json(&["case", "list"])["cases"]
            .as_array()
            .expect("cases")
            .len(),
        1
    );
    std::fs::write(
        place.0.path().join("odd.toml"),
        "name = \"a\"\nsuppuration = 1\n",
    )
    .expect("writes");
    place.refused(
        &["case", "new", "odd", "--from", "odd.toml"],
        &["suppuration", "line 2"],
    );
}

/// A compiled case is what a station loads; a compilation that is killed leaves the former scene; a used case stays.
#[test]
fn a_compiled_case_survives_a_killed_compilation_and_serves_a_plan() {
    let place = Place::new();
    place.json(&["case", "new", "a", "--seed", "7"]);
    let compiled = place.json(&["case", "compile", "a"]);
    assert_eq!(compiled["state"], "compiled", "{compiled}");
    let path = place.file("a.scene");
    assert_eq!(mode(&path), 0o600);
    let first = std::fs::read(&path).expect("a scene");
    let scene = Scene::from_bytes(&first).expect("a scene");
    assert_eq!(scene.name, "a");
    assert!(
        scene
            .objects
            .iter()
            .any(|object| object.name == "gingiva 36")
    );

    // A change, and a compilation that is killed at its first stage.
    place.edit("a", "mobility = 0", "mobility = 1");
    assert_eq!(place.json(&["case", "show", "a"])["state"], "changed");
    let mut child = place
        .command(&["case", "compile", "a"])
        .stderr(Stdio::piped())
        .spawn()
        .expect("starts");
    let mut line = String::new();
    let output = child.stderr.take().expect("a pipe");
    BufReader::new(output).read_line(&mut line).expect("a line");
    assert!(line.contains(" %  "), "{line}");
    child.kill().expect("kills");
    child.wait().expect("ends");
    assert_eq!(std::fs::read(&path).expect("a scene"), first);
    assert_eq!(place.json(&["case", "show", "a"])["state"], "changed");

    let shown = place.run(&["case", "show", "a", "--path"]);
    let shown = text(&shown.stdout);
    let shown = shown.trim();
    assert_eq!(
        Path::new(shown),
        std::fs::canonicalize(&path).expect("a path")
    );
    place.json(&[
        "plan",
        "set",
        "chair-1",
        "--exercise",
        "bimanual",
        "--scene",
        shown,
    ]);
    place.refused(&["case", "remove", "a"], &["`a`", "chair-1"]);
    assert!(path.exists());
    place.json(&["plan", "set", "chair-1", "--clear", "scene"]);
    place.json(&["case", "remove", "a"]);
    assert!(!path.exists() && !place.file("a.status.json").exists());
}

/// Two compilations at once would take two cores from the stations.
#[test]
fn a_second_compilation_waits_for_the_first() {
    let place = Place::new();
    place.json(&["case", "new", "a", "--condition", "healthy"]);
    place.json(&["case", "new", "b", "--condition", "healthy"]);
    let lock = std::fs::File::create(place.file("compile.lock")).expect("a lock");
    lock.lock().expect("free");
    let mut child = place
        .command(&["case", "compile", "b"])
        .stderr(Stdio::piped())
        .spawn()
        .expect("starts");
    let mut lines = BufReader::new(child.stderr.take().expect("a pipe")).lines();
    let first = lines.next().expect("a line").expect("text");
    assert!(first.contains("waiting for another compilation"), "{first}");
    drop(lock);
    let second = lines.next().expect("a line").expect("text");
    assert!(second.contains("tool"), "{second}");
    child.kill().expect("kills");
    child.wait().expect("ends");
}
