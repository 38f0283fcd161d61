//! Classes in a state folder: imports that can be repeated, tasks, exams, seats.

use std::os::unix::fs::PermissionsExt as _;

use proptest::prelude::*;
use sulcus_sessions::Mode;

use super::change::Target;
use super::import::{Row, Verdict, apply, parse};
use super::task::{Wanted, seating};
use super::*;
use crate::plan::Plan;
use crate::plan::PlanChange;
use crate::state::folder::fresh;

const NOW: u64 = 1_795_651_200;
const ROSTER: &str = "sourcedId,givenName,familyName,username,email,class\n\
    100,Zoë,O'Neill,zoe,zoe@school.example,Year 4 A\n\
    101,Jan,\"van den Berg, Jr\",jan,,Year 4 A\n\
    102,Mei,Li,mei,,Year 4 B\n";

fn classes() -> (tempfile::TempDir, Classes) {
    let (place, folder) = fresh();
    (place, Classes::of(&folder, "t-1"))
}

fn words(report: &import::Report) -> Vec<&'static str> {
    report
        .lines
        .iter()
        .map(|line| line.verdict.word())
        .collect()
}

fn class_of(classes: &Classes, name: &str) -> Target {
    let roll = classes.roll().expect("reads");
    Target::Class(roll.class_named(name).expect(name).id.clone())
}

fn wanted(mode: Mode) -> Wanted {
    Wanted {
        exercise: "probing".into(),
        case: None,
        mode,
        time_limit_s: Some(600),
    }
}

#[test]
fn a_roster_is_imported_once_and_names_stand_in_the_key_table_alone() {
    let (_place, classes) = classes();
    let dry = classes
        .examine(ROSTER.as_bytes(), "", NOW)
        .expect("examines");
    assert_eq!(words(&dry), ["new", "new", "new"]);
    assert_eq!(dry.new_classes, ["Year 4 A", "Year 4 B"]);
    assert_eq!(classes.load().expect("reads"), Book::default(), "a dry run");
    let first = classes.import(ROSTER.as_bytes(), "", Some(&dry.hash), NOW);
    assert_eq!(words(&first.expect("imports")), ["new", "new", "new"]);
    let book = classes.load().expect("reads");
    let again = classes
        .import(ROSTER.as_bytes(), "", None, NOW + 1)
        .expect("imports");
    assert_eq!(words(&again), ["kept", "kept", "kept"]);
    assert_eq!(classes.load().expect("reads"), book);
    let folder = classes.folder();
    let list = std::fs::read_to_string(folder.file(FILE)).expect("reads");
    let names = std::fs::read_to_string(folder.file(names::FILE)).expect("reads");
    for word in ["Zo", "Neill", "zoe", "100"] {
        assert!(!list.contains(word) && names.contains(word), "{word}");
    }
    assert!(!names.contains("example"), "no address is kept");
    for file in [FILE, names::FILE, "audit.jsonl"] {
        let mode = std::fs::metadata(folder.file(file))
            .expect(file)
            .permissions()
            .mode();
        assert_eq!(mode & 0o777, 0o600, "{file}");
    }
    let log = std::fs::read_to_string(folder.file("audit.jsonl")).expect("reads");
    assert!(
        log.contains("import roster") && !log.contains("Neill"),
        "{log}"
    );
}

#[test]
fn a_report_that_no_longer_holds_is_not_carried_out() {
    let (_place, classes) = classes();
    let dry = classes
        .examine(ROSTER.as_bytes(), "", NOW)
        .expect("examines");
    let other = "learner,class\ns-1,Year 4 A\n";
    classes
        .import(other.as_bytes(), "", None, NOW)
        .expect("imports");
    // The lines are as before, and the other class does not matter to them.
    let hash = Some(dry.hash.as_str());
    classes
        .import(ROSTER.as_bytes(), "", hash, NOW)
        .expect("imports");
    let told = classes.import(ROSTER.as_bytes(), "", hash, NOW);
    assert!(matches!(told, Err(ClassError::Changed(_))), "{told:?}");
}

#[test]
fn every_verdict_names_its_reason() {
    let (_place, classes) = classes();
    classes
        .import(ROSTER.as_bytes(), "", None, NOW)
        .expect("imports");
    let id = classes.load().expect("reads").names.people[1]
        .learner
        .clone();
    let next = format!(
        "sourcedId;learner;givenName;familyName;username;class\r\n\
         100;;Zoë;Smith;zoe;Year 4 A\r\n\
         101;{id};;;;Year 4 B\r\n\
         102;;Mei;Li;mei;Year 4 B\r\n\
         103;;;;;\r\n\
         ;;Only;Name;;Year 4 A\r\n\
         104;Jane Doe;;;;Year 4 A\r\n\
         105;;;;ZOE;Year 4 A\r\n\
         102;;;;zoe;Year 4 A\r\n\
         106;code-123456;;;;Year 4 A\r\n\
         102;;;;;Year 4 B\r\n\
         107;;{};;;Year 4 A\r\n\
         108;;<b>x</b>;;;Year 4 C\r\n",
        "x".repeat(65)
    );
    let report = classes
        .import(next.as_bytes(), "", None, NOW)
        .expect("imports");
    let expected = [
        ("renamed", "was Zoë O'Neill"),
        ("moved", "was in Year 4 A"),
        ("kept", ""),
        ("refused", "class is ``"),
        ("refused", "learner, sourcedId and username are empty"),
        ("refused", "learner is `Jane Doe`"),
        ("refused", "sourcedId is `105`, expected `100`"),
        (
            "refused",
            "sourcedId and username belong to different learners",
        ),
        ("refused", "that of a code"),
        ("refused", "line 4 has the same"),
        ("refused", "givenName is"),
        ("new", ""),
    ];
    assert_eq!(report.lines.len(), expected.len());
    for (line, (word, part)) in report.lines.iter().zip(expected) {
        let told = line.to_string();
        assert_eq!(line.verdict.word(), word, "{told}");
        assert!(line.verdict.details().contains(part), "{part}: {told}");
        assert!(!told.contains('\n'));
    }
    assert_eq!(report.lines[0].line, 2);
    assert_eq!(
        (report.new_classes.as_slice(), report.absent),
        (&["Year 4 C".to_owned()][..], 0)
    );
}

#[test]
fn tables_of_spreadsheets_and_of_stations_are_read() {
    let rows = |bytes: &[u8]| parse(bytes).expect("a table");
    let windows = b"\xef\xbb\xbfSourced ID;Given Name;Class\r\n7;Zo\xc3\xab;A\r\n";
    assert_eq!(rows(windows)[0].given, "Zoë");
    assert_eq!(rows(b"username\tgiven_name\nzoe\tZo\xeb\n")[0].given, "Zoë");
    let stations = rows(b"id,station\n'007,room3-1\n");
    assert_eq!((stations[0].learner.as_str(), stations[0].line), ("007", 2));
    // The id of a school is no learner id.
    assert_eq!(rows(b"id,sourcedId\n55,x\n")[0].learner, "");
    let told = parse(b"name,room\nx,y\n").expect_err("no id");
    assert!(
        told.contains("line 1") && told.contains("`sourcedId`"),
        "{told}"
    );
    assert!(parse(&vec![b'x'; import::MOST_BYTES + 1]).is_err());
}

#[test]
fn without_the_key_table_a_roster_with_names_is_refused() {
    let (_place, classes) = classes();
    classes
        .import(ROSTER.as_bytes(), "", None, NOW)
        .expect("imports");
    let table = classes.folder().file(names::FILE);
    std::fs::rename(&table, classes.folder().file("aside.json")).expect("moves");
    let told = classes
        .examine(ROSTER.as_bytes(), "", NOW)
        .expect_err("closed")
        .to_string();
    assert!(told.contains("names.json"), "{told}");
    let ids = classes
        .import(b"learner\ns-9\n", "Year 4 A", None, NOW)
        .expect("imports");
    assert_eq!(words(&ids), ["new"]);
    assert!(!table.exists());
    let book = classes.load().expect("reads");
    assert!(!book.names.is_open && book.roll.learners.len() == 4);
}

#[test]
fn a_class_is_made_renamed_and_removed_and_a_learner_keeps_the_id() {
    let (_place, classes) = classes();
    let id = classes.make(" Autumn ", NOW).expect("makes");
    for (name, named) in [
        ("autumn", "taken"),
        ("", "class is ``"),
        ("a\nb", "class is `a\\nb`"),
    ] {
        let told = classes.make(name, NOW).expect_err(name).to_string();
        assert!(told.contains(named), "{told}");
    }
    classes
        .rename(&id, "AUTUMN")
        .expect("other capitals of the same name");
    let row = Row {
        given: "Ada".into(),
        username: "ada".into(),
        ..Row::default()
    };
    let added = classes.add(&id, &row, NOW).expect("adds");
    assert_eq!(added.verdict, Verdict::New);
    classes
        .drop_from(&id, &added.learner, NOW)
        .expect("removes");
    classes
        .drop_from(&id, &added.learner, NOW)
        .expect_err("not there");
    assert_eq!(
        classes.add(&id, &row, NOW).expect("adds").learner,
        added.learner
    );
    classes.remove(&id, false, NOW).expect("removes");
    let book = classes.load().expect("reads");
    assert!(book.roll.classes.is_empty() && book.roll.learners.is_empty());
    assert_eq!(book.names.name_of(&added.learner).as_deref(), Some("Ada"));
    assert_eq!(
        classes.make("Autumn", NOW).expect("makes"),
        "c-2",
        "an id is used once"
    );
    assert!(classes.forget(&added.learner, NOW).expect("erases"));
    assert!(!classes.forget(&added.learner, NOW).expect("erases"));
    assert!(classes.load().expect("reads").names.people.is_empty());
}

#[test]
fn the_task_of_a_learner_precedes_that_of_the_class_and_becomes_a_plan() {
    let (_place, classes) = classes();
    classes
        .import(ROSTER.as_bytes(), "", None, NOW)
        .expect("imports");
    let roll = classes.roll().expect("reads");
    let (one, two) = (roll.learners[0].id.clone(), roll.learners[1].id.clone());
    let class = class_of(&classes, "Year 4 A");
    let plan = |learner: &str| {
        let roll = classes.roll().expect("reads");
        let seating = seating(&roll, learner, classes.folder()).expect("a learner");
        let before: PlanChange =
            crate::exact::read("exercise = \"crown\"\ntime_limit_s = 9\nforce_limit_n = 2.0")
                .expect("a plan");
        let plan = Plan::of(&before).and_then(|plan| plan.with(&seating.change));
        (plan.expect("fits"), seating.exams)
    };
    let (before, exams) = plan(&one);
    assert_eq!(
        (before.exercise.as_str(), before.learner.as_str(), exams),
        ("crown", &*one, true)
    );
    assert_eq!(before.time_limit_s, Some(9), "the station's own plan");
    let cases = classes.folder().file("cases");
    std::fs::create_dir(&cases).expect("makes");
    std::fs::write(cases.join("case3.scene"), "").expect("writes");
    std::fs::write(cases.join("case3.toml"), "").expect("writes");
    assert_eq!(task::cases(classes.folder()).expect("lists"), ["case3"]);
    classes
        .assign(&class, Some(&wanted(Mode::Practice)), false, NOW)
        .expect("assigns");
    let own = Wanted {
        case: Some("case3".into()),
        time_limit_s: None,
        ..wanted(Mode::SelfAssessment)
    };
    classes
        .assign(&Target::Learner(two.clone()), Some(&own), false, NOW)
        .expect("assigns");
    let (first, exams) = plan(&one);
    assert_eq!(
        (first.exercise.as_str(), first.mode, exams),
        ("probing", Mode::Practice, false)
    );
    assert_eq!(
        (first.time_limit_s, first.force_limit_n),
        (Some(600), Some(2.0))
    );
    let (second, _) = plan(&two);
    assert_eq!(
        (second.mode, second.time_limit_s),
        (Mode::SelfAssessment, None)
    );
    assert_eq!(second.scene, Some(cases.join("case3.scene")));
    classes
        .assign(&Target::Learner(two.clone()), None, false, NOW)
        .expect("takes away");
    assert_eq!(plan(&two).0.scene, None);
    for (wrong, named) in [
        (
            Wanted {
                exercise: "juggling".into(),
                ..own.clone()
            },
            "exercise is `juggling`",
        ),
        (
            Wanted {
                case: Some("../x".into()),
                ..own.clone()
            },
            "case is `../x`, expected one of case3",
        ),
        (
            Wanted {
                time_limit_s: Some(0),
                ..own.clone()
            },
            "time_limit_s is `0`",
        ),
        (
            Wanted {
                exercise: "free".into(),
                mode: Mode::Exam,
                ..own
            },
            "with a grade",
        ),
    ] {
        let told = classes
            .assign(&class, Some(&wrong), true, NOW)
            .expect_err(named)
            .to_string();
        assert!(told.contains(named), "{told}");
    }
    let nobody = Target::Learner("s-0".into());
    assert!(matches!(
        classes.assign(&nobody, None, true, NOW),
        Err(ClassError::Unknown(_))
    ));
}

#[test]
fn an_exam_needs_the_right_and_has_its_recordings_from_its_begin_to_its_end() {
    let (_place, classes) = classes();
    classes
        .import(ROSTER.as_bytes(), "", None, NOW)
        .expect("imports");
    let class = class_of(&classes, "Year 4 A");
    let learner = classes.roll().expect("reads").learners[0].id.clone();
    let forbidden = |told: Result<(), ClassError>| {
        assert!(matches!(told, Err(ClassError::Forbidden(_))), "{told:?}");
    };
    let exam = wanted(Mode::Exam);
    forbidden(classes.assign(&class, Some(&exam), false, NOW));
    classes
        .assign(&class, Some(&exam), true, NOW)
        .expect("assigns");
    // The same exam again is no other one.
    classes
        .assign(&class, Some(&exam), true, NOW + 9)
        .expect("assigns");
    forbidden(classes.assign(&class, None, false, NOW + 10));
    let own = Target::Learner(learner.clone());
    forbidden(classes.assign(&own, Some(&wanted(Mode::Practice)), false, NOW + 10));
    forbidden(classes.remove(class.id(), false, NOW + 10));
    classes
        .import(b"learner\ns-late-1\n", "Year 4 A", None, NOW + 10)
        .expect("imports");
    let told = classes
        .release("e-1", NOW + 10)
        .expect_err("still the plan")
        .to_string();
    assert!(told.contains("still the present plan"), "{told}");
    classes.assign(&class, None, true, NOW + 100).expect("ends");
    let roll = classes.roll().expect("reads");
    for (who, at, expected) in [
        (learner.as_str(), NOW - 1, None),
        (learner.as_str(), NOW, Some("e-1")),
        ("s-late-1", NOW + 99, Some("e-1")),
        (learner.as_str(), NOW + 100, None),
        (roll.learners[2].id.as_str(), NOW + 50, None),
    ] {
        let found = roll.exam_of(who, at).map(|exam| exam.id.as_str());
        assert_eq!(found, expected, "{who} {at}");
    }
    classes.seal("e-1", Some(NOW + 500)).expect("seals");
    classes.release("e-1", NOW + 200).expect("releases");
    classes.seal("e-1", None).expect_err("released");
    classes.seal("e-7", None).expect_err("unknown");
    let released = classes.roll().expect("reads").exams[0].released.clone();
    assert_eq!(released.expect("released").unix_s, NOW + 200);
}

#[test]
fn codes_seats_and_other_learners_of_a_session_are_kept() {
    let (_place, classes) = classes();
    classes
        .import(ROSTER.as_bytes(), "", None, NOW)
        .expect("imports");
    let class = class_of(&classes, "Year 4 A");
    classes.make_codes(&class, 0, NOW).expect_err("no hours");
    let made = classes.make_codes(&class, 2, NOW).expect("makes");
    assert_eq!(made.len(), 2);
    let of = |code: &str, at| classes.of_code(code, at).expect("reads");
    assert_eq!(of(&made[1].code, NOW + 7199), Some(made[1].learner.clone()));
    assert_eq!(of(&made[1].code, NOW + 7200), None);
    let text = std::fs::read_to_string(classes.folder().file(FILE)).expect("reads");
    assert!(made.iter().all(|one| !text.contains(&one.code)), "{text}");
    classes
        .seat("room3-1", &made[0].learner, NOW)
        .expect("seats");
    classes
        .seat("room3-1", &made[1].learner, NOW + 1)
        .expect("seats");
    classes
        .seat("room3-1", "s-none-0", NOW)
        .expect_err("unknown");
    let seats = classes.roll().expect("reads").seats;
    assert_eq!((seats.len(), &seats[0].learner), (1, &made[1].learner));
    let file = "2026-11-27T10-00-00Z-probing.mcap";
    assert_eq!(classes.learner_of(file).expect("reads"), None);
    for one in &made {
        classes
            .reassign(file, &one.learner, "sat at the wrong station", NOW)
            .expect("writes");
    }
    assert_eq!(
        classes.learner_of(file).expect("reads"),
        Some(made[1].learner.clone())
    );
    assert_eq!(classes.reassigned().expect("reads").len(), 2);
    for (recording, learner, why) in [
        ("../x.mcap", made[0].learner.as_str(), "w"),
        (file, "s-none-0", "w"),
        (file, made[0].learner.as_str(), " "),
        (file, made[0].learner.as_str(), "a\nb"),
    ] {
        classes
            .reassign(recording, learner, why, NOW)
            .expect_err(recording);
    }
}

#[test]
fn a_file_of_another_version_or_with_broken_links_is_refused() {
    for (text, named) in [
        (
            r#"{"version":2,"last_class":0,"last_exam":0,"has_names":false,"classes":[],"learners":[],"exams":[],"seats":[]}"#,
            "version is 2",
        ),
        (
            r#"{"version":1,"last_class":0,"last_exam":0,"has_names":false,"classes":[],"learners":[{"id":"s-1","class":"c-9"}],"exams":[],"seats":[]}"#,
            "`c-9`",
        ),
        (r#"{"version":1,"classes":[],"more":1}"#, "more"),
    ] {
        let told = super::parse(text.as_bytes()).expect_err(text);
        assert!(told.contains(named), "{told}");
    }
}

/// Rows of few persons and classes, so that they meet.
fn row() -> impl Strategy<Value = Row> {
    let pool = |all: &'static [&'static str]| prop::sample::select(all);
    (
        pool(&["", "", "s-1", "s-2", "jane", "code-111111"]),
        pool(&["", "1", "2", "3"]),
        pool(&["", "ada", "Ada", "bob"]),
        pool(&["", "Ada", "Bob", "<b>"]),
        pool(&["", "A", "a", "B", "C\n"]),
    )
        .prop_map(|(learner, sourced_id, username, given, class)| Row {
            line: 2,
            learner: learner.into(),
            sourced_id: sourced_id.into(),
            username: username.into(),
            given: given.into(),
            family: String::new(),
            class: class.into(),
        })
}

proptest! {
    #[test]
    fn no_bytes_panic(bytes in prop::collection::vec(any::<u8>(), 0..200), text in "(id|learner|sourcedId|username),(class|givenName)\n[s0-9,\"\n;éa-]{0,80}") {
        for bytes in [&bytes[..], text.as_bytes()] {
            let _ = super::parse(bytes);
            if let Ok(rows) = parse(bytes) {
                let mut book = Book::default();
                let lines = apply(&mut book, &rows, "A", &mut import::draw, NOW).expect("open");
                prop_assert_eq!(lines.len(), rows.len());
                prop_assert!(lines.iter().all(|line| !line.to_string().contains('\n')));
            }
        }
    }

    #[test]
    fn a_roster_imported_twice_is_a_roster_imported_once(before in prop::collection::vec(row(), 0..8), rows in prop::collection::vec(row(), 0..12)) {
        let mut book = Book::default();
        book.names.is_open = true;
        apply(&mut book, &before, "A", &mut import::draw, NOW).expect("applies");
        let first = apply(&mut book, &rows, "A", &mut import::draw, NOW).expect("applies");
        let once = book.clone();
        let second = apply(&mut book, &rows, "A", &mut import::draw, NOW).expect("applies");
        prop_assert_eq!(&book, &once);
        for (first, second) in first.iter().zip(&second) {
            let is_refused = first.verdict.word() == "refused";
            prop_assert_eq!(second.verdict.word(), if is_refused { "refused" } else { "kept" });
        }
        // Nobody is in the list twice, and no person has two ids.
        let mut ids: Vec<&str> = book.roll.learners.iter().map(|one| one.id.as_str()).collect();
        ids.sort_unstable();
        ids.dedup();
        prop_assert_eq!(ids.len(), book.roll.learners.len());
        for field in [|one: &Person| one.sourced_id.clone(), |one: &Person| one.username.to_lowercase()] {
            let mut all: Vec<String> = book.names.people.iter().map(field).filter(|text| !text.is_empty()).collect();
            let count = all.len();
            all.sort();
            all.dedup();
            prop_assert_eq!(all.len(), count);
        }
        let bytes = serde_json::to_vec(&book.roll).expect("writes");
        prop_assert_eq!(super::parse(&bytes).expect("reads"), book.roll);
    }
}
