//! Sessions in virtual time hold all invariants, and are the same from the same seed.

use sulcus_simulation::class::{Class, hash, session};
use sulcus_simulation::known::KNOWN;
use sulcus_simulation::run::Name;

/// Runs seeds, and asserts that no invariant is broken.
fn hold(from: u64, to: u64, stations: u32, seconds: u64) {
    let class = Class {
        from,
        to,
        stations,
        seconds,
    };
    let outcomes = class.run(|_| {}).expect("recordings open");
    for outcome in outcomes.iter().filter(|outcome| !outcome.broken.is_empty()) {
        println!("{:?}: {:#?}", outcome.name, outcome.broken);
        println!("{}", outcome.lines.join("\n"));
    }
    let broken = outcomes.iter().filter(|outcome| !outcome.broken.is_empty());
    assert_eq!(broken.count(), 0, "see above");
    let numbers = outcomes.iter().flat_map(|outcome| &outcome.known);
    let numbers: Vec<u8> = numbers.map(|(_, broken)| broken.number).collect();
    for known in KNOWN {
        assert!(numbers.contains(&known.invariant), "mended: {known:?}");
    }
    let ticks: u64 = outcomes.iter().map(|outcome| outcome.ticks).sum();
    assert!(
        ticks > (to - from + 1) * u64::from(stations) * seconds * 500,
        "{ticks}"
    );
}

#[test]
fn a_dozen_seeds_of_two_stations_hold_all_invariants() {
    hold(1, 12, 2, 12);
}

#[test]
fn the_same_seed_gives_the_same_events_and_the_same_recording() {
    let name = Name {
        seed: 5,
        station: 1,
    };
    let of = || session(name, 8).expect("a recording opens");
    let (one, other) = (of(), of());
    assert_eq!(one.hash, other.hash);
    assert_eq!(one.recording, other.recording);
    assert_ne!(one.recording, [0; 32]);
    let stranger = session(
        Name {
            seed: 6,
            station: 1,
        },
        8,
    )
    .expect("a recording opens");
    assert_ne!(hash(&[one]), hash(&[stranger]));
}

mod long {
    use sulcus_support::long;

    use super::hold;

    #[test]
    fn two_hundred_seeds_of_two_stations_hold_all_invariants() {
        if long::selected("hall-a") {
            hold(1, 200, 2, 30);
        }
    }
}
