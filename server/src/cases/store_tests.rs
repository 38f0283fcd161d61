use std::os::unix::fs::MetadataExt as _;

use sulcus_scene::anatomy::patient::{Condition, generate};

use super::*;
use crate::plan::{PlanBook, PlanChange, Station};
use crate::state::folder::fresh;

fn store() -> (tempfile::TempDir, CaseStore) {
    let (place, state) = fresh();
    let store = CaseStore::open(&state).expect("opens");
    (place, store)
}

fn text(seed: u64) -> String {
    generate(seed, Condition::Periodontitis).to_toml()
}

fn status(store: &CaseStore, name: &str) -> Status {
    let opened = store.read(name).expect("a case");
    Status {
        version: VERSION,
        patient_hash: opened.version,
        patient: opened.text,
        scene_hash: blake3::hash(b"scene").to_hex().to_string(),
        scene_bytes: 5,
        compiled_unix_s: 1,
        took_s: 1.0,
        program: "test".into(),
        warnings: Vec::new(),
    }
}

/// Keeps a compiled scene of a few bytes.
pub(super) fn keep_scene(store: &CaseStore, name: &str) {
    let status = status(store, name);
    store.keep(name, b"scene", &status).expect("keeps");
}

#[test]
fn a_case_is_private_and_has_the_state_that_its_files_tell() {
    let (_place, store) = store();
    let made = store.create("deep-1", &text(7)).expect("creates");
    assert_eq!(made.state(), State::New);
    let mode = std::fs::metadata(store.patient("deep-1"))
        .expect("there")
        .mode()
        & 0o777;
    assert_eq!(mode, 0o600);
    keep_scene(&store, "deep-1");
    assert_eq!(
        store.read("deep-1").expect("a case").state(),
        State::Compiled
    );
    let changed = store
        .write("deep-1", &made.version, &text(8))
        .expect("writes");
    assert_eq!(changed.state(), State::Changed);
    let faulty = text(8).replacen("mobility = 0", "mobility = 9", 1);
    let faulty = store
        .write("deep-1", &changed.version, &faulty)
        .expect("writes");
    assert_eq!(faulty.state(), State::Faulty);
    let fault = faulty.fault().expect("a fault");
    assert!(
        fault.contains("mobility") && fault.contains("is 9"),
        "{fault}"
    );
    // A crash between scene and status.
    std::fs::write(store.scene("deep-1"), b"other scene").expect("writes");
    assert_eq!(store.status("deep-1"), None);
}

#[test]
fn a_second_writer_is_told_and_loses_nothing() {
    let (_place, store) = store();
    let loaded = store.create("a", &text(1)).expect("creates").version;
    store
        .write("a", &loaded, &text(2))
        .expect("the first writer");
    let error = store
        .write("a", &loaded, &text(3))
        .expect_err("the second writer");
    assert!(matches!(error, CaseError::Conflict(_)), "{error}");
    assert_eq!(store.text("a").expect("text"), text(2));
    let error = store.create("a", &text(4)).expect_err("exists");
    assert!(matches!(error, CaseError::Exists(_)), "{error}");
}

#[test]
fn names_are_file_names_and_unknown_ones_are_told_with_the_known() {
    let (place, store) = store();
    for name in [
        "",
        "../x",
        "a/b",
        "a.b",
        "-a",
        "any",
        "x y",
        &"x".repeat(65),
    ] {
        let error = store.create(name, &text(1)).expect_err(name);
        assert!(matches!(error, CaseError::Name(_)), "{name}: {error}");
        store.read(name).expect_err(name);
        store.remove(name).expect_err(name);
    }
    store.create("b", &text(1)).expect("creates");
    store.create("A", &text(1)).expect("creates");
    std::fs::write(place.path().join("state/cases/notes.txt"), "").expect("writes");
    assert_eq!(store.names().expect("names"), ["A", "b"]);
    let error = store.read("c").expect_err("unknown").to_string();
    assert!(error.contains("`c`") && error.contains("A, b"), "{error}");
}

#[test]
fn unknown_keys_are_refused_before_anything_is_written() {
    let (_place, store) = store();
    let error = store
        .create("a", "name = \"a\"\nsuppuration = true\n")
        .expect_err("an unknown key")
        .to_string();
    assert!(
        error.contains("suppuration") && error.contains("line 2"),
        "{error}"
    );
    assert!(store.names().expect("names").is_empty());
}

#[test]
fn a_case_of_a_plan_stays_until_the_plan_is_another() {
    let (_place, store) = store();
    store.create("used", &text(7)).expect("creates");
    store.create("used-too", &text(7)).expect("creates");
    keep_scene(&store, "used");
    let station = |name: &str| Station {
        name: name.into(),
        plan: crate::plan::Plan::default(),
    };
    let mut book = PlanBook::open(&[station("chair-1")], Some(store.state())).expect("plans");
    let change = PlanChange {
        scene: Some(store.scene("used")),
        ..PlanChange::default()
    };
    book.set("chair-1", &change, "test", None, 1).expect("sets");
    let error = store.remove("used").expect_err("in use").to_string();
    assert!(error.contains("chair-1"), "{error}");
    assert!(store.scene("used").exists() && store.patient("used").exists());
    store
        .remove("used-too")
        .expect("a free one with a similar name");
    book.reset("chair-1", "test", None, 2).expect("resets");
    std::fs::write(store.file("used", "above.png"), "").expect("writes");
    store.remove("used").expect("free now");
    let left: Vec<_> = std::fs::read_dir(store.folder.path())
        .expect("lists")
        .filter_map(|entry| entry.ok()?.file_name().into_string().ok())
        .filter(|name| !name.ends_with(".lock"))
        .collect();
    assert!(left.is_empty(), "{left:?}");
}

#[test]
fn a_removed_case_gets_no_scene_of_a_compilation_that_ends_later() {
    let (_place, store) = store();
    store.create("a", &text(1)).expect("creates");
    let late = status(&store, "a");
    store.remove("a").expect("removes");
    store.keep("a", b"scene", &late).expect_err("removed");
    assert!(!store.scene("a").exists());
}

#[test]
fn a_recording_gets_the_patient_of_the_scene_that_was_compiled() {
    let (_place, store) = store();
    let first = store.create("a", &text(1)).expect("creates");
    keep_scene(&store, "a");
    store
        .write("a", &first.version, &text(2))
        .expect("a later change");
    let scene = store.scene("a");
    assert_eq!(patient_of(&scene, b"scene"), Some(text(1)));
    assert_eq!(patient_of(&scene, b"other"), None, "another scene");
    assert_eq!(patient_of(&scene.with_file_name("b.scene"), b"scene"), None);
}
