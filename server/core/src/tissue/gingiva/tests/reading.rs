//! Tests of the pocket: condition for a tip in the pocket, and the reading there.

use super::*;
use crate::math::{Pose, Quat};
use crate::tissue::{Hand, SiteLoad};
use crate::{DisplayMesh, NoProbe, Object, Params, Scene, State, TickInput, Tool, Workspace, tick};

/// Returns a straight tool whose device point is its tip.
fn needle() -> Tool {
    let ball = Sphere {
        centre: Vec3::zeros(),
        radius: 1e-4,
    };
    Tool {
        name: "needle".into(),
        tree: SphereTree::over_leaves(&[ball]).expect("valid"),
        level: 0,
        working_point: Vec3::zeros(),
        tip: Vec3::zeros(),
        tip_axis: -Vec3::z(),
        stiffness_n_per_m: 500.0,
        stiffness_nm_per_rad: 0.5,
        park: Pose::identity(),
        bands: Vec::new(),
        mesh: DisplayMesh::default(),
    }
}

#[test]
fn the_floor_force_is_the_axial_load_on_the_floor_by_a_tool_in_the_pocket() {
    let spots = [([0.0; 3], 0.0, -1e-4), ([2e-3, 0.0, 0.0], 0.0, 1e-3)];
    let (model, rest, ids) = gingiva(&spots, GingivaParams::default());
    let (floor, wall) = if model.places[ids[0] as usize].floor {
        (ids[0], ids[1])
    } else {
        (ids[1], ids[0])
    };
    let mut ready = Ready::new(&model, &rest, TICK_S);
    let mut state = vec![0.0; model.state_len(&rest)];
    let load = |sphere, tool, z| SiteLoad {
        sphere,
        tool,
        force: Vec3::new(0.7, 0.1, z),
    };
    let loads = [
        load(floor, 0, -0.2),
        load(floor, 0, -0.1),
        load(wall, 0, -5.0),
        load(floor, 1, -0.6),
    ];
    let tool = needle();
    let hand = |x: f64| {
        let pose = Pose::new(Vec3::new(x, 0.0, 0.0), Quat::identity());
        Hand {
            tool: &tool,
            haptic: pose,
            graphic: pose,
            loads: &[],
        }
    };
    let inside = Hands {
        tools: [Some(hand(1e-3)), Some(hand(0.5e-3))],
        detail: 0,
    };
    let shape = vec![0.0; ready.shape_len()];
    ready.commit(&shape, Some(&loads), &inside, &mut state);
    assert!((state[0] - 0.3).abs() < 1e-15 && state[1..3] == [1.0, 1.0]);
    assert!((state[3] - 0.6).abs() < 1e-15 && state[4..6] == [2.0, 1.0]);
    let (_, reading) = ready.reading(1, &inside, &state).expect("in the pocket");
    assert_eq!((reading.depth, reading.around), (2e-3, 0.0));
    assert_eq!(
        (reading.zone, reading.entered_zone),
        (ForceZone::Trauma, true)
    );
    // An event lasts one tick. A pull does not count as a press.
    let pull = [loads[0], loads[1], load(floor, 1, 0.6)];
    ready.commit(&shape, Some(&pull), &inside, &mut state);
    assert_eq!((state[1], state[2]), (1.0, 0.0));
    assert_eq!(state[3..6], [0.0, 0.0, 0.0]);
    // The same loads do not count for a tip outside the wall. The loads count once the wall is pushed out past the tip.
    let outside = Hands {
        tools: [Some(hand(2.2e-3)), None],
        detail: 0,
    };
    ready.commit(&shape, Some(&loads), &outside, &mut state);
    assert_eq!(state[..3], [0.0; 3]);
    assert_eq!(ready.reading(0, &outside, &state), None);
    let mut pushed = shape.clone();
    pushed.fill(0.5e-3);
    ready.commit(&pushed, Some(&loads), &outside, &mut state);
    assert!((state[0] - 0.3).abs() < 1e-15);
    // The tissue is not at rest while the memory of a tool is not zero.
    ready.commit(&shape, Some(&loads), &inside, &mut state);
    let (mut shape, mut free) = (shape.clone(), shape.clone());
    assert!(!ready.free_step(&state, &NOBODY, &mut shape, &mut free));
    ready.commit(&shape, Some(&[]), &NOBODY, &mut state);
    assert!(ready.free_step(&state, &NOBODY, &mut shape, &mut free));
}

#[test]
fn a_tip_that_slipped_out_between_two_papillae_is_in_no_pocket() {
    // The tip is straight behind the wall. The sphere nearest to the tip is farther on and faces another way.
    let on = std::f64::consts::FRAC_PI_2;
    let spots = [
        ([2e-3, 0.0, 0.0], 0.0, 1e-3),
        ([3.2e-3, 5e-4, 0.0], on, 1e-3),
    ];
    let (model, rest, _) = gingiva(&spots, GingivaParams::default());
    let ready = Ready::new(&model, &rest, TICK_S);
    let state = vec![0.0; model.state_len(&rest)];
    let tool = needle();
    let reading = |x: f64| {
        let pose = Pose::new(Vec3::new(x, 0.0, 0.0), Quat::identity());
        let hand = Hand {
            tool: &tool,
            haptic: pose,
            graphic: pose,
            loads: &[],
        };
        let hands = Hands {
            tools: [Some(hand), None],
            detail: 0,
        };
        ready.reading(0, &hands, &state)
    };
    assert_eq!(reading(2.8e-3), None);
    let (squared, _) = reading(1.75e-3).expect("between tooth and wall");
    assert!((squared - 6.25e-8).abs() < 1e-15, "{squared:e}");
}

#[test]
fn of_two_pockets_that_claim_a_tip_the_one_with_the_nearer_wall_has_it() {
    // The first pocket belongs to another tooth. Its wall lies 4 mm higher and farther out, and its reading is deeper.
    let object = |wall: [f64; 3], margin: f64| {
        let (mut model, tree, _) = gingiva(
            &[(wall, 0.0, 1e-3), ([0.0, 6e-3, 0.0], 1.0, 1e-3)],
            GingivaParams::default(),
        );
        model.margin.fill(margin);
        Object {
            name: "gingiva".into(),
            fdi: 36,
            level: model.level,
            carriers: Vec::new(),
            mesh: DisplayMesh::default(),
            tissue: TissueModel::Gingiva(Box::new(model)),
            tree,
        }
    };
    let scene = Scene {
        name: "two pockets".into(),
        source_hash: String::new(),
        params: Params::default(),
        tools: vec![needle()],
        objects: vec![
            object([1e-3, 0.0, 4e-3], 4e-3),
            object([6e-4, 0.0, 0.0], 2e-3),
        ],
    };
    scene.validate().expect("valid");
    let (mut state, mut ws) = (State::new(&scene), Workspace::new(&scene));
    let mut input = TickInput::IDLE;
    input.tools[0].present = true;
    input.tools[0].pose = (&Pose::identity()).into();
    let output = tick(&scene, &mut state, &mut ws, &input, &mut NoProbe);
    let reading = output.tools[0].pocket.expect("in a pocket");
    assert_eq!((reading.object, reading.depth), (1, 2e-3));
}
