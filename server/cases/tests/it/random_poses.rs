//! Poses made up at random, on every tissue model, with one and two tools, with the tick's solver and with the judge.

use sulcus_cases::Measures;
use sulcus_cases::fuzz::{ALL, Fuzz};
use sulcus_core::Params;
use sulcus_core::optimise::SolverKind;

/// Ticks over all scenes, and with the judge in the tick; SULCUS_FUZZ says how many else.
const TICKS: u64 = 100_000;
const JUDGED_TICKS: u64 = 250 * ALL.len() as u64;

/// Ticks of each scene, of so many over them all unless somebody asks for others.
fn each(all: u64) -> u64 {
    let asked = std::env::var("SULCUS_FUZZ").ok();
    asked.map_or(all, |n| n.parse().expect("a number of ticks")) / ALL.len() as u64
}

fn hold(fuzz: &Fuzz, m: &Measures, ticks: u64, times: f64) {
    let params = Params::default();
    println!("{}: {m:?}", fuzz.name);
    let name = fuzz.name;
    assert_eq!((m.ticks, m.not_finite, m.faults), (ticks, 0, 0), "{name}");
    assert!(m.contact_ticks > ticks / 12, "{name}: {m:?}");
    assert!(m.residual <= 1e-6, "{name}: residual {:e} m", m.residual);
    // A tick that ran out of passes is done by the next: what does not yield is not entered meanwhile. (Soft tissue, struck by a
    // leap of centimetres, is by millimetres, and the report says so.)
    assert!(fuzz.keeps_up(m, times), "{name}: {m:?}");
    assert!(m.solver_failed <= ticks / 10_000, "{name}: {m:?}");
    assert!(m.max_force <= params.max_force + 1e-9, "{name}: {m:?}");
    assert!(m.sent_step <= params.max_force_step + 1e-9, "{name}: {m:?}");
    // A force under load follows a slow hand, whatever came before.
    assert!(m.slow_force_step <= 0.02 + 1e-9, "{name}: {m:?}");
}

#[test]
fn a_hundred_thousand_random_poses() {
    let ticks = each(TICKS);
    for (seed, fuzz) in ALL.iter().enumerate() {
        let found = fuzz.run(seed as u64, ticks, |_| {});
        hold(fuzz, &found, ticks, 1.0);
        let bad = found.bad_input;
        assert!(bad > ticks / 1000, "{}: {bad}", fuzz.name);
    }
}

#[test]
fn random_poses_with_the_judge_in_the_tick() {
    let ticks = each(JUDGED_TICKS);
    for (seed, fuzz) in ALL.iter().enumerate() {
        let found = fuzz.run(100 + seed as u64, ticks, |scene| {
            scene.params.solver = SolverKind::Clarabel;
        });
        // Over a quarter of a second one leap is much.
        hold(fuzz, &found, ticks, 2.0);
    }
}
