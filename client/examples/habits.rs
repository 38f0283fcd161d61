//! Grades of the good operator and of every bad habit for a range of seeds, in virtual time.
//!
//!     cargo run --release -p sulcus-client --example habits -- bimanual 1 20
//!
//! Output: a line for each session with score, cost and the metrics under 80, and a line for each habit at the end. A
//! *cost* is the score of the good operator minus that of the habit, with the same seed.
//!
//! A session of the good operator is a fault if it does not pass. A session of a habit is a fault if its cost is under
//! [`COSTS`] or missing. It is also a fault if the first of the habit's own metrics does not name the habit.
#![allow(clippy::unwrap_used)]

#[path = "../tests/it/grades/own.rs"]
mod own;

use std::path::PathBuf;

use clap::Parser;
use own::{COSTS, NAMED, own};
use sulcus_connection::progress::Steps;
use sulcus_demo::exercise::{self, Asked};
use sulcus_demo::lockstep;
use sulcus_operator::Habit;
use sulcus_operator::habit::UnknownHabit;
use sulcus_sessions::grade::{Grade, Options, grade};
use sulcus_sessions::{Recording, StationKey};

fn perform(name: &str, patient: bool, habit: Option<Habit>, seed: u64) -> Grade {
    let asked = Asked {
        habit,
        hand_seed: seed,
        patient_seed: patient.then_some(seed),
        ..Asked::of(name)
    };
    let mut prepared = exercise::prepare(&asked, &Steps).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let key = StationKey::from_seed([7; 32]);
    let ran = lockstep::run(&mut prepared, seed, folder.path(), key, &Steps).unwrap();
    let recording = Recording::open(&ran.recording).unwrap();
    grade(&recording, &Options::default(), &mut |_| {})
        .unwrap()
        .grade
}

/// Grade the good operator and every bad habit over seeds
#[derive(Parser)]
struct Arguments {
    /// Exercise, by its name or as a file. A `+` before it makes the seeds those of the patient, too
    exercise: String,
    /// First seed
    from: u64,
    /// Last seed
    to: u64,
    /// Habits, such as `misreads`, or `good` for the good operator, who is always graded. Without a name, all habits
    #[arg(value_name = "HABIT", value_parser = habit)]
    habits: Vec<Graded>,
    /// Print the text of every grade
    #[arg(long)]
    verbose: bool,
    /// Write every grade as JSON into this folder
    #[arg(long, value_name = "FOLDER")]
    json: Option<PathBuf>,
}

/// Habit of an operator; `None` for the good operator.
#[derive(Clone, Copy)]
struct Graded(Option<Habit>);

/// Reads a habit or `good`.
fn habit(name: &str) -> Result<Graded, UnknownHabit> {
    match name {
        "good" => Ok(Graded(None)),
        name => name.parse().map(|habit| Graded(Some(habit))),
    }
}

fn main() {
    let Arguments {
        exercise,
        from,
        to,
        habits: named,
        verbose,
        json,
    } = Arguments::parse();
    let (patient, name) = match exercise.strip_prefix('+') {
        Some(name) => (true, name),
        None => (false, exercise.as_str()),
    };
    let mut habits: Vec<Option<Habit>> = vec![None];
    if named.is_empty() {
        let probing = name != "bimanual";
        let all = Habit::ALL.into_iter();
        habits.extend(
            all.filter(|habit| !(probing && *habit == Habit::LetsTongueGo))
                .map(Some),
        );
    } else {
        let named = named.into_iter().map(|Graded(habit)| habit);
        habits.extend(named.filter(Option::is_some));
    }
    let mut good = Vec::new();
    for habit in habits {
        let title = habit.map_or("good", Habit::name);
        let (mut scores, mut costs, mut faults) = (Vec::new(), Vec::new(), 0);
        for (k, seed) in (from..=to).enumerate() {
            let grade = perform(name, patient, habit, seed);
            let score = grade.score.unwrap_or(f64::NAN);
            if habit.is_none() {
                good.push(score);
            }
            costs.push(good[k] - score);
            scores.push(score);
            let weak: Vec<String> = grade
                .metrics
                .iter()
                .filter(|m| m.score.is_none_or(|s| s < 80.0) && m.weight > 0.0)
                .map(|m| {
                    format!(
                        "{} {:?}->{:?}",
                        m.name,
                        m.value.unwrap_or(f64::NAN),
                        m.score.unwrap_or(f64::NAN)
                    )
                })
                .collect();
            let unnamed: Vec<&str> = habit.map_or(vec![], |habit| {
                let named = |name| {
                    let metric = grade.metric(name);
                    metric.is_some_and(|metric| metric.score.is_some_and(|score| score < NAMED))
                };
                let own = own(habit).iter();
                own.filter(|name| !named(name)).copied().collect()
            });
            let fault = match habit {
                None => grade.passed != Some(true),
                // Without a score there is no cost. Only the first metric counts: where a tooth is in sight without the
                // mirror, the second one has no value.
                Some(habit) => {
                    costs[k].is_nan() || costs[k] < COSTS || unnamed.contains(&own(habit)[0])
                }
            };
            faults += u32::from(fault);
            println!(
                "{title:15} seed {seed:3} {score:6.1} {} cost {:5.1}{}{} | {}",
                if grade.passed == Some(true) {
                    "passed"
                } else {
                    "failed"
                },
                costs[k],
                if fault { " FAULT" } else { "" },
                if unnamed.is_empty() {
                    String::new()
                } else {
                    format!(", not named by {}", unnamed.join(", "))
                },
                weak.join(", ")
            );
            if let Some(folder) = &json {
                let file = folder.join(format!("{title}-{seed}.json"));
                std::fs::write(file, grade.to_json().to_string()).unwrap();
            }
            if verbose {
                println!("{}", grade.text(false, true));
            }
        }
        let fold =
            |all: &[f64], f: fn(f64, f64) -> f64| all.iter().copied().reduce(f).unwrap_or(f64::NAN);
        println!(
            "== {title}: score {:.1} to {:.1}, cost {:.1} to {:.1}, {faults} faults",
            fold(&scores, f64::min),
            fold(&scores, f64::max),
            fold(&costs, f64::min),
            fold(&costs, f64::max)
        );
    }
}
