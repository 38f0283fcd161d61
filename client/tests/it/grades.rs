//! The good operator passes, and every bad habit is named by its own metric and costs the points that it should, in virtual
//! time. Twenty hands are among the long proofs; the example `habits` prints the grades.
#![allow(clippy::unwrap_used)]

mod own;

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::{Arc, Mutex, OnceLock};

use own::{COSTS, NAMED, own};
use sulcus_connection::progress::Steps;
use sulcus_demo::exercise::{self, Asked};
use sulcus_demo::lockstep;
use sulcus_operator::Habit;
use sulcus_sessions::grade::{Advice, Finding, Grade, Options, grade};
use sulcus_sessions::{Recording, Rubric, StationKey};

/// The file of an exercise that goes round one molar.
pub const WHOLE_TOOTH: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/whole_tooth.toml");

fn perform(name: &str, habit: Option<Habit>, seed: u64) -> Grade {
    let asked = Asked {
        habit,
        hand_seed: seed,
        ..Asked::of(name)
    };
    let mut prepared = exercise::prepare(&asked, &Steps).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let key = StationKey::from_seed([7; 32]);
    let ran = lockstep::run(&mut prepared, seed, folder.path(), key, &Steps).unwrap();
    graded(&ran.recording)
}

fn graded(recording: &Path) -> Grade {
    let recording = Recording::open(recording).unwrap();
    let graded = grade(&recording, &Options::default(), &mut |_| {}).unwrap();
    graded.grade
}

fn points(grade: &Grade, metric: &str) -> f64 {
    let found = grade.metric(metric);
    let found = found.unwrap_or_else(|| panic!("{metric} is not measured"));
    found.score.unwrap_or(f64::NAN)
}

fn count(grade: &Grade, finding: Finding) -> usize {
    grade
        .sites
        .iter()
        .filter(|site| site.finding == finding)
        .count()
}

/// A grade that the first test to ask for it computes.
type Shared = Arc<OnceLock<Grade>>;

/// The grade of the good hand, who passes. Tests share it.
fn good(exercise: &str, seed: u64) -> Grade {
    static GOOD: Mutex<BTreeMap<(String, u64), Shared>> = Mutex::new(BTreeMap::new());
    let entry = {
        let mut all = GOOD.lock().unwrap();
        let entry = all.entry((exercise.to_owned(), seed)).or_default();
        Arc::clone(entry)
    };
    let good = entry.get_or_init(|| perform(exercise, None, seed));
    assert!(good.gradable, "{:?}", good.reason);
    assert_eq!(good.passed, Some(true), "seed {seed}: {:?}", good.failures);
    good.clone()
}

/// Performs with each habit; asserts what must hold of each.
pub fn all_must_hold(exercise: &str, habits: &[Habit], seed: u64) {
    let good = good(exercise, seed);
    let best = good.score.unwrap();
    for habit in habits {
        let bad = perform(exercise, Some(*habit), seed);
        let said = || format!("{habit}, seed {seed}\n{}", bad.text(true, true));
        let cost = best - bad.score.unwrap();
        assert!(cost >= COSTS, "costs {cost}: {}", said());
        for metric in own(*habit) {
            assert!(points(&bad, metric) < NAMED, "{metric}: {}", said());
            assert!(
                points(&good, metric) >= 80.0,
                "{metric} of the good one, seed {seed}"
            );
            let advised = bad
                .advice
                .iter()
                .any(|advice| advice.metric == own(*habit)[0]);
            assert!(advised, "not advised: {}", said());
        }
        match habit {
            // The eye, not the hand.
            Habit::Misreads => {
                assert!(points(&bad, "floor_reached") >= 80.0, "{}", said());
                assert!(count(&bad, Finding::Misread) > 0, "{}", said());
                assert_eq!(count(&bad, Finding::NeverReachedFloor), 0, "{}", said());
            }
            // The hand, not the eye: the bands were read as they were, and nobody is told to read them.
            Habit::HeavyHand => {
                assert_eq!(count(&bad, Finding::Misread), 0, "{}", said());
                assert!(count(&bad, Finding::ReadTooHeavy) > 0, "{}", said());
                let reads = |advice: &Advice| advice.text.contains("band");
                assert!(!bad.advice.iter().any(reads), "{}", said());
                // Its touches are those of its bobs, not of whole sides.
                let step = bad.metric("walking_step").and_then(|step| step.value);
                assert!(step.is_some_and(|mm| mm < 1.5), "{}", said());
            }
            Habit::StopsShort => {
                assert_eq!(count(&bad, Finding::Misread), 0, "{}", said());
                assert!(count(&bad, Finding::NeverReachedFloor) > 0, "{}", said());
            }
            _ => {}
        }
    }
}

/// The habits of a probing hand. Two tests perform one part each, so that two cores share the work.
pub const PROBING: [Habit; 7] = [
    Habit::HeavyHand,
    Habit::WrongAngle,
    Habit::SkipsSites,
    Habit::Impatient,
    Habit::SpotProbes,
    Habit::Misreads,
    Habit::StopsShort,
];

#[test]
fn force_angle_and_completeness_are_named_and_cost() {
    all_must_hold(WHOLE_TOOTH, &PROBING[..4], 1);
}

#[test]
fn walking_the_eye_and_the_floor_are_named_and_cost() {
    all_must_hold(WHOLE_TOOTH, &PROBING[4..], 1);
}

#[test]
fn a_tongue_let_go_is_named_and_costs() {
    all_must_hold("bimanual", &[Habit::LetsTongueGo], 1);
    // In the default session the good operator was told seven times that he presses too hard.
    for site in good("bimanual", 1).sites {
        assert!(site.max_force_n.is_none_or(|most| most < 0.25), "{site:?}");
    }
}

#[test]
fn a_grade_comes_from_the_recording_alone_and_is_the_same_twice() {
    let asked = Asked {
        duration_s: Some(6.0),
        ..Asked::of("probing")
    };
    let mut prepared = exercise::prepare(&asked, &Steps).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let key = StationKey::from_seed([7; 32]);
    let ran = lockstep::run(&mut prepared, 1, folder.path(), key, &Steps).unwrap();
    let once = graded(&ran.recording);
    let elsewhere = folder.path().join("copy.mcap");
    std::fs::copy(&ran.recording, &elsewhere).unwrap();
    let again = graded(&elsewhere);
    assert_eq!(once.to_json().to_string(), again.to_json().to_string());
    let rubric = once.rubric.unwrap();
    let own = Rubric::of(&prepared.exercise).unwrap();
    assert_eq!((&rubric.name, rubric.version), (&own.name, own.version));
    // The definitions travel in the file.
    let recording = Recording::open(&ran.recording).unwrap();
    let text = &recording.header().rubric;
    for metric in &once.metrics {
        assert!(text.contains(metric.definition), "{}", metric.name);
    }
    assert!(rubric.redefined.is_empty());
}
