//! A probe whose hand is lost in the middle of a reading, and comes back: nothing is felt as a blow, and nothing is
//! thrown out of the pocket.

use sulcus_cases::{Measures, Observer};
use sulcus_core::math::{exp_rotation, log_rotation, norm};
use sulcus_core::output::status;
use sulcus_core::{Pose, TickInput, ToolOutput, Vec3};

use super::run::{Feeler, Run, SITES, go_in, scene_with, way};

/// Force of the reading that is interrupted, newtons.
const READING_N: f64 = 0.22;
/// Largest change of the raw force in a millisecond beyond the hand's own motion, newtons.
const STEP_N: f64 = 0.02;
/// Time after the return in which steps of the force count, ticks.
const AFTER: u64 = 500;
/// Observed time after the return, ticks. From 50 mm away a probe comes loose from the teeth within it.
const OBSERVED: u64 = 2000;
/// Durations of the absence, ticks.
const GAPS: [u64; 3] = [1000, 5000, 20_000];

/// Course of a run from the return on.
struct Returned {
    /// Graphic tip before the absence, world axes, metres.
    stood: Vec3,
    before: ToolOutput,
    last: ToolOutput,
    /// Largest change of the raw force in a tick beyond the hand's own motion, newtons.
    step: f64,
    /// Largest change of the raw torque in a tick about the working point, newton metres.
    torque_step: f64,
    /// Largest distance of the graphic tip from its place before the absence, metres.
    farthest: f64,
    /// First tick after the return in which graphic and haptic tool have met.
    met: Option<u64>,
    /// First ticks of zones of force that were entered, with whether the tools had met.
    zones: Vec<(u64, bool)>,
    measures: Measures,
}

/// Interrupts a reading at the site for `gap` ticks. The hand returns to where `hand` puts it, given its pose before,
/// the tick since the return, the direction away from the tooth and the one up along the probe.
fn interrupted(site: usize, gap: u64, hand: impl Fn(&Pose, u64, &Vec3, &Vec3) -> Pose) -> Returned {
    let scene = scene_with(&[]);
    let (degrees, depth) = SITES[site];
    let way = way(&scene, degrees, depth);
    let mut run = Run::new(&scene);
    go_in(&mut run, &way, 0.0);
    let mut feeler = Feeler::default();
    feeler.press_to(&mut run, &way, READING_N);
    // Held there until the tissue rests.
    let mut before = feeler.step(&mut run, &way, 0.0).tools[0];
    for _ in 0..200 {
        before = feeler.step(&mut run, &way, 0.0).tools[0];
    }
    let tool = &scene.tools[0];
    let stood = before.graphic.transform(&tool.tip);
    for _ in 0..gap {
        let out = run.step(&TickInput::IDLE);
        assert_eq!(out.tools[0].graphic, before.graphic);
    }
    let mut observer = Observer::new(&scene);
    let reach = tool.tree.lever_from(&tool.working_point);
    let mut last = ToolOutput::absent(before.graphic);
    let mut found = Returned {
        stood,
        before,
        last,
        step: 0.0,
        torque_step: 0.0,
        farthest: 0.0,
        met: None,
        zones: Vec::new(),
        measures: Measures::default(),
    };
    for k in 0..OBSERVED {
        let pose = hand(&before.haptic, k, &way.outward, &way.up);
        let input = Run::input(&pose);
        let torque = |run: &Run| run.last.map_or(Vec3::zeros(), |out| run.torque(&out));
        let torque_before = torque(&run);
        let out = run.step(&input).tools[0];
        observer.observe(&scene, &input, &run.last.expect("a tick"), &run.ws);
        let own = if k == 0 {
            // The motion during the absence is no motion of the hand in a tick.
            0.0
        } else {
            let moved = out.haptic.transform(&tool.working_point)
                - last.haptic.transform(&tool.working_point);
            let turned = out.haptic.orientation * last.haptic.orientation.inverse();
            norm(&moved) + reach * norm(&log_rotation(&turned))
        };
        let change = norm(&(out.raw_wrench.force - last.raw_wrench.force));
        if k < AFTER {
            found.step = found.step.max(change - tool.stiffness_n_per_m * own);
            found.torque_step = found.torque_step.max(norm(&(torque(&run) - torque_before)));
        }
        let tip = out.graphic.transform(&tool.tip);
        found.farthest = found.farthest.max(norm(&(tip - stood)));
        let met = out.status & status::NOT_MET == 0;
        if met && found.met.is_none() {
            found.met = Some(k);
        }
        if out.pocket.is_some_and(|reading| reading.entered_zone) {
            found.zones.push((k, met));
        }
        last = out;
    }
    found.last = last;
    found.measures = observer.measures();
    found
}

/// Asserts what holds after every return.
fn holds(what: &str, found: &Returned) {
    let m = &found.measures;
    println!(
        "{what}: step {:.4} N, torque {:.2} N mm, farthest {:.2} mm, met {:?}, residual {:.3} um (exhausted {:.1}), exhausted {}, arrival {}, raw {:.3} N, zones {:?}",
        found.step,
        found.torque_step * 1e3,
        found.farthest * 1e3,
        found.met,
        m.residual * 1e6,
        m.exhausted_residual * 1e6,
        m.exhausted,
        m.arrival,
        norm(&found.last.raw_wrench.force),
        found.zones,
    );
    assert!(found.step <= STEP_N + 1e-9, "{what}: {} N", found.step);
    assert!(m.residual <= 1e-6, "{what}: residual {:e} m", m.residual);
    assert_eq!(
        (m.faults, m.solver_failed, m.not_finite),
        (0, 0, 0),
        "{what}"
    );
}

#[test]
fn at_the_same_place_the_reading_goes_on() {
    for gap in GAPS {
        for site in [0, 3] {
            let found = interrupted(site, gap, |before, _, _, _| *before);
            let what = format!("same place, site {site}, {gap} ms");
            holds(&what, &found);
            // Out of the relaxed floor, and back: not out of the pocket of 3 or 4 mm.
            assert!(found.farthest < 2e-3, "{what}: {:e} m", found.farthest);
            let (before, after) = (found.before.pocket, found.last.pocket);
            let (before, after) = (before.expect("a reading"), after.expect("a reading"));
            assert!((before.depth - after.depth).abs() < 1e-4, "{what}");
            assert!(
                (before.floor_force - after.floor_force).abs() < 0.05 * READING_N,
                "{what}: {after:?} after {before:?}"
            );
            assert!(found.met.is_some_and(|tick| tick < 100), "{what}");
        }
    }
}

#[test]
fn three_millimetres_off_the_probe_follows_the_hand() {
    for gap in GAPS {
        for (name, off) in [
            ("up", (0.0, 3e-3)),
            ("down", (0.0, -3e-3)),
            ("outward", (3e-3, 0.0)),
            ("to the tooth", (-3e-3, 0.0)),
        ] {
            let found = interrupted(0, gap, |before, _, outward, up| {
                Pose::new(
                    before.position + outward * off.0 + up * off.1,
                    before.orientation,
                )
            });
            let what = format!("3 mm {name}, {gap} ms");
            holds(&what, &found);
            assert!(found.farthest < 4e-3, "{what}: {:e} m", found.farthest);
        }
    }
}

#[test]
fn outside_of_the_mouth_the_probe_comes_to_the_hand() {
    for gap in GAPS {
        let found = interrupted(3, gap, |before, _, outward, up| {
            let turned = exp_rotation(&(outward * 0.5)) * before.orientation;
            Pose::new(before.position + outward * 0.03 + up * 0.04, turned)
        });
        let what = format!("outside, {gap} ms");
        holds(&what, &found);
        assert!(found.met.is_some(), "{what}");
        let apart = found.last.graphic.position - found.last.haptic.position;
        assert!(
            norm(&apart) < 1e-6,
            "{what}: {:e} m from the hand",
            norm(&apart)
        );
    }
}

#[test]
fn on_the_other_side_of_the_gingiva_the_probe_stays_on_its_own() {
    for gap in GAPS {
        let found = interrupted(0, gap, |before, _, outward, _| {
            Pose::new(before.position + outward * 6e-3, before.orientation)
        });
        let what = format!("other side, {gap} ms");
        holds(&what, &found);
        assert!(found.farthest < 6e-3, "{what}: {:e} m", found.farthest);
        // Against the hand's pull the probe has not passed the gingiva: it has not met the hand.
        assert!(found.met.is_none(), "{what}: met in tick {:?}", found.met);
        assert!(found.zones.iter().all(|(_, met)| !met), "{what}");
    }
}

#[test]
fn a_hand_that_returns_in_motion_adds_its_own_motion_alone() {
    let found = interrupted(0, 1000, |before, k, outward, up| {
        let t = k as f64 * 1e-3;
        let at = before.position + up * (2e-3 * (1.0 - t)) + outward * (1e-3 * libm::sin(9.0 * t));
        Pose::new(
            at,
            exp_rotation(&(outward * (0.05 * t))) * before.orientation,
        )
    });
    holds("in motion", &found);
    assert!(norm(&(found.last.graphic.transform(&Vec3::zeros()) - found.stood)) > 0.0);
}
