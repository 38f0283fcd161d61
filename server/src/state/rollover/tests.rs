//! End of a school year: what ends, what stays, what is refused, and the completeness of the audit log.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::path::PathBuf;

use sulcus_proto::Role;
use sulcus_sessions::Mode;

use super::super::classes::change::Target;
use super::super::classes::task::Wanted;
use super::super::date::DAY_S;
use super::super::folder::fresh;
use super::super::tokens::{NewToken, Place, Tokens};
use super::*;

const NOW: u64 = 1_795_651_200;
const ROSTER: &str = "sourcedId,givenName,familyName,class\n\
    1,Zoë,O'Neill,Year 4\n2,Mei,Li,Year 4\n3,Ida,Roe,Year 5\n";

/// Stations of a test: sessions, plans, and the plans that were ended.
#[derive(Default)]
struct Fake {
    sessions: Vec<Sitting>,
    plans: Vec<Sitting>,
    ended: RefCell<Vec<(String, bool)>>,
}

impl Stations for Fake {
    fn sessions(&self) -> Result<Vec<Sitting>, String> {
        Ok(self.sessions.clone())
    }

    fn plans(&self) -> Result<Vec<Sitting>, String> {
        Ok(self.plans.clone())
    }

    fn end_plan(&self, station: &str, whole: bool) -> Result<(), String> {
        self.ended.borrow_mut().push((station.into(), whole));
        Ok(())
    }
}

/// A school with two classes; the first has plans, codes, a seat and tokens.
struct School {
    place: tempfile::TempDir,
    folder: StateFolder,
    classes: Classes,
    /// Learners of the first class, then that of the second one.
    learners: Vec<String>,
    /// Secrets of the tokens of the same learners, then that of an instructor.
    secrets: Vec<String>,
}

fn wanted(mode: Mode) -> Wanted {
    Wanted {
        exercise: "probing".into(),
        case: None,
        mode,
        time_limit_s: None,
    }
}

impl School {
    fn new() -> Self {
        let (place, folder) = fresh();
        let classes = Classes::of(&folder, "t-1");
        classes
            .import(ROSTER.as_bytes(), "", None, NOW)
            .expect("imports");
        let roll = classes.roll().expect("reads");
        let learners: Vec<String> = roll.learners.iter().map(|one| one.id.clone()).collect();
        let class = Target::Class("c-1".into());
        let practice = wanted(Mode::Practice);
        classes
            .assign(&class, Some(&practice), true, NOW)
            .expect("assigns");
        classes
            .make_codes(&class, 24, NOW)
            .expect("makes two codes");
        classes
            .seat("room3-1", &learners[0], NOW)
            .expect("a seat with a task");
        let student = |learner: &String| NewToken {
            role: Role::Student,
            station: Place::Station("room3-1".into()),
            learner: learner.clone(),
            class: String::new(),
            expires_unix_s: NOW + 400 * DAY_S,
        };
        let teacher = NewToken {
            role: Role::Instructor,
            station: Place::Any,
            learner: String::new(),
            class: "Year 4".into(),
            expires_unix_s: NOW + 400 * DAY_S,
        };
        let asked: Vec<NewToken> = learners.iter().map(student).chain([teacher]).collect();
        let made = TokenStore::of(&folder).add(&asked, NOW).expect("makes");
        let secrets = made.iter().map(|(_, secret)| secret.reveal().to_owned());
        Self {
            secrets: secrets.collect(),
            learners,
            classes,
            folder,
            place,
        }
    }

    fn backup(&self, name: &str) -> PathBuf {
        self.place.path().join(name)
    }

    fn log(&self) -> Vec<(String, String)> {
        let mut all = self.classes.audit().newest(1000).expect("reads");
        all.reverse();
        all.into_iter()
            .map(|one| (one.action, one.object))
            .collect()
    }

    /// Content of every file of the state folder.
    fn bytes(&self) -> BTreeMap<PathBuf, Vec<u8>> {
        let mut all = BTreeMap::new();
        let mut open = vec![self.folder.path().to_owned()];
        while let Some(folder) = open.pop() {
            for entry in std::fs::read_dir(&folder).expect("lists") {
                let path = entry.expect("an entry").path();
                if path.is_dir() {
                    open.push(path.clone());
                    all.insert(path, Vec::new());
                } else {
                    let bytes = std::fs::read(&path).expect("reads");
                    all.insert(path, bytes);
                }
            }
        }
        all
    }
}

fn named(name: &str) -> Chosen {
    Chosen::Named(vec![name.into()])
}

fn seated(station: &str, learner: &str) -> Sitting {
    Sitting {
        station: station.into(),
        learner: learner.into(),
    }
}

#[test]
fn a_class_ends_with_its_tokens_codes_seats_and_plans_and_each_action_has_an_entry() {
    let school = School::new();
    let fake = Fake {
        plans: vec![
            seated("room3-1", &school.learners[0]),
            seated("room3-2", &school.learners[1]),
            seated("room3-3", &school.learners[2]),
        ],
        ..Fake::default()
    };
    let rollover = Rollover::of(&school.folder, "shell (uid 0)", &fake);
    let (before, names) = (
        school.log().len(),
        std::fs::read(school.folder.file("names.json")),
    );
    let backup = school.backup("year.backup");
    let report = rollover
        .carry_out(&named("year 4"), &backup, NOW + 5)
        .expect("archives");
    let acts: Vec<(String, String)> = report.steps[0]
        .acts()
        .map(|(action, object)| ((*action).to_owned(), object.clone()))
        .collect();
    // The log has the backup, and every action of the report in its order.
    let log = school.log();
    assert_eq!(log[before], ("backup".into(), "year.backup".into()));
    assert_eq!(log[before + 1..], acts);
    let count = |action: &str| acts.iter().filter(|(found, _)| found == action).count();
    let counts = [
        "revoke token",
        "end plan",
        "end code",
        "end seat",
        "archive class",
    ]
    .map(count);
    assert_eq!(counts, [2, 3, 2, 1, 1], "{acts:?}");
    assert_eq!(
        fake.ended.borrow()[..],
        [("room3-1".to_owned(), true), ("room3-2".to_owned(), false)]
    );
    // The tokens of the class open nothing; those of others stay.
    let tokens = Tokens::open(&school.folder).expect("reads");
    let is_open = |secret: &String| tokens.grant(secret, NOW + 5).is_ok();
    let open: Vec<bool> = school.secrets.iter().map(is_open).collect();
    assert_eq!(open, [false, false, true, true]);
    // The record stays, and the names stay.
    let roll = school.classes.roll().expect("reads");
    assert_eq!(roll.archived[0].learners, school.learners[..2]);
    assert_eq!(
        (roll.classes.len(), roll.learners.len(), roll.seats.len()),
        (1, 1, 0)
    );
    let after = std::fs::read(school.folder.file("names.json"));
    assert_eq!(after.expect("there"), names.expect("there"));
    assert!(backup.is_file());
}

#[test]
fn a_second_call_and_a_dry_run_change_no_byte() {
    let school = School::new();
    let fake = Fake::default();
    let rollover = Rollover::of(&school.folder, "shell (uid 0)", &fake);
    let before = school.bytes();
    let dry = rollover.report(&Chosen::All, NOW).expect("a report");
    assert_eq!(dry.steps.len(), 2);
    assert_eq!(school.bytes(), before, "a dry run");
    let first = rollover.carry_out(&Chosen::All, &school.backup("one"), NOW);
    assert_eq!(first.expect("archives"), dry);
    let before = school.bytes();
    let second = rollover.carry_out(&named("Year 4"), &school.backup("two"), NOW + 9);
    let second = second.expect("nothing to do");
    assert!(second.steps.is_empty());
    assert_eq!(second.already[0].0, "c-1");
    assert_eq!(school.bytes(), before, "a second call");
    assert!(!school.backup("two").exists(), "no backup of nothing");
    let none = rollover.carry_out(&Chosen::All, &school.backup("two"), NOW + 9);
    assert_eq!(none.expect("nothing"), Report::default());
}

#[test]
fn a_session_or_an_undecided_exam_is_in_the_way_and_nothing_changes() {
    let school = School::new();
    let backup = school.backup("year.backup");
    let busy = Fake {
        sessions: vec![seated("room3-2", &school.learners[1])],
        ..Fake::default()
    };
    let refused = |fake: &Fake, now_s: u64| {
        let rollover = Rollover::of(&school.folder, "t-9", fake);
        let before = school.bytes();
        let error = rollover.carry_out(&Chosen::All, &backup, now_s);
        assert_eq!(school.bytes(), before, "unchanged");
        assert!(!backup.exists());
        error.expect_err("refused").to_string()
    };
    let why = refused(&busy, NOW);
    assert!(
        why.contains("room3-2") && why.contains(&school.learners[1]),
        "{why}"
    );
    let free = Fake::default();
    let assign = |target: &Target, mode: Option<Mode>| {
        let wanted = mode.map(wanted);
        let assigned = school.classes.assign(target, wanted.as_ref(), true, NOW);
        assigned.expect("assigns");
    };
    // An exam of one learner counts as those of the class.
    let learner = Target::Learner(school.learners[0].clone());
    assign(&learner, Some(Mode::Exam));
    let why = refused(&free, NOW);
    assert!(why.contains("exam e-1 is still the present plan"), "{why}");
    assign(&learner, None);
    let until = Some(NOW + 10);
    school.classes.seal("e-1", until).expect("seals");
    let why = refused(&free, NOW + 10);
    assert!(why.contains("e-1 is neither released nor sealed"), "{why}");
    // A seal without an end holds after the archiving, too.
    school.classes.seal("e-1", None).expect("seals");
    let rollover = Rollover::of(&school.folder, "t-9", &free);
    rollover
        .carry_out(&Chosen::All, &backup, NOW + 10)
        .expect("archives");
    let roll = school.classes.roll().expect("reads");
    let exam = roll.exam_of(&school.learners[0], NOW);
    assert!(exam.is_none_or(|exam| exam.is_sealed(u64::MAX)));
    assert_eq!(roll.exams.len(), 1, "exams stay");
    school
        .classes
        .release("e-1", NOW + 20)
        .expect("an exam of an archived class can be released");
}

#[test]
fn an_unknown_class_is_named_with_those_that_exist() {
    let school = School::new();
    let fake = Fake::default();
    let rollover = Rollover::of(&school.folder, "t-9", &fake);
    let error = rollover.report(&named("Year 9"), NOW).expect_err("unknown");
    let text = error.to_string();
    assert!(
        text.contains("`Year 9`") && text.contains("Year 4, Year 5"),
        "{text}"
    );
    // The same class twice is one class.
    let twice = Chosen::Named(vec!["Year 4".into(), "c-1".into()]);
    assert_eq!(rollover.report(&twice, NOW).expect("reads").steps.len(), 1);
}
