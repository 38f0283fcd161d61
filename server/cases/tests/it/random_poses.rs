//! Poses made up at random, on every tissue model, with one and two tools, with the tick's solver and with the judge.

use sulcus_cases::Measures;
use sulcus_cases::fuzz::{ALL, Fuzz};
use sulcus_core::Params;
use sulcus_core::optimise::SolverKind;

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

/// Walks so many ticks over all scenes, each with its own seed from `first_seed` on, and asserts that all holds.
pub fn walk(ticks: u64, first_seed: u64, solver: SolverKind, times: f64) {
    let ticks = ticks / ALL.len() as u64;
    for (seed, fuzz) in (first_seed..).zip(ALL) {
        let found = fuzz.run(seed, ticks, |scene| scene.params.solver = solver);
        hold(fuzz, &found, ticks, times);
        let bad = found.bad_input;
        let expected = ticks < 1000 || bad > ticks / 1000;
        assert!(expected, "{}: {bad} bad poses in {ticks}", fuzz.name);
    }
}

#[test]
fn twenty_thousand_random_poses() {
    walk(20_000, 0, SolverKind::ActiveSet, 1.0);
}

#[test]
fn random_poses_with_the_judge_in_the_tick() {
    // Over a quarter of a second one leap is much.
    walk(250 * ALL.len() as u64, 100, SolverKind::Clarabel, 2.0);
}
