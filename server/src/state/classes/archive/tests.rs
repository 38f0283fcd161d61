//! Archived classes: the record, names that are used again, memberships, and older files.

use super::super::change::Target;
use super::super::parse;
use super::*;
use crate::state::folder::fresh;

const DAY: u64 = 86_400;
const NOW: u64 = 1_795_651_200;

fn classes() -> (tempfile::TempDir, Classes) {
    let (place, folder) = fresh();
    let classes = Classes::of(&folder, "t-1");
    classes
        .import(b"learner,class\ns-1,Year 4\ns-2,Year 4\n", "", None, NOW)
        .expect("imports");
    (place, classes)
}

fn span(roll: &Roll, learner: &str) -> Vec<(String, u64, u64)> {
    let own = roll.memberships().into_iter();
    let own = own.filter(|one| one.learner == learner);
    own.map(|one| (one.class, one.from_unix_s, one.until_unix_s))
        .collect()
}

#[test]
fn the_next_year_may_use_the_name_and_the_learners_again() {
    let (_place, classes) = classes();
    classes.archive("c-1", NOW + DAY).expect("archives");
    let roll = classes.roll().expect("reads");
    assert!(roll.class_named("Year 4").is_none());
    assert_eq!(
        roll.class_label("c-1").as_deref(),
        Some("Year 4 (until 2026-11-27)")
    );
    let table = b"learner,class\ns-1,Year 4\ns-3,Year 4\n";
    classes
        .import(table, "", None, NOW + 2 * DAY)
        .expect("imports");
    let roll = classes.roll().expect("reads");
    assert_eq!(
        roll.class_named("Year 4").map(|one| one.id.as_str()),
        Some("c-2")
    );
    assert_eq!(
        roll.archived[0].learners,
        ["s-1", "s-2"],
        "the record stays"
    );
    // A session belongs to one class.
    let first = NOW + DAY;
    let present = |from| ("c-2".to_owned(), from, u64::MAX);
    let former = ("c-1".to_owned(), 0, first);
    assert_eq!(span(&roll, "s-1"), [former.clone(), present(first)]);
    assert_eq!(span(&roll, "s-2"), [former]);
    assert_eq!(span(&roll, "s-3"), [present(0)]);
    classes.archive("c-2", NOW + 3 * DAY).expect("archives");
    let roll = classes.roll().expect("reads");
    assert_eq!(
        span(&roll, "s-1")[1],
        ("c-2".to_owned(), first, NOW + 3 * DAY)
    );
}

#[test]
fn an_archived_class_has_no_codes_and_its_sessions_can_be_corrected_and_erased() {
    let (_place, classes) = classes();
    let class = Target::Class("c-1".into());
    let made = classes.make_codes(&class, 24, NOW).expect("makes");
    classes.archive("c-1", NOW).expect("archives");
    classes.archive("c-1", NOW + 1).expect("a second time");
    let roll = classes.roll().expect("reads");
    assert_eq!(
        roll.archived[0].archived_unix_s, NOW,
        "the first date stays"
    );
    assert_eq!(classes.of_code(&made[0].code, NOW).expect("reads"), None);
    classes.make_codes(&class, 1, NOW).expect_err("no codes");
    classes.seat("a", "s-1", NOW).expect_err("no seats");
    classes
        .assign(&class, None, true, NOW)
        .expect_err("no plans");
    classes
        .reassign("x.mcap", "s-2", "wrong seat", NOW)
        .expect("an entry");
    assert!(classes.forget("s-2", NOW).expect("erases"));
    let roll = classes.roll().expect("reads");
    assert_eq!(roll.archived[0].learners, ["s-1"]);
    classes.archive("c-9", NOW).expect_err("unknown");
}

#[test]
fn days_are_set_for_present_and_archived_classes_and_an_unchanged_value_has_no_entry() {
    let (_place, classes) = classes();
    classes.keep_recordings("c-1", Some(400)).expect("sets");
    classes.archive("c-1", NOW).expect("archives");
    let days = || classes.roll().expect("reads").archived[0].keep_recordings_days;
    assert_eq!(days(), Some(400));
    classes.keep_recordings("c-1", Some(30)).expect("sets");
    classes.keep_recordings("c-1", Some(30)).expect("sets");
    assert_eq!(days(), Some(30));
    classes.keep_recordings("c-2", None).expect_err("unknown");
    let log = classes.audit().newest(2).expect("reads");
    let acts: Vec<&str> = log.iter().map(|one| one.object.as_str()).collect();
    assert_eq!(acts[0], "class c-1: 30 days");
    assert_eq!(log[1].action, "archive class", "{acts:?}");
}

#[test]
fn a_file_without_archived_classes_is_that_of_older_programs() {
    let (_place, classes) = classes();
    let path = classes.folder().file("classes.json");
    let text = std::fs::read_to_string(&path).expect("reads");
    for word in ["archived", "keep_recordings_days"] {
        assert!(!text.contains(word), "{text}");
    }
    let bad = text.replace("\"seats\": []", "\"seats\": [], \"archived\": [{\"id\": \"c-0\", \"name\": \"\", \"made_unix_s\": 1, \"archived_unix_s\": 2, \"by\": \"t-1\", \"learners\": []}]");
    assert_ne!(bad, text);
    assert!(parse(bad.as_bytes()).expect_err("no name").contains("name"));
}
