//! The good operator reads at 0.20 to 0.23 N, under the limit at which he would be told that he is too heavy.
//! `SULCUS_SEEDS=20` performs with twenty hands (two otherwise); `-- --nocapture` prints every reading.

use sulcus_client::demo::lockstep;
use sulcus_client::exercise::{self, Asked};
use sulcus_client::progress::Steps;
use sulcus_core::tissue::TissueModel;
use sulcus_sessions::events::call::{Call, READING_CALLED};
use sulcus_sessions::grade::{Options, grade};
use sulcus_sessions::occurrence::FORCE_ZONE;
use sulcus_sessions::{Message, Occurrence, Recording, ReplayOptions, StationKey, replay_observed};

/// How long before a call the force counts, seconds: as long as the hand holds it.
const HELD_S: f64 = 1.0;

/// One reading.
#[derive(Debug)]
struct Reading {
    call: Call,
    /// Mean and largest force on the floor while it was held, newtons.
    mean_n: f64,
    most_n: f64,
    /// Depth prescribed there, mm.
    truth_mm: f64,
}

/// One session of the good operator.
struct Session {
    readings: Vec<Reading>,
    /// Zones that the hand was told of, all but `light`.
    told: Vec<Occurrence>,
    passed: Option<bool>,
    score: f64,
}

fn perform(name: &str, seed: u64) -> Session {
    let asked = Asked {
        hand_seed: seed,
        ..Asked::of(name)
    };
    let mut prepared = exercise::prepare(&asked, &Steps).expect("built in");
    let scene = prepared.scene.clone();
    let folder = tempfile::tempdir().expect("a folder");
    let key = StationKey::from_seed([7; 32]);
    let ran = lockstep::run(&mut prepared, seed, folder.path(), key, &Steps).expect("runs");
    let recording = Recording::open(&ran.recording).expect("opens");
    let mut forces = Vec::new();
    replay_observed(
        &recording,
        &ReplayOptions::default(),
        &mut |_| {},
        &mut |_, _, output, _| {
            let readings = output.tools.iter().filter_map(|tool| tool.pocket.as_ref());
            forces.push(
                readings
                    .map(|reading| reading.floor_force)
                    .fold(0.0, f64::max),
            );
        },
    )
    .expect("replays");
    let held = scene.params.ticks_in(HELD_S) as usize;
    let (mut readings, mut told) = (Vec::new(), Vec::new());
    for message in recording.messages() {
        let Message::Event(event) = message.expect("sound") else {
            continue;
        };
        let Some(said) = Occurrence::parse(&event.text) else {
            continue;
        };
        if said.kind == FORCE_ZONE && said.data["zone"] != "light" {
            told.push(said);
        } else if said.kind == READING_CALLED {
            let call = Call::read(&said.data, &scene).expect("a call");
            let end = said.tick as usize;
            let force = &forces[end - held..end];
            let gingivae = scene
                .objects
                .iter()
                .filter_map(|object| match &object.tissue {
                    TissueModel::Gingiva(gingiva) => Some((&object.name, gingiva)),
                    _ => None,
                });
            let tooth = call.tooth.to_string();
            let mut own = gingivae.filter(|(name, _)| name.contains(&tooth));
            let (_, gingiva) = own.next().expect("its gingiva");
            readings.push(Reading {
                call,
                mean_n: force.iter().sum::<f64>() / held as f64,
                most_n: force.iter().copied().fold(0.0, f64::max),
                truth_mm: gingiva.prescribed(call.site).depth * 1e3,
            });
        }
    }
    let graded = grade(&recording, &Options::default(), &mut |_| {}).expect("graded");
    Session {
        readings,
        told,
        passed: graded.grade.passed,
        score: graded.grade.score.unwrap_or(f64::NAN),
    }
}

fn seeds() -> u64 {
    let asked = std::env::var("SULCUS_SEEDS").ok();
    asked.map_or(2, |n| n.parse().expect("a number of seeds"))
}

/// He was told "too heavy" seven times in the default session: he pressed at 0.25 N, where the limit is 0.25.
fn reads_lightly(name: &str, sites: usize) {
    for seed in 1..=seeds() {
        let session = perform(name, seed);
        println!("{name}, seed {seed}: {:.1} points", session.score);
        for reading in &session.readings {
            println!("  {reading:?}");
        }
        for said in &session.told {
            println!("  told {said}");
        }
        assert_eq!(session.passed, Some(true), "seed {seed}");
        assert_eq!(session.readings.len(), sites, "seed {seed}");
        assert!(session.told.is_empty(), "seed {seed}: {:?}", session.told);
        let all = session.readings.iter();
        let mean = all.map(|one| one.mean_n).sum::<f64>() / sites as f64;
        assert!((0.20..0.23).contains(&mean), "seed {seed}: {mean} N");
        for reading in &session.readings {
            let said = format!("seed {seed}: {reading:?}");
            assert!((0.18..0.24).contains(&reading.mean_n), "{said}");
            let off = f64::from(reading.call.depth_mm) - reading.truth_mm;
            assert!(off.abs() <= 1.0, "{said}");
        }
    }
}

#[test]
fn probing_is_read_lightly() {
    reads_lightly("probing", 3);
}

#[test]
fn bimanual_is_read_lightly() {
    reads_lightly("bimanual", 9);
}
