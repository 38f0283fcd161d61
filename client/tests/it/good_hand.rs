//! The good operator reads at 0.19 to 0.23 N, 0.20 to 0.23 on average, and is never told that he is too heavy. Many hands, and a
//! mirror in the other hand, are among the long proofs.

use sulcus_client::demo::lockstep;
use sulcus_client::exercise::{self, Asked};
use sulcus_client::progress::Steps;
use sulcus_sessions::events::call::{Call, READING_CALLED};
use sulcus_sessions::grade::{Options, grade};
use sulcus_sessions::occurrence::FORCE_ZONE;
use sulcus_sessions::{Message, Occurrence, Recording, ReplayOptions, StationKey, replay_observed};

/// Time before a call over which the force counts, seconds.
const HELD_S: f64 = 1.0;
/// Smallest and largest mean load on the floor of one reading, newtons.
const READING_N: std::ops::Range<f64> = 0.185..0.23;
/// Smallest and largest mean of all readings, newtons.
const SESSION_N: std::ops::Range<f64> = 0.20..0.23;

/// The heaviest load on a floor of every tick, newtons, and the recorded occurrences.
struct Session {
    loads: Vec<f64>,
    said: Vec<Occurrence>,
    calls: Vec<(usize, Call)>,
    passed: Option<bool>,
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
    let mut loads = Vec::new();
    replay_observed(
        &recording,
        &ReplayOptions::default(),
        &mut |_| {},
        &mut |_, _, output, _| {
            let pockets = output.tools.iter().filter_map(|tool| tool.pocket.as_ref());
            loads.push(
                pockets
                    .map(|reading| reading.floor_force)
                    .fold(0.0, f64::max),
            );
        },
    )
    .expect("replays");
    let events = recording
        .messages()
        .filter_map(|message| match message.expect("sound") {
            Message::Event(event) => Occurrence::parse(&event.text),
            _ => None,
        });
    let said: Vec<Occurrence> = events.collect();
    let called = said.iter().filter(|said| said.kind == READING_CALLED);
    let calls = called
        .map(|said| {
            (
                said.tick as usize,
                Call::read(&said.data, &scene).expect("a call"),
            )
        })
        .collect();
    let graded = grade(&recording, &Options::default(), &mut |_| {}).expect("graded");
    Session {
        loads,
        said,
        calls,
        passed: graded.grade.passed,
    }
}

/// He pressed at 0.24 to 0.28 N and was told "too heavy" seven times in the default session.
pub fn reads_lightly(name: &str, sites: usize, seeds: std::ops::RangeInclusive<u64>) {
    for seed in seeds {
        let session = perform(name, seed);
        let told: Vec<_> = session
            .said
            .iter()
            .filter(|said| said.kind == FORCE_ZONE)
            .collect();
        assert!(told.is_empty(), "seed {seed}: {told:?}");
        assert_eq!(session.passed, Some(true), "seed {seed}");
        assert_eq!(session.calls.len(), sites, "seed {seed}");
        let held = (HELD_S * 1e3) as usize;
        let mut sum = 0.0;
        for (tick, call) in &session.calls {
            let load = session.loads[tick - held..*tick].iter().sum::<f64>() / held as f64;
            println!(
                "{name}, seed {seed}, {} {}: {load:.4} N",
                call.tooth,
                call.site.name()
            );
            assert!(
                READING_N.contains(&load),
                "seed {seed}: {load} N at {call:?}"
            );
            sum += load;
        }
        let mean = sum / sites as f64;
        assert!(SESSION_N.contains(&mean), "seed {seed}: {mean} N");
    }
}

#[test]
fn a_good_hand_probes_lightly() {
    reads_lightly("probing", 3, 1..=1);
}
