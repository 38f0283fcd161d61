//! Stiffness and ways beyond all sense give finite numbers, and the same inputs the same bits.

use sulcus_core::output::status;
use sulcus_core::{Scene, State};

use super::run::{Run, SITES, go_in, model, scene_with, way};

#[test]
fn never_a_number_that_is_not_finite() {
    for stiff in [1.0, 1000.0] {
        let mut scene = scene_with(&[]);
        let params = &mut model(&mut scene).params;
        params.wall_stiffness *= stiff;
        params.shear_stiffness *= stiff;
        params.floor_stiffness *= stiff;
        params.shear_stiffness = params.shear_stiffness.min(1e6);
        scene.validate().expect("in range");
        let (degrees, depth) = SITES[1];
        let way = way(&scene, degrees, depth);
        let mut run = Run::new(&scene);
        let tool = run.scene.tools[0].clone();
        go_in(&mut run, &way, 0.0);
        for k in 0..1500 {
            // To and fro by 20 mm, across tooth and gingiva, and straight into the floor by 15.
            let mut pose = way.pose(
                &tool,
                -1.5e-2 * f64::from(k % 3 == 1),
                0.3 * f64::from(k % 5),
                4e-3,
            );
            pose.position += way.outward * (2e-2 * f64::from(k / 7 % 3) - 2e-2);
            let out = run.tick(&pose);
            let o = &out.tools[0];
            assert_eq!(o.status & status::FAULT, 0, "tick {k}");
            let parts = [
                o.raw_wrench.force,
                o.raw_wrench.torque,
                o.wrench.force,
                o.graphic.position,
            ];
            assert!(parts.iter().flatten().all(|x| x.is_finite()), "tick {k}");
            assert!(run.state.tissue.iter().all(|x| x.is_finite()), "tick {k}");
        }
        let m = run.measures();
        let residual = m.residual.max(m.exhausted_residual);
        assert!(residual < 1e-4, "{stiff}: {residual:e} m");
    }
}

#[test]
fn the_same_inputs_give_the_same_bits_also_from_a_state_saved_midway() {
    let scene = scene_with(&[]);
    let (degrees, depth) = SITES[2];
    let way = way(&scene, degrees, depth);
    let tool = scene.tools[0].clone();
    let input = |k: u32| {
        let t = f64::from(k) * 1e-3;
        let turn = 0.15 * libm::sin(5.0 * t);
        Run::input(&way.pose(&tool, 4e-3 - 8e-3 * t.min(0.6), turn, 4e-3))
    };
    let mut first = Run::new(&scene);
    let mut hashes = Vec::new();
    let mut saved = Vec::new();
    for k in 0..1200 {
        hashes.push(first.step(&input(k)).hash);
        if k == 700 {
            saved = first.state.to_bytes();
        }
    }
    assert!(first.state.tissue.iter().any(|x| *x != 0.0));
    let mut second = Run::new(&scene);
    // Tables and scratch of a longer life do not show.
    second.ws = first.ws;
    for k in 0..1200 {
        assert_eq!(second.step(&input(k)).hash, hashes[k as usize], "tick {k}");
    }
    let mut third = Run::new(&scene);
    third.state = State::from_bytes(&scene, &saved).expect("a state");
    for k in 701..1200 {
        assert_eq!(third.step(&input(k)).hash, hashes[k as usize], "tick {k}");
    }
    // And the scene is bytes.
    let bytes = scene.to_bytes().expect("bytes");
    assert_eq!(Scene::from_bytes(&bytes).expect("a scene"), scene);
}
