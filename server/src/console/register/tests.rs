//! The register of a state folder, through the interface of the console.

use proptest::prelude::*;
use sulcus_proto::Role;

use super::*;
use crate::plan::{Plan, PlanChange};
use crate::state::folder::fresh;
use crate::state::tokens::{NewToken, Place};

const ROSTER: &str = "sourcedId;givenName;familyName;class\n1;Ada;Lovelace;B\n2;Mei;Li;B\n";

fn register() -> (tempfile::TempDir, OwnRegister) {
    let (place, folder) = fresh();
    (place, OwnRegister::of(Some(&folder)))
}

fn imported(register: &OwnRegister) -> Class {
    let dry = register.examine(ROSTER, "").expect("examines");
    assert_eq!(dry.lines[0].verdict, "new");
    assert_eq!(register.classes().expect("reads"), []);
    register
        .import("t-1", ROSTER, "", &dry.hash)
        .expect("imports");
    let told = register.import("t-1", ROSTER, "", &dry.hash);
    assert!(matches!(told, Err(Denied::Changed(_))), "{told:?}");
    register.class("c-1").expect("a class")
}

fn holder(role: Role, id: &str) -> Holder {
    Holder {
        id: id.into(),
        role,
        station: None,
    }
}

#[test]
fn a_class_of_a_roster_gets_a_plan_codes_and_seats() {
    let (_place, register) = register();
    let class = imported(&register);
    let names: Vec<&str> = class.learners.iter().map(|one| one.name.as_str()).collect();
    assert_eq!(
        (names, class.has_names),
        (vec!["Ada Lovelace", "Mei Li"], true)
    );
    let ada = class.learners[0].id.clone();
    let task = Task {
        exercise: "probing".into(),
        mode: "practice".into(),
        time_limit_s: Some(60),
        ..Task::default()
    };
    let assign = |target: Target, task: Option<Task>, exams: bool| {
        register.change("t-1", exams, &Change::Assign { target, task })
    };
    assign(Target::Class("c-1".into()), Some(task.clone()), false).expect("assigns");
    let seating = register.seating(&ada).expect("a learner");
    let change = PlanChange::parse(&seating.text, "plan".as_ref()).expect("a change of a plan");
    let plan = Plan::of(&change).expect("a plan");
    assert_eq!((plan.exercise.as_str(), &plan.learner), ("probing", &ada));
    assert!(!seating.exams);
    let exam = Task {
        mode: "exam".into(),
        ..task.clone()
    };
    let told = assign(Target::Learner(ada.clone()), Some(exam.clone()), false);
    assert!(matches!(told, Err(Denied::Forbidden(_))), "{told:?}");
    assign(Target::Learner(ada.clone()), Some(exam), true).expect("assigns");
    assert!(register.seating(&ada).expect("a learner").exams);
    let odd = Task {
        mode: "<b>".into(),
        ..task
    };
    let told = assign(Target::Learner(ada.clone()), Some(odd), true).expect_err("odd");
    assert!(
        matches!(&told, Denied::Invalid(why) if why.contains("`<b>`")),
        "{told:?}"
    );
    let cards = register
        .make_codes("t-1", &Target::Class("c-1".into()), 4)
        .expect("makes");
    assert_eq!((cards.len(), cards[0].name.as_str()), (2, "Ada Lovelace"));
    assert!(codes::typed(&cards[0].code).is_some());
    let seated = Change::Seated {
        station: "room3-1".into(),
        learner: ada.clone(),
    };
    register.change("t-1", false, &seated).expect("seats");
    let class = register.class("c-1").expect("a class");
    assert_eq!(class.learners[0].station, "room3-1");
    assert!(!class.learners[0].code_until.is_empty());
    let actions: Vec<String> = register
        .audit(100)
        .expect("reads")
        .into_iter()
        .map(|one| one.action)
        .collect();
    assert_eq!(
        actions,
        [
            "seat",
            "make codes",
            "assign plan",
            "assign plan",
            "import roster"
        ]
    );
}

#[test]
fn a_sealed_exam_opens_by_its_date_and_its_release_for_the_own_learner_alone() {
    let (_place, register) = register();
    let class = imported(&register);
    let state = register.state().expect("a folder").clone();
    let ids = [class.learners[0].id.clone(), class.learners[1].id.clone()];
    let token = |learner: &String| NewToken {
        role: Role::Student,
        station: Place::Station("room3-1".into()),
        learner: learner.clone(),
        class: String::new(),
        expires_unix_s: now_s() + 1000,
    };
    let made = TokenStore::of(&state)
        .add(&ids.each_ref().map(token), now_s())
        .expect("adds");
    let students: Vec<Holder> = made
        .iter()
        .map(|(token, _)| holder(Role::Student, &token.id))
        .collect();
    let exam = Task {
        exercise: "probing".into(),
        mode: "exam".into(),
        ..Task::default()
    };
    let target = Target::Class("c-1".into());
    let begin = Change::Assign {
        target: target.clone(),
        task: Some(exam),
    };
    register.change("t-1", true, &begin).expect("begins");
    let seen = [Seen {
        recording: "a.mcap".into(),
        learner: ids[0].clone(),
        is_exam: true,
        began_unix_s: now_s(),
    }];
    let sights = || {
        let all = [
            &students[0],
            &students[1],
            &holder(Role::Instructor, "t-9"),
            &holder(Role::Examiner, "t-8"),
        ];
        all.map(|one| register.may_see(one, &seen).expect("reads")[0])
    };
    assert_eq!(
        sights(),
        [Sight::Nothing, Sight::Nothing, Sight::Existence, Sight::All]
    );
    let seal = |until: &str, exams| {
        let seal = Change::Seal {
            exam: "e-1".into(),
            until: until.into(),
        };
        register.change("t-1", exams, &seal)
    };
    assert!(matches!(seal("", false), Err(Denied::Forbidden(_))));
    assert!(matches!(seal("tomorrow", true), Err(Denied::Invalid(_))));
    seal("2020-01-01", true).expect("seals");
    assert_eq!(
        sights(),
        [Sight::Nothing, Sight::Nothing, Sight::All, Sight::All]
    );
    seal("", true).expect("seals");
    let reassign = Change::Reassign {
        recording: "a.mcap".into(),
        learner: ids[1].clone(),
        why: "sat at the wrong station".into(),
    };
    register.change("t-1", false, &reassign).expect("writes");
    assert_eq!(sights()[2], Sight::Existence, "an entry opens no exam");
    std::thread::sleep(std::time::Duration::from_millis(1100));
    let end = Change::Assign { target, task: None };
    register.change("t-1", true, &end).expect("ends");
    let release = Change::Release { exam: "e-1".into() };
    register.change("t-1", true, &release).expect("releases");
    assert_eq!(
        sights(),
        [Sight::Nothing, Sight::All, Sight::All, Sight::All]
    );
    let exams = register.exams().expect("reads");
    assert_eq!((exams[0].of.as_str(), exams[0].learners), ("B", 2));
    assert!(!exams[0].released.is_empty() && !exams[0].is_sealed);
}

#[test]
fn without_a_state_folder_and_with_a_broken_file_nothing_is_told_but_the_fault() {
    let none = OwnRegister::of(None);
    assert!(matches!(none.classes(), Err(Denied::Fault(_))));
    let (_place, register) = register();
    imported(&register);
    let path = register.state().expect("a folder").file("classes.json");
    std::fs::write(path, "{\"version\":1,\"secret\":").expect("writes");
    let told = register.class("c-1").expect_err("broken");
    assert!(
        matches!(&told, Denied::Fault(why) if !why.contains("secret")),
        "{told:?}"
    );
}

proptest! {
    #[test]
    fn no_text_of_a_person_panics(name in "\\PC{0,80}|.{0,80}", id in ".{0,40}", text in ".{0,200}") {
        let (_place, register) = register();
        let class = register.change("t-1", false, &Change::Make { name: name.clone() });
        if class.is_ok() {
            let classes = register.classes().expect("reads");
            prop_assert_eq!(classes[0].name.as_str(), name.trim());
        }
        let learner = NewLearner { id: id.clone(), given: name.clone(), ..NewLearner::default() };
        let _ = register.change("t-1", false, &Change::Add { class: "c-1".into(), learner });
        let _ = register.examine(&text, &name);
        let _ = register.seating(&id);
        let _ = register.change("t-1", true, &Change::Seal { exam: id.clone(), until: name });
        let _ = register.change("t-1", true, &Change::Reassign { recording: id.clone(), learner: id, why: text });
        prop_assert!(register.learners().is_ok());
    }
}
