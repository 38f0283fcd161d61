//! Tests of the whole tick on small analytic scenes.

use crate::math::{Mat3, Pose, Quat, Vec3, Wrench, exp_rotation, log_rotation, norm};
use crate::output::status;
use crate::tissue::{TissueModel, tests::Winkler};
use crate::tree::{Sphere, SphereTree};
use crate::*;

mod apart;
mod soft_bed;

/// Returns a straight rod of spheres of radius 0.25 mm along z, with its frame at the device.
pub(crate) fn rod_tool(working_point: Vec3) -> Tool {
    let spheres: Vec<Sphere> = (0..60)
        .map(|k| Sphere {
            centre: Vec3::new(0.0, 0.0, -0.09 + 0.00025 * f64::from(k)),
            radius: 2.5e-4,
        })
        .collect();
    Tool {
        name: "rod".into(),
        tree: SphereTree::over_leaves(&spheres).expect("valid"),
        level: 3,
        working_point,
        tip: Vec3::new(0.0, 0.0, -0.09025),
        tip_axis: -Vec3::z(),
        stiffness_n_per_m: 500.0,
        stiffness_nm_per_rad: 0.5,
        park: Pose::new(Vec3::new(0.0, 0.0, 0.1), Quat::identity()),
        bands: vec![],
        mesh: DisplayMesh::default(),
    }
}

fn ball(radius: f64, tissue: TissueModel) -> Object {
    let tree = SphereTree::over_leaves(&[Sphere {
        centre: Vec3::new(0.0, 0.0, -radius),
        radius,
    }])
    .expect("valid");
    Object {
        name: "ball".into(),
        fdi: 0,
        tree,
        level: 3,
        tissue,
        mesh: DisplayMesh::default(),
        carriers: Vec::new(),
    }
}

fn scene(objects: Vec<Object>) -> Scene {
    Scene {
        name: "test".into(),
        source_hash: String::new(),
        params: Params::default(),
        tools: vec![rod_tool(Vec3::new(0.0, 0.0, -0.086))],
        objects,
    }
}

/// Returns the scene of the rod and a rigid ball.
pub(crate) fn scene_of_a_ball() -> Scene {
    scene(vec![ball(0.01, TissueModel::Rigid)])
}

fn at(position: Vec3, orientation: Quat) -> TickInput {
    let mut input = TickInput::IDLE;
    input.tools[0] = ToolInput {
        pose: (&Pose::new(position, orientation)).into(),
        present: true,
        ..ToolInput::ABSENT
    };
    input
}

/// Returns the input with the tip at height `z` above the ball's top pole, metres.
fn tip_at(z: f64) -> TickInput {
    at(Vec3::new(0.0, 0.0, 0.09025 + z), Quat::identity())
}

#[test]
fn a_press_on_a_rigid_ball_stops_at_the_surface_with_hookes_force() {
    let scene = scene(vec![ball(0.01, TissueModel::Rigid)]);
    let (mut state, mut ws) = (State::new(&scene), Workspace::new(&scene));
    let mut out = tick(&scene, &mut state, &mut ws, &tip_at(0.001), &mut NoProbe);
    for k in 0..600 {
        let depth = 0.001 - 0.003 * f64::from(k.min(300)) / 300.0;
        out = tick(&scene, &mut state, &mut ws, &tip_at(depth), &mut NoProbe);
        assert!(
            out.tools[0].min_gap > -1e-6,
            "tick {k}: {:e}",
            out.tools[0].min_gap
        );
    }
    assert!(out.tools[0].converged);
    let force = out.tools[0].wrench.force;
    // 2 mm deep at 500 N/m, up to the f32 precision of the input.
    assert!(
        (force.z - 1.0).abs() < 1e-3 && force.x.abs() < 1e-4,
        "{force:?}"
    );
    assert_eq!(out.tools[0].status, 0);
}

#[test]
fn loads_on_objects_are_the_wrench_and_the_coupling() {
    let scene = scene(vec![ball(0.01, TissueModel::Rigid)]);
    let (mut state, mut ws) = (State::new(&scene), Workspace::new(&scene));
    for k in 0..400 {
        let s = f64::from(k) / 400.0;
        let tilt = exp_rotation(&Vec3::new(0.2 * s, -0.1 * s, 0.05));
        let pose = Pose::new(
            Vec3::new(0.001 * s, 0.0005, 0.09025 + 0.0005 - 0.002 * s),
            tilt,
        );
        let out = tick(
            &scene,
            &mut state,
            &mut ws,
            &at(pose.position, pose.orientation),
            &mut NoProbe,
        );
        if !out.tools[0].converged || k < 50 {
            continue;
        }
        let tool = &scene.tools[0];
        let o = &out.tools[0];
        // Wrench from the multipliers, summed independently.
        let mut from_lambda = Wrench::ZERO;
        for (contact, lambda) in ws.contacts() {
            assert!(lambda >= 0.0);
            from_lambda.force += contact.normal * lambda;
            from_lambda.torque += contact.arm.cross(&(contact.normal * lambda));
        }
        let from_lambda = from_lambda.moved(&(o.haptic.orientation * tool.working_point));
        assert!(norm(&(from_lambda.force - o.raw_wrench.force)) < 1e-9);
        assert!(norm(&(from_lambda.torque - o.raw_wrench.torque)) < 1e-9);
        // Wrench from the coupling: G (q_g - q_h).
        let stretch =
            o.graphic.transform(&tool.working_point) - o.haptic.transform(&tool.working_point);
        let spring = Wrench {
            force: stretch * tool.stiffness_n_per_m,
            torque: -log_rotation(&(o.haptic.orientation * o.graphic.orientation.inverse()))
                * tool.stiffness_nm_per_rad,
        }
        .moved(&(o.haptic.orientation * tool.working_point));
        let scale = norm(&o.raw_wrench.force) + 1e-6;
        assert!(
            norm(&(spring.force - o.raw_wrench.force)) < 0.01 * scale,
            "tick {k}"
        );
        assert!(
            norm(&(spring.torque - o.raw_wrench.torque)) < 0.01 * (scale * 0.09),
            "tick {k}"
        );
    }
}

#[test]
fn a_yielding_ball_shares_the_press_by_both_compliances() {
    // Coupling 500 N/m in series with tissue of 1/C = 250 N/m along z: F = depth / (1/500 + 1/250).
    let compliance = Mat3::from_diagonal(&Vec3::new(0.001, 0.001, 0.004));
    let scene = scene(vec![ball(
        0.01,
        TissueModel::Winkler(Winkler { compliance }),
    )]);
    let (mut state, mut ws) = (State::new(&scene), Workspace::new(&scene));
    let mut out = tick(&scene, &mut state, &mut ws, &tip_at(0.001), &mut NoProbe);
    for k in 0..600 {
        out = tick(
            &scene,
            &mut state,
            &mut ws,
            &tip_at(0.001 - 0.004 * f64::from(k.min(300)) / 300.0),
            &mut NoProbe,
        );
        assert!(out.tools[0].min_gap > -1e-6);
    }
    let expected = 0.003 / (1.0 / 500.0 + 0.004);
    assert!(
        (out.tools[0].raw_wrench.force.z - expected).abs() < 1e-3,
        "{:?} {expected}",
        out.tools[0]
    );
    // Action equals reaction: the ball moved by C times the load.
    let moved = ws.shape_of(0)[2];
    assert!((moved + 0.004 * expected).abs() < 1e-5, "{moved}");
}

#[test]
fn entry_travels_from_the_park_pose_and_the_force_ramps() {
    let scene = scene(vec![ball(0.01, TissueModel::Rigid)]);
    let (mut state, mut ws) = (State::new(&scene), Workspace::new(&scene));
    // The hand starts deep inside the ball.
    let mut last = 0.0;
    for k in 0..700 {
        let out = tick(&scene, &mut state, &mut ws, &tip_at(-0.002), &mut NoProbe);
        let o = &out.tools[0];
        assert!(o.min_gap > -1e-6, "tick {k}");
        assert!(
            (o.wrench.force.z - last).abs() < 0.1,
            "tick {k}: {} after {last}",
            o.wrench.force.z
        );
        last = o.wrench.force.z;
    }
    assert!((last - 1.0).abs() < 1e-3, "{last}");
}

#[test]
fn absence_ramps_out_and_return_never_jumps() {
    let scene = scene(vec![ball(0.01, TissueModel::Rigid)]);
    let (mut state, mut ws) = (State::new(&scene), Workspace::new(&scene));
    let mut last = 0.0;
    for k in 0..2100 {
        let mut input = tip_at(-0.002);
        input.tools[0].present = !(700..900).contains(&k);
        input.paused = (1500..1600).contains(&k);
        let out = tick(&scene, &mut state, &mut ws, &input, &mut NoProbe);
        let force = out.tools[0].wrench.force.z;
        assert!((force - last).abs() < 0.1, "tick {k}: {force} after {last}");
        if k == 899 || k == 1599 {
            assert!(force.abs() < 1e-9, "tick {k}: {force}");
        }
        last = force;
    }
    assert!((last - 1.0).abs() < 1e-3, "{last}");
}

#[test]
fn the_same_inputs_give_the_same_hashes_from_a_snapshot_and_a_fresh_workspace() {
    let scene = scene(vec![ball(0.01, TissueModel::Rigid)]);
    let (mut state, mut ws) = (State::new(&scene), Workspace::new(&scene));
    let input = |k: u32| tip_at(0.0005 - 0.002 * f64::from(k % 100) / 100.0);
    let mut snapshot = Vec::new();
    let mut hashes = Vec::new();
    for k in 0..400 {
        if k == 200 {
            snapshot = state.to_bytes();
        }
        hashes.push(tick(&scene, &mut state, &mut ws, &input(k), &mut NoProbe).hash);
    }
    let mut restored = State::from_bytes(&scene, &snapshot).expect("own bytes");
    assert_eq!(restored.to_bytes(), snapshot);
    for k in 200..400 {
        // A fresh workspace in every tick: no cache may affect a result.
        let mut fresh = Workspace::new(&scene);
        let hash = tick(&scene, &mut restored, &mut fresh, &input(k), &mut NoProbe).hash;
        assert_eq!(hash, hashes[k as usize], "tick {k}");
    }
}

#[test]
fn one_flipped_bit_of_input_changes_the_hash() {
    let scene = scene(vec![ball(0.01, TissueModel::Rigid)]);
    let hash = |input: &TickInput| {
        tick(
            &scene,
            &mut State::new(&scene),
            &mut Workspace::new(&scene),
            input,
            &mut NoProbe,
        )
        .hash
    };
    let input = tip_at(0.001);
    let mut bytes = input.to_bytes();
    bytes[20] ^= 1;
    assert_ne!(
        hash(&input),
        hash(&TickInput::from_bytes(&bytes).expect("a float's bit"))
    );
}

#[test]
fn a_full_contact_list_is_said_and_nothing_is_passed_through() {
    // The plate is so dense that 16 rows cannot hold the contacts within `d`.
    let spheres: Vec<Sphere> = (0..400)
        .map(|k| Sphere {
            centre: Vec3::new(
                f64::from(k % 20 - 10) * 2e-5,
                f64::from(k / 20 - 10) * 2e-5,
                -3e-4,
            ),
            radius: 3e-4,
        })
        .collect();
    let mut plate = ball(0.01, TissueModel::Rigid);
    plate.tree = SphereTree::over_leaves(&spheres).expect("valid");
    let mut scene = scene(vec![plate]);
    scene.params.max_contacts = 16;
    let (mut state, mut ws) = (State::new(&scene), Workspace::new(&scene));
    let mut full = false;
    for k in 0..300 {
        let out = tick(
            &scene,
            &mut state,
            &mut ws,
            &tip_at(0.002 - 1e-5 * f64::from(k)),
            &mut NoProbe,
        );
        full |= out.tools[0].status & status::CONTACTS_FULL != 0;
        // The tip, 90.25 mm below the device, stays above the plate's crest.
        assert!(out.tools[0].graphic.position.z > 0.09025 - 1e-4, "tick {k}");
    }
    assert!(full);
    // A full list must not hold the tool on its way back.
    let mut lag = f64::INFINITY;
    for k in 0..300 {
        let out = tick(
            &scene,
            &mut state,
            &mut ws,
            &tip_at(-0.001 + 4e-5 * f64::from(k)),
            &mut NoProbe,
        );
        lag = norm(&(out.tools[0].graphic.position - out.tools[0].haptic.position));
    }
    assert!(lag < 1e-6, "{lag:e} m behind the hand");
}

#[test]
fn a_solver_without_an_answer_lets_the_hand_go_gently() {
    let mut scene = scene(vec![ball(0.01, TissueModel::Rigid)]);
    let (mut state, mut ws) = (State::new(&scene), Workspace::new(&scene));
    for _ in 0..700 {
        tick(&scene, &mut state, &mut ws, &tip_at(-0.002), &mut NoProbe);
    }
    let mut last = state.tools[0].sent.force.z;
    assert!(last > 0.9);
    let stood = state.tools[0].graphic;
    scene.params.max_iterations = 0;
    for k in 0..100 {
        let out = tick(
            &scene,
            &mut state,
            &mut ws,
            &tip_at(-0.002 - 1e-6 * f64::from(k)),
            &mut NoProbe,
        );
        assert!(out.tools[0].status & status::SOLVER_FAILED != 0);
        assert_eq!(
            out.tools[0].graphic, stood,
            "no unusable answer may move the tool"
        );
        let force = out.tools[0].wrench.force.z;
        assert!((force - last).abs() < 0.1, "tick {k}: {force} after {last}");
        last = force;
    }
    assert_eq!(last, 0.0);
}

#[test]
fn a_state_that_no_tick_makes_is_refused() {
    let scene = scene(vec![ball(0.01, TissueModel::Rigid)]);
    let good = State::new(&scene);
    let refused = |change: fn(&mut State)| {
        let mut state = good.clone();
        change(&mut state);
        State::from_bytes(&scene, &state.to_bytes()).is_err()
    };
    assert!(!refused(|_| {}));
    assert!(refused(|state| state.tick = u64::MAX));
    assert!(refused(|state| state.tools[0].gain = 50.0));
    assert!(refused(|state| state.tools[0].sent.force.x = 1000.0));
    assert!(refused(|state| state.tools[0].sent.torque.y = f64::NAN));
    assert!(refused(|state| state.tools[1].twist_axis.z = 2.0));
    assert!(State::from_bytes(&scene, &good.to_bytes()[1..]).is_err());
}

#[test]
fn two_tools_have_two_problems_and_both_can_be_judged() {
    let mut scene = scene(vec![ball(0.01, TissueModel::Rigid)]);
    scene.tools.push(rod_tool(Vec3::new(0.0, 0.0, -0.086)));
    let (mut state, mut ws) = (State::new(&scene), Workspace::new(&scene));
    for _ in 0..300 {
        let mut input = tip_at(-0.002);
        let beside = Pose::new(Vec3::new(0.002, 0.0, 0.08905), Quat::identity());
        input.tools[1] = ToolInput {
            pose: (&beside).into(),
            present: true,
            ..ToolInput::ABSENT
        };
        tick(&scene, &mut state, &mut ws, &input, &mut NoProbe);
    }
    assert_eq!(ws.last_problems(&scene).count(), 2);
    let loaded = |tool: u8| {
        ws.contacts()
            .any(|(c, lambda)| c.tool == tool && lambda > 0.1)
    };
    assert!(loaded(0) && loaded(1));
    assert!(crate::optimise::audit::audit(&scene, &ws).is_some_and(|v| v.judge_solved));
}

#[test]
fn the_judge_confirms_a_tick_in_contact() {
    let scene = scene(vec![ball(0.01, TissueModel::Rigid)]);
    let (mut state, mut ws) = (State::new(&scene), Workspace::new(&scene));
    for k in 0..300 {
        let depth = 0.001 - 0.003 * f64::from(k) / 300.0;
        tick(&scene, &mut state, &mut ws, &tip_at(depth), &mut NoProbe);
        let Some(verdict) = crate::optimise::audit::audit(&scene, &ws) else {
            continue;
        };
        assert!(
            verdict.judge_solved && verdict.kkt_residual < 1e-9,
            "tick {k}: {verdict:?}"
        );
        assert!(verdict.pose_difference < 2e-7, "tick {k}: {verdict:?}");
    }
    assert!(crate::optimise::audit::audit(&scene, &ws).is_some());
}

#[test]
fn a_device_that_sends_only_unusable_poses_is_let_go() {
    let scene = scene(vec![ball(0.01, TissueModel::Rigid)]);
    let (mut state, mut ws) = (State::new(&scene), Workspace::new(&scene));
    let mut last = 0.0;
    for k in 0..1500 {
        let mut input = tip_at(-0.002);
        if (700..900).contains(&k) {
            input.tools[0].pose.position[1] = f32::NAN;
        }
        let out = tick(&scene, &mut state, &mut ws, &input, &mut NoProbe);
        let force = out.tools[0].wrench.force.z;
        assert!((force - last).abs() < 0.1, "tick {k}: {force} after {last}");
        if k == 740 {
            assert!(force > 0.9, "a few bad poses are nothing: {force}");
        }
        if k == 899 {
            assert_eq!(
                (force, out.tools[0].status & status::STALE),
                (0.0, status::STALE)
            );
        }
        last = force;
    }
    assert!((last - 1.0).abs() < 1e-3, "{last}");
}

/// Returns a bumpy plate of spheres with blend length `blend`, metres; 0 for hard spheres.
fn plate(blend: f64) -> Object {
    let spheres: Vec<Sphere> = (0..900)
        .map(|k| Sphere {
            centre: Vec3::new(
                f64::from(k % 30 - 15) * 3e-4,
                f64::from(k / 30 - 15) * 3e-4,
                -1e-3,
            ),
            radius: 1e-3,
        })
        .collect();
    let mut plate = ball(0.01, TissueModel::Rigid);
    plate.level = tree::MAX_LEVEL;
    let tree = SphereTree::over_leaves(&spheres).expect("valid");
    let blending = Blending {
        lengths: vec![blend; usize::from(tree.depth()) + 1],
        insets: vec![2.0 * blend; tree.nodes().len()],
    };
    plate.tree = tree.with_blending(blending).expect("valid");
    plate
}

/// Returns the input of tick `k` over the plate: tilted, down to 1 mm deep.
fn over_plate(k: u32) -> TickInput {
    let s = f64::from(k) / 400.0;
    let tilt = exp_rotation(&Vec3::new(0.2 * s, -0.1 * s, 0.05));
    let tip = Vec3::new(0.002 * s, 0.0005, 0.0005 - 0.0015 * s);
    at(tip + tilt * Vec3::new(0.0, 0.0, 0.09025), tilt)
}

#[test]
fn on_a_blended_surface_contacts_add_up_to_the_wrench_and_to_the_loads() {
    let scene = scene(vec![plate(3e-5)]);
    let (mut state, mut ws) = (State::new(&scene), Workspace::new(&scene));
    let mut pressed = 0;
    for k in 0..400 {
        let out = tick(&scene, &mut state, &mut ws, &over_plate(k), &mut NoProbe);
        let (tool, o) = (&scene.tools[0], &out.tools[0]);
        assert!(o.min_gap > -1e-6, "tick {k}: {:e}", o.min_gap);
        if !o.converged || norm(&o.raw_wrench.force) < 0.05 {
            continue;
        }
        pressed += 1;
        let (mut sum, mut loaded) = (Wrench::ZERO, 0);
        for (contact, load) in ws.contacts() {
            assert!(load >= 0.0);
            loaded += u32::from(load > 0.0);
            sum.force += contact.normal * load;
            sum.torque += contact.arm.cross(&(contact.normal * load));
        }
        assert!(loaded > 3, "tick {k}: a blended row has {loaded} members");
        let at_hand = sum.moved(&(o.haptic.orientation * tool.working_point));
        assert!(norm(&(at_hand.force - o.raw_wrench.force)) < 1e-9);
        assert!(norm(&(at_hand.torque - o.raw_wrench.torque)) < 1e-9);
        assert!(norm(&(state.loads[0].force + sum.force)) < 1e-9);
        // Wrench from the coupling: G (q_g - q_h).
        let stretch =
            o.graphic.transform(&tool.working_point) - o.haptic.transform(&tool.working_point);
        let spring = stretch * tool.stiffness_n_per_m;
        assert!(
            norm(&(spring - o.raw_wrench.force)) < 0.01 * norm(&spring),
            "tick {k}"
        );
    }
    assert!(pressed > 200, "{pressed}");
}

#[test]
fn without_blending_a_calibrated_tree_gives_the_bits_of_a_hard_one() {
    let run = |blend: f64, on: bool| {
        let mut scene = scene(vec![plate(blend)]);
        scene.params.blend = on;
        let (mut state, mut ws) = (State::new(&scene), Workspace::new(&scene));
        let hashes =
            (0..400).map(|k| tick(&scene, &mut state, &mut ws, &over_plate(k), &mut NoProbe).hash);
        hashes.collect::<Vec<_>>()
    };
    let hard = run(0.0, true);
    assert_eq!(hard, run(3e-5, false));
    assert_ne!(hard, run(3e-5, true));
}

#[test]
fn a_blended_scene_survives_its_bytes_and_needs_no_history() {
    let scene = scene(vec![plate(3e-5)]);
    let back = Scene::from_bytes(&scene.to_bytes().expect("small")).expect("own bytes");
    assert_eq!(back, scene);
    let (mut one, mut two) = (State::new(&scene), State::new(&back));
    let mut ws = Workspace::new(&scene);
    for k in 0..300 {
        let kept = tick(&scene, &mut one, &mut ws, &over_plate(k), &mut NoProbe);
        let fresh = tick(
            &back,
            &mut two,
            &mut Workspace::new(&back),
            &over_plate(k),
            &mut NoProbe,
        );
        assert_eq!(kept, fresh, "tick {k}");
    }
}
