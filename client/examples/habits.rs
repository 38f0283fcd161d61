//! Grades of the good operator and of every bad habit over seeds, in virtual time.
//!
//!     cargo run --release -p sulcus-client --example habits -- EXERCISE FROM TO [HABIT...]
//!
//! `EXERCISE` is a name or a file; seeds run from FROM to TO (of the hand; a `+` before the name makes them those of the patient too).
//! A line for each session, one for each habit at the end: scores, and the metrics that lost most. A fault is a good operator who does not
//! pass, or a habit that its own metrics do not name or that costs too little.
#![allow(clippy::unwrap_used)]

#[path = "../tests/it/grades/own.rs"]
mod own;

use own::{COSTS, NAMED, own};
use sulcus_client::demo::lockstep;
use sulcus_client::exercise::{self, Asked};
use sulcus_client::progress::Steps;
use sulcus_operator::Habit;
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

fn main() {
    let args: Vec<String> = std::env::args().skip(1).collect();
    if args.len() < 3 {
        eprintln!(
            "usage: habits [+]EXERCISE FROM TO [HABIT...], such as: bimanual 1 20, or +probing 1 20 misreads"
        );
        std::process::exit(2);
    }
    let (patient, name) = match args[0].strip_prefix('+') {
        Some(name) => (true, name),
        None => (false, args[0].as_str()),
    };
    let (from, to): (u64, u64) = (args[1].parse().unwrap(), args[2].parse().unwrap());
    let mut habits: Vec<Option<Habit>> = vec![None];
    if args.len() > 3 {
        habits.extend(
            args[3..]
                .iter()
                .filter(|one| *one != "good")
                .map(|one| Some(one.parse().unwrap())),
        );
    } else {
        let probing = name != "bimanual";
        let all = Habit::ALL.into_iter();
        habits.extend(
            all.filter(|habit| !(probing && *habit == Habit::LetsTongueGo))
                .map(Some),
        );
    }
    let verbose = std::env::var_os("VERBOSE").is_some();
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
                // Without a score there is no cost; and where a tooth is in sight without the mirror, the second metric has nothing to say.
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
            if let Some(folder) = std::env::var_os("JSON") {
                let file = std::path::Path::new(&folder).join(format!("{title}-{seed}.json"));
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
