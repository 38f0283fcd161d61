//! Plans: reading, rules of exams, revisions, and what outlives a restart.

use std::path::Path;

use proptest::prelude::*;
use sulcus_sessions::{Mode, ViewersPolicy};

use super::*;
use crate::state::StateFolder;

const NOW_NS: u64 = 1_795_651_200_000_000_000;

fn file(text: &str) -> Result<StationsFile, String> {
    let parsed = StationsFile::parse(text, Path::new("/class/stations.toml"));
    parsed.map_err(|error| error.to_string())
}

fn change(text: &str) -> PlanChange {
    crate::exact::read(text).expect("a change")
}

fn state() -> (tempfile::TempDir, StateFolder) {
    let place = tempfile::tempdir().expect("temporary folder");
    let folder = StateFolder::open(Some(&place.path().join("state"))).expect("creates");
    (place, folder)
}

fn two() -> Vec<Station> {
    file("[[station]]\nname = \"a\"\n[[station]]\nname = \"b\"\nplan = { mode = \"exam\" }\n")
        .expect("valid")
        .stations
}

#[test]
fn the_example_of_the_module_is_read() {
    let source = include_str!("stations.rs");
    let example = source
        .lines()
        .skip_while(|line| *line != "//! ```toml")
        .skip(1)
        .take_while(|line| *line != "//! ```")
        .map(|line| line.trim_start_matches("//!"))
        .collect::<Vec<_>>()
        .join("\n");
    let read = file(&example).expect("valid");
    assert_eq!(read.listen.as_deref(), Some("0.0.0.0:4433"));
    assert_eq!((read.class.as_str(), read.hours), ("2026 autumn", 40.0));
    assert_eq!(read.viewers, Some(ViewersPolicy::OnDemand));
    assert_eq!(read.recordings_quota, Some(500_000_000_000));
    let [one, two] = &read.stations[..] else {
        panic!("{read:?}");
    };
    assert_eq!(
        (one.plan.exercise.as_str(), one.plan.mode),
        ("probing", Mode::Practice)
    );
    assert_eq!(
        (two.plan.mode, two.plan.time_limit_s),
        (Mode::Exam, Some(1800))
    );
    assert_eq!(
        (one.plan.resume_within_s, two.plan.resume_within_s),
        (60, 60)
    );
}

#[test]
fn a_fault_is_said_with_file_line_name_and_range() {
    let head = "[[station]]\nname = \"a\"\n";
    for (text, parts) in [
        (
            format!("{head}[station.plan]\nrate_hz = 9\n"),
            vec!["line 4", "rate_hz is 9", "250 to 8000"],
        ),
        (
            format!("{head}[station.plan]\nmode = \"test\"\n"),
            vec!["line 4", "`test`", "practice"],
        ),
        (
            format!("{head}[station.plan]\nlearner = \"Jane Doe\"\n"),
            vec!["line 4", "Jane Doe", "opaque"],
        ),
        (
            format!("{head}[station.plan]\npatient_seed = -1\n"),
            vec!["line 4", "patient_seed is `-1`", "system"],
        ),
        (
            format!("{head}[station.plan]\nforce_limit_n = 0.0\n"),
            vec!["line 4", "force_limit_n is 0", "above 0"],
        ),
        (
            format!("{head}[station.plan]\nclock_in_gap = \"waits\"\n"),
            vec!["line 4", "waits", "stops"],
        ),
        (
            format!("{head}[station.plan]\ntime_limits = 5\n"),
            vec!["line 4", "time_limits", "time_limit_s"],
        ),
        (
            format!("{head}[station.plan]\ntime_limit_s = 1,5\n"),
            vec!["line 4"],
        ),
        (format!("{head}{head}"), vec!["line 3", "`a`", "line 1"]),
        (
            format!("{head}[[station]]\nname = \"A\"\n"),
            vec!["line 3", "`A`"],
        ),
        (
            "\n\n[[station]]\nname = \"a/b\"\n".into(),
            vec!["line 3", "`a/b`", "letters"],
        ),
        (
            "[[station]]\nname = \"any\"\n".into(),
            vec!["line 1", "`any`"],
        ),
        (
            "[class]\nname = \"x\"\n".into(),
            vec!["0 entries", "1 to 64"],
        ),
        (
            "listen = \"\"\n[[station]]\nname = \"a\"\n".into(),
            vec!["line 1", "listen"],
        ),
        (
            "viewers = \"off\"\n[[station]]\nname = \"a\"\n".into(),
            vec!["line 1", "viewers is `off`", "recorded or on-demand"],
        ),
        (
            "[class]\nhours = 0\n[[station]]\nname = \"a\"\n".into(),
            vec!["line 2", "hours is 0"],
        ),
        ("[[station]]\nplan = {}\n".into(), vec!["line 1", "name"]),
        (
            "recordings = \"r\"\nrecordings_quota_gb = -1\n[[station]]\nname = \"a\"\n".into(),
            vec!["line 2", "recordings_quota_gb is -1", "0.001 to 1000000 GB"],
        ),
        (
            "recordings_quota_gb = nan\n[[station]]\nname = \"a\"\n".into(),
            vec!["line 1", "recordings_quota_gb is NaN"],
        ),
        (
            "recordings_quota_gb = \"5\"\n[[station]]\nname = \"a\"\n".into(),
            vec!["line 1"],
        ),
    ] {
        let told = file(&text).expect_err(&text);
        assert!(
            told.contains("/class/stations.toml") && !told.contains('\n'),
            "{told}"
        );
        for part in parts {
            assert!(told.contains(part), "`{part}` is missing: {told}\n{text}");
        }
    }
    let many: String = (0..65)
        .map(|k| format!("[[station]]\nname = \"s{k}\"\n"))
        .collect();
    assert!(file(&many).expect_err("65").contains("65 entries"));
}

#[test]
fn a_typed_seed_of_an_exam_is_refused_and_stays_out_of_the_message() {
    for text in [
        "[[station]]\nname = \"a\"\nplan = { mode = \"exam\", patient_seed = 4711 }\n",
        "[defaults]\npatient_seed = 4711\n[[station]]\nname = \"a\"\nplan = { mode = \"exam\" }\n",
    ] {
        let told = file(text).expect_err("a typed seed");
        assert!(
            told.contains("patient_seed") && told.contains("`system`"),
            "{told}"
        );
        assert!(!told.contains("4711"), "{told}");
    }
    let exam = Plan::of(&change("mode = \"exam\"")).expect("valid");
    exam.with(&change("patient_seed = 4711"))
        .expect_err("a typed seed");
    exam.with(&change("patient_seed = \"system\""))
        .expect("valid");
}

#[test]
fn the_seed_of_an_exam_is_drawn_from_64_bits_for_each_session() {
    let exam = Plan::of(&change("mode = \"exam\"")).expect("valid");
    let draw = || exam.seed_of_session(true).expect("random").expect("a seed");
    let seeds: Vec<u64> = (0..64).map(|_| draw()).collect();
    // Each bit is set at least once and clear at least once: chance of a failure below 64 x 2^-63.
    assert_eq!(seeds.iter().fold(0, |all, seed| all | seed), u64::MAX);
    assert_eq!(seeds.iter().fold(u64::MAX, |all, seed| all & seed), 0);
    assert_eq!(exam.seed_of_session(false).expect("random"), None);
    let practice = Plan::of(&change("patient_seed = 7")).expect("valid");
    assert_eq!(practice.seed_of_session(true).expect("given"), Some(7));
    assert_eq!(Plan::default().seed_of_session(true).expect("none"), None);
}

#[test]
fn paths_of_a_file_are_relative_to_its_folder() {
    let read = file(
        "[[station]]\nname = \"a\"\nplan = { scene = \"s.toml\", exercise = \"e.toml\", rubric = \"/r.toml\" }\n",
    );
    let plan = &read.expect("valid").stations[0].plan;
    assert_eq!(plan.scene.as_deref(), Some(Path::new("/class/s.toml")));
    assert_eq!(plan.exercise, "/class/e.toml");
    assert_eq!(plan.rubric.as_deref(), Some(Path::new("/r.toml")));
}

#[test]
fn a_scene_without_an_exercise_is_free_and_a_free_plan_has_no_rubric() {
    let plan = Plan::of(&change("scene = \"s.toml\"")).expect("valid");
    assert_eq!(plan.exercise, Plan::FREE);
    let told = plan
        .with(&change("rubric = \"r.toml\""))
        .expect_err("no grade");
    assert!(told.to_string().contains("rubric is r.toml"), "{told}");
}

#[test]
fn cleared_parts_return_to_their_defaults() {
    let plan = Plan::of(&change(
        "time_limit_s = 60\nlearner = \"s-1\"\nresume_within_s = 5",
    ))
    .expect("valid");
    let cleared = plan.with(&change(
        "clear = [\"time_limit_s\", \"learner\", \"resume_within_s\"]",
    ));
    assert_eq!(cleared.expect("valid"), Plan::default());
    let told = plan
        .with(&change("clear = [\"limit\"]"))
        .expect_err("no such part")
        .to_string();
    assert!(
        told.contains("`limit`") && told.contains("time_limit_s"),
        "{told}"
    );
    for name in PlanChange::NAMES {
        plan.with(&change(&format!("clear = [\"{name}\"]")))
            .expect(name);
    }
}

#[test]
fn a_change_is_kept_over_a_restart_and_wins_over_the_file() {
    let (_place, folder) = state();
    let mut book = PlanBook::open(&two(), Some(&folder)).expect("opens");
    let set = book.set(
        "a",
        &change("exercise = \"probing\"\nlearner = \"s-1\""),
        "t-7f3a",
        None,
        NOW_NS,
    );
    let set = set.expect("valid");
    assert_eq!((set.revision.number, set.revision.fields.len()), (2, 2));
    assert!(set.effect.contains("next session") && set.is_set, "{set:?}");

    let again = PlanBook::open(&two(), Some(&folder)).expect("opens");
    let (plan, revision) = again.plan("a").expect("known");
    assert_eq!(
        (plan.exercise.as_str(), plan.learner.as_str()),
        ("probing", "s-1")
    );
    assert_eq!(revision, &set.revision);
    assert_eq!(
        revision.to_string(),
        "revision 2, changed on 2026-11-26 00:00 UTC by t-7f3a: exercise, learner"
    );
    assert_eq!(again.plan("b").expect("known").1.number, 1);
    assert!(again.plan("c").is_none());
}

#[test]
fn a_reset_returns_to_the_file_and_keeps_the_history() {
    let (_place, folder) = state();
    let mut book = PlanBook::open(&two(), Some(&folder)).expect("opens");
    book.set("a", &change("exercise = \"probing\""), "x", None, NOW_NS)
        .expect("valid");
    book.reset("a", "y", None, NOW_NS + 1).expect("valid");
    let again = PlanBook::open(&two(), Some(&folder)).expect("opens");
    let shown = &again.all(|_| None)[0];
    assert_eq!(
        (shown.plan.exercise.as_str(), shown.is_set),
        ("crown", false)
    );
    let by: Vec<&str> = shown.history.iter().map(|one| one.by.as_str()).collect();
    assert_eq!((by, shown.revision.by.as_str()), (vec!["file", "x"], "y"));
}

#[test]
fn a_running_exam_keeps_its_plan_and_a_change_before_is_told() {
    let (_place, folder) = state();
    let mut book = PlanBook::open(&two(), Some(&folder)).expect("opens");
    let later = change("time_limit_s = 60");
    let exam = Some(Running { mode: Mode::Exam });
    let told = book
        .set("b", &later, "x", exam, NOW_NS)
        .expect_err("runs")
        .to_string();
    assert!(told.contains("`b`") && told.contains("exam"), "{told}");
    book.reset("b", "x", exam, NOW_NS).expect_err("runs");
    assert_eq!(book.plan("b").expect("known").1.number, 1);
    assert!(book.all(|_| exam)[1].effect.contains("cannot be changed"));
    // The running session's mode counts, not that of the next plan.
    let practice = Some(Running {
        mode: Mode::Practice,
    });
    let set = book
        .set("b", &later, "t-01\n", practice, NOW_NS)
        .expect("practice runs");
    assert!(
        set.effect.contains("after the running one"),
        "{}",
        set.effect
    );
    let told = set.lines();
    assert!(
        told.contains("changed on 2026-11-26 00:00 UTC by t-01: time_limit_s"),
        "{told}"
    );
}

#[test]
fn a_refused_or_empty_change_makes_no_revision() {
    let (_place, folder) = state();
    let mut book = PlanBook::open(&two(), Some(&folder)).expect("opens");
    let told = book.set("b", &change("patient_seed = 1"), "x", None, NOW_NS);
    let told = told.expect_err("an exam").to_string();
    assert!(
        told.contains("`b`") && told.contains("patient_seed"),
        "{told}"
    );
    let told = book.set("c", &PlanChange::default(), "x", None, NOW_NS);
    let told = told.expect_err("unknown").to_string();
    assert!(told.contains("`c`") && told.contains("a, b"), "{told}");
    book.set("a", &change("time_limit_s = 60"), "x", None, NOW_NS)
        .expect("valid");
    let same = book.set("a", &change("time_limit_s = 60"), "y", None, NOW_NS);
    assert_eq!(same.expect("valid").revision.number, 2);
}

#[test]
fn a_plan_that_cannot_be_kept_is_not_changed() {
    let (_place, folder) = state();
    let mut book = PlanBook::open(&two(), Some(&folder)).expect("opens");
    let taken = folder.path().join("plans/a.toml");
    std::fs::create_dir(&taken).expect("creates");
    book.set("a", &change("time_limit_s = 60"), "x", None, NOW_NS)
        .expect_err("a folder");
    assert_eq!(book.plan("a").expect("known").0, &Plan::default());
}

#[test]
fn a_kept_plan_that_is_not_valid_is_refused_with_its_line() {
    let (_place, folder) = state();
    let mut book = PlanBook::open(&two(), Some(&folder)).expect("opens");
    book.set("a", &change("time_limit_s = 60"), "x", None, NOW_NS)
        .expect("valid");
    let path = folder.path().join("plans/a.toml");
    let good = std::fs::read_to_string(&path).expect("reads");
    for (from, to, told) in [
        ("time_limit_s = 60", "time_limit_s = 0", "time_limit_s is 0"),
        ("time_limit_s = 60", "spare = 60", "spare"),
        ("version = 1", "version = 9", "version is 9"),
        ("station = \"a\"", "station = \"b\"", "`b`"),
    ] {
        assert!(good.contains(from), "{good}");
        std::fs::write(&path, good.replace(from, to)).expect("writes");
        let error = PlanBook::open(&two(), Some(&folder))
            .expect_err(to)
            .to_string();
        assert!(error.contains("a.toml") && error.contains(told), "{error}");
    }
}

#[test]
fn any_number_of_changes_leaves_a_short_history() {
    let mut book = PlanBook::open(&two(), None).expect("opens");
    for k in 1..300 {
        let change = change(&format!("time_limit_s = {k}"));
        book.set("a", &change, "x", None, NOW_NS).expect("valid");
    }
    let shown = &book.all(|_| None)[0];
    assert_eq!((shown.revision.number, shown.history.len()), (300, 100));
}

fn any_change() -> impl Strategy<Value = PlanChange> {
    let names = (
        proptest::option::of("[a-z]{1,9}"),
        proptest::option::of("[a-z]{1,9}\\.toml"),
        proptest::option::of(prop_oneof![
            Just(PatientSeed::System),
            any::<u64>().prop_map(PatientSeed::Number)
        ]),
        proptest::option::of("[a-z]{1,5}[0-9]{1,5}"),
        proptest::option::of("[a-z]{1,9}\\.toml"),
    );
    let numbers = (
        proptest::option::of(250..=8000_u16),
        proptest::option::of(1..=86_400_u32),
        proptest::option::of(0..=3600_u32),
        proptest::option::of(0.01..100.0_f32),
        proptest::option::of(10..=900_u32),
    );
    let choices = (
        proptest::option::of(prop_oneof![
            Just(Mode::Practice),
            Just(Mode::SelfAssessment),
            Just(Mode::Exam)
        ]),
        proptest::option::of(prop_oneof![Just(ClockInGap::Runs), Just(ClockInGap::Stops)]),
    );
    (names, numbers, choices).prop_map(|(names, numbers, choices)| PlanChange {
        exercise: names.0,
        scene: names.1.map(PathBuf::from),
        patient_seed: names.2,
        learner: names.3,
        rubric: names.4.map(PathBuf::from),
        rate_hz: numbers.0,
        time_limit_s: numbers.1,
        resume_within_s: numbers.2,
        force_limit_n: numbers.3,
        detail_budget_us: numbers.4,
        mode: choices.0,
        clock_in_gap: choices.1,
        tick_at_hand: choices.1.map(|clock| clock == ClockInGap::Runs),
        clear: Vec::new(),
    })
}

proptest! {
    #[test]
    fn a_valid_plan_survives_toml_and_json(change in any_change()) {
        let Ok(plan) = Plan::of(&change) else {
            return Ok(());
        };
        let text = toml::to_string(&plan).expect("writes");
        prop_assert_eq!(&crate::exact::read::<Plan>(&text).expect("reads"), &plan);
        let json = serde_json::to_string(&plan).expect("writes");
        prop_assert_eq!(&serde_json::from_str::<Plan>(&json).expect("reads"), &plan);
        // A change to a plan leads to it from any other plan.
        prop_assert_eq!(&Plan::default().with(&PlanChange::to(&plan)).expect("valid"), &plan);
        prop_assert!(plan.differences(&plan).is_empty());
    }

    #[test]
    fn a_change_survives_json(change in any_change()) {
        let json = serde_json::to_string(&change).expect("writes");
        prop_assert_eq!(serde_json::from_str::<PlanChange>(&json).expect("reads"), change);
    }

    #[test]
    fn no_text_panics(text in "\\PC{0,60}|(\\[\\[station\\]\\]\nname = \"[a-z/]{0,3}\"\n(plan = \\{ [a-z_]{1,16} = [0-9\"a-z.-]{0,6} \\}\n)?){0,3}") {
        if let Err(told) = file(&text) {
            prop_assert!(told.contains("line "), "{}", told);
        }
    }
}
