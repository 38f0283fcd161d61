//! What is read in a pocket: its depth at a force, zones of force, and nothing outside.

use sulcus_cases::pocket::gingiva_of;
use sulcus_core::TickOutput;
use sulcus_core::output::{ForceZone, status};

use super::run::{Feeler, Run, SITES, go_in, model, scene_with, way};

#[test]
fn the_prescribed_depth_is_read_at_probing_force_and_more_at_more() {
    let mut scene = scene_with(&[]);
    let params = model(&mut scene).params;
    for (degrees, depth) in SITES {
        let way = way(&scene, degrees, depth);
        let mut run = Run::new(&scene);
        go_in(&mut run, &way, 0.0);
        let mut hand = Feeler::default();
        let mut read = |newtons| hand.press_to(&mut run, &way, newtons);
        let readings = [0.2, 0.25, 0.6].map(&mut read);
        let over = (0.6 - params.reading_force) / params.floor_stiffness;
        let [light, firm, heavy] = readings.map(|p| p.depth);
        println!(
            "{degrees}: {:.2} mm prescribed; {:.2} at 0.2 N, {:.2} at 0.25 N, {:.2} at 0.6 N (by the parameters {:.2})",
            depth * 1e3,
            light * 1e3,
            firm * 1e3,
            heavy * 1e3,
            (depth + over) * 1e3
        );
        for found in [light, firm] {
            assert!((found - depth).abs() <= 0.3e-3, "{degrees}: {found:e} m");
        }
        assert!(
            (heavy - depth - over).abs() <= 0.3e-3,
            "{degrees}: {heavy:e} m"
        );
        let around = if degrees > 180.0 {
            degrees - 360.0
        } else {
            degrees
        };
        for reading in readings {
            assert!((reading.around.to_degrees() - around).abs() < 10.0);
            assert_eq!(reading.object, 1);
        }
        let residual = run.measures().residual;
        assert!(residual < 1e-6, "{residual:e} m");
    }
    // Inflamed: the same force goes deeper, by what the parameters say.
    model(&mut scene).params.inflammation = 1.0;
    let (degrees, depth) = SITES[3];
    let way = way(&scene, degrees, depth);
    let mut run = Run::new(&scene);
    go_in(&mut run, &way, 0.0);
    let inflamed = Feeler::default()
        .press_to(&mut run, &way, params.reading_force)
        .depth;
    let more = params.sink() * (1.0 / (1.0 - params.softening) - 1.0);
    println!(
        "inflamed: {:.2} mm, by the parameters {:.2}",
        inflamed * 1e3,
        (depth + more) * 1e3
    );
    assert!((inflamed - depth - more).abs() <= 0.3e-3, "{inflamed:e} m");
}

#[test]
fn a_heavy_hand_is_an_event_once_until_it_was_lighter() {
    let scene = scene_with(&[]);
    let (degrees, depth) = SITES[4];
    let way = way(&scene, degrees, depth);
    let mut run = Run::new(&scene);
    go_in(&mut run, &way, 0.0);
    let mut events = Vec::new();
    let mut hand = Feeler::default();
    // Target forces on the floor; each is gone to at two millimetres a second.
    for target in [0.2, 0.3, 0.22, 0.3, 0.15, 0.3, 0.6, 0.45, 0.6, 0.1] {
        let mut tick = |run: &mut Run, step: f64| {
            let out = hand.step(run, &way, step);
            let reading = out.tools[0].pocket.expect("in the pocket");
            if reading.entered_zone {
                events.push((target, reading.zone));
            }
            reading.floor_force
        };
        let mut now = tick(&mut run, 0.0);
        let step = if now < target { 2e-6 } else { -2e-6 };
        while (now < target) == (step > 0.0) {
            now = tick(&mut run, step);
        }
    }
    use ForceZone::{TooHeavy, Trauma};
    assert_eq!(events, [(0.3, TooHeavy), (0.3, TooHeavy), (0.6, Trauma)]);
}

#[test]
fn an_answer_that_is_not_applied_is_no_load_and_no_event() {
    let scene = scene_with(&[]);
    let (degrees, depth) = SITES[4];
    let way = way(&scene, degrees, depth);
    let mut run = Run::new(&scene);
    go_in(&mut run, &way, 0.0);
    let mut hand = Feeler::default();
    hand.press_to(&mut run, &way, 0.3);
    let reading = |out: &TickOutput| out.tools[0].pocket.expect("in the pocket");
    let before = reading(&run.last.expect("a tick"));
    let iterations = run.scene.params.max_iterations;
    for failing in [true, false] {
        // Without iterations the solver has nothing that could be applied; what it began with is in its output.
        run.scene.params.max_iterations = if failing { 0 } else { iterations };
        for k in 0..20 {
            let out = hand.step(&mut run, &way, 0.0);
            assert_eq!(out.tools[0].status & status::SOLVER_FAILED != 0, failing);
            let now = reading(&out);
            assert!(!now.entered_zone && now.zone == before.zone, "{k}: {now:?}");
            let same = (now.floor_force - before.floor_force).abs() < 0.05;
            assert!(same, "{k}: {now:?}, before {before:?}");
            assert!(!failing || now.floor_force == before.floor_force);
        }
    }
}

#[test]
fn nothing_is_read_above_the_margin_or_outside() {
    let scene = scene_with(&[]);
    let (_, _, gingiva) = gingiva_of(&scene).expect("a gingiva");
    let tool = scene.tools[0].clone();
    for (degrees, depth) in SITES {
        let way = way(&scene, degrees, depth);
        let mut run = Run::new(&scene);
        let mut entered = None;
        for k in 0..1500 {
            let above = (8e-3 - 8e-6 * f64::from(k)).max(0.0);
            let out = run.tick(&way.pose(&tool, above, 0.0, 0.0));
            let tip = out.tools[0].graphic.transform(&tool.tip);
            let (around, height) = gingiva.tooth.cylindrical(&tip);
            let below = gingiva.margin_at(around) - height;
            let reading = out.tools[0].pocket;
            assert_eq!(reading.is_some(), below > 0.0, "{degrees}: {below:e} m");
            entered = entered.or(reading.map(|_| k));
            if let Some(reading) = reading {
                assert!((reading.depth - below).abs() < 1e-12);
            }
        }
        assert!(entered.is_some(), "{degrees}");
        // Along the outer face, as deep: not a pocket.
        let mut run = Run::new(&scene);
        for k in 0..1500 {
            let mut pose = way.pose(&tool, (8e-3 - 8e-6 * f64::from(k)).max(0.0), 0.0, 0.0);
            pose.position += way.outward * 4e-3;
            let out = run.tick(&pose);
            assert_eq!(out.tools[0].pocket, None, "{degrees}: tick {k}");
        }
    }
}
