//! Tests of the printed models against the paper's equations, evaluated independently.

mod gingiva;
mod stability;

use super::pairs::for_each_pair;
use super::skeleton::Graph;
use super::stability::{Spectrum, largest_time_step};
use super::*;
use crate::math::{Pose, Quat, Vec3, Wrench, exp_rotation, norm};
use crate::output::status;
use crate::tick::tests::rod_tool;
use crate::tissue::{Hand, Hands, Tissue, TissueModel};
use crate::tree::{Sphere, SphereTree};
use crate::*;

/// Distance from the device point to the centre of the rod's lowest sphere, metres.
const TIP: f64 = 0.09;

fn rod() -> Tool {
    rod_tool(Vec3::new(0.0, 0.0, -0.086))
}

/// Device pose of an upright rod whose lowest sphere has its centre at `tip`.
fn over(tip: Vec3) -> Pose {
    Pose::new(tip + Vec3::new(0.0, 0.0, TIP), Quat::identity())
}

/// Block of 8 by 8 by 3 spheres at a spacing of 1 mm, radius 0.8 mm, with layers at z = 0, -1 and -2 mm.
fn block() -> SphereTree {
    let spheres: Vec<Sphere> = (0..3)
        .flat_map(|k| (0..8).flat_map(move |i| (0..8).map(move |j| (i, j, k))))
        .map(|(i, j, k)| Sphere {
            centre: Vec3::new(
                f64::from(i) * 1e-3 - 3.5e-3,
                f64::from(j) * 1e-3 - 3.5e-3,
                -1e-3 * f64::from(k),
            ),
            radius: 8e-4,
        })
        .collect();
    SphereTree::over_leaves(&spheres).expect("valid")
}

/// Skeleton of the block's level-2 spheres, each joined to all within 4 mm.
///
/// Spheres below z = -1.4 mm and spheres at the side x < -2.4 mm are fixed.
fn skeleton(tree: &SphereTree) -> PrintedSkeleton {
    let nodes: Vec<(u32, Vec3)> = tree.shape_at(2).map(|(id, n)| (id, n.centre)).collect();
    let mut springs = Vec::new();
    for (at, (i, a)) in nodes.iter().enumerate() {
        for (j, b) in &nodes[at + 1..] {
            if norm(&(a - b)) < 4e-3 {
                springs.push([*i, *j]);
            }
        }
    }
    let low = nodes.iter().filter(|(_, c)| c.x < -2.4e-3 || c.z < -1.4e-3);
    let fixed = low.map(|(id, _)| *id).collect();
    PrintedSkeleton::new(2, springs, fixed)
}

fn scene(tree: SphereTree, tissue: TissueModel) -> Scene {
    Scene {
        name: "printed".into(),
        source_hash: String::new(),
        params: Params::default(),
        tools: vec![rod()],
        objects: vec![Object {
            name: "block".into(),
            fdi: 0,
            tree,
            level: 7,
            tissue,
            mesh: DisplayMesh::default(),
            carriers: Vec::new(),
        }],
    }
}

fn input(pose: &Pose) -> TickInput {
    let mut input = TickInput::IDLE;
    input.tools[0] = ToolInput {
        pose: RawPose::from(pose),
        present: true,
        ..ToolInput::ABSENT
    };
    input
}

fn hands<'a>(tool: &'a Tool, haptic: Pose, graphic: Pose, loads: &'a [Wrench]) -> Hands<'a> {
    Hands {
        tools: [
            Some(Hand {
                tool,
                haptic,
                graphic,
                loads,
            }),
            None,
        ],
        detail: 0,
    }
}

#[test]
fn the_pairs_are_those_of_every_sphere_against_every_sphere() {
    let (tool, tree) = (rod(), block());
    for k in 0..200 {
        let s = f64::from(k);
        let tilt = exp_rotation(&Vec3::new(libm::sin(s), libm::cos(1.7 * s), 0.3));
        let tip = Vec3::new(
            3e-3 * libm::sin(0.3 * s),
            3e-3 * libm::cos(s),
            1.5e-3 * libm::sin(2.0 * s),
        );
        let pose = Pose::new(tip + tilt * Vec3::new(0.0, 0.0, TIP), tilt);
        let (level, d) = ((k % 4) as u8, 2e-4 * f64::from(k % 3));
        let mut found = Vec::new();
        let all = for_each_pair((&tool, &pose, d), (tree.nodes(), level), |o, t| {
            found.push((o, t));
            true
        });
        let mut expected = Vec::new();
        for (o, node) in tree.shape_at(level) {
            for (t, sphere) in tool.tree.shape_at(tool.level) {
                let reach = node.contact_radius + sphere.contact_radius + d;
                if norm(&(pose.transform(&sphere.centre) - node.centre)) < reach {
                    expected.push((o, t));
                }
            }
        }
        found.sort_unstable();
        assert!(all && found == expected, "pose {k}");
        let mut first = 0;
        let stopped = !for_each_pair((&tool, &pose, d), (tree.nodes(), level), |_, _| {
            first += 1;
            false
        });
        assert_eq!(
            (stopped, first),
            (!expected.is_empty(), usize::from(!expected.is_empty()))
        );
    }
}

#[test]
fn loose_or_unknown_spheres_are_refused() {
    let tree = block();
    let mut model = skeleton(&tree);
    model.fixed.clear();
    assert_eq!(
        model
            .validate(&tree, TICK_S)
            .expect_err("nothing held")
            .field,
        "springs"
    );
    let mut model = skeleton(&tree);
    model.springs.push([0, 1]);
    assert_eq!(
        model.validate(&tree, TICK_S).expect_err("the root").field,
        "springs"
    );
    let mut model = skeleton(&tree);
    model.fixed.push(99_999);
    assert_eq!(
        model
            .validate(&tree, TICK_S)
            .expect_err("no such node")
            .field,
        "fixed"
    );
    let mut model = skeleton(&tree);
    model.carriers = vec![model.fixed[0]; 3];
    assert_eq!(
        model.validate(&tree, TICK_S).expect_err("too few").field,
        "carriers"
    );
    model.carriers = vec![0; tree.nodes().len()];
    assert_eq!(
        model.validate(&tree, TICK_S).expect_err("the root").field,
        "carriers"
    );
    let mut model = skeleton(&tree);
    model.mass_kg = f64::NAN;
    assert_eq!(
        model.validate(&tree, TICK_S).expect_err("no mass").field,
        "mass_kg"
    );
}

/// Compares load and step of the first two ticks with an independent evaluation of Eq. 1 to 5.
#[test]
fn the_load_is_the_penalty_of_each_pair_on_the_ancestor() {
    let tree = block();
    let model = skeleton(&tree);
    let mut ready = ReadySkeleton::new(&model, &tree, 7, TICK_S);
    let (tool, loads) = (rod(), [Wrench::ZERO]);
    let free_node = tree
        .shape_at(2)
        .find(|(id, n)| !model.fixed.contains(id) && n.centre.z > -6e-4)
        .expect("one");
    let at = free_node.1.centre;
    let (graphic, haptic) = (
        over(Vec3::new(at.x, at.y, 9e-4)),
        over(Vec3::new(at.x + 1e-4, at.y, -4e-4)),
    );
    let dp = Vec3::new(1e-4, 0.0, -1.3e-3);
    // Number of pairs per ancestor, by brute force.
    let ids: Vec<u32> = tree.shape_at(2).map(|(id, _)| id).collect();
    let mut pairs = vec![0.0; ids.len()];
    for (o, node) in tree.shape_at(7) {
        let mut above = o;
        while !ids.contains(&above) {
            above = (0..above)
                .find(|&k| {
                    let parent = &tree.nodes()[k as usize];
                    parent.children > 0
                        && (parent.first_child..parent.first_child + u32::from(parent.children))
                            .contains(&above)
                })
                .expect("a parent");
        }
        for (_, sphere) in tool.tree.shape_at(tool.level) {
            let gap = norm(&(graphic.transform(&sphere.centre) - node.centre))
                - node.contact_radius
                - sphere.contact_radius;
            if gap < model.contact_distance_m {
                pairs[ids.binary_search(&above).expect("a mover")] += 1.0;
            }
        }
    }
    assert!(pairs.iter().filter(|n| **n > 0.0).count() >= 2, "{pairs:?}");
    let n = 3 * ids.len();
    let mut state = vec![0.0; 2 * n];
    let (mut shape, mut free) = (vec![0.0; 2 * n + 1], vec![0.0; 2 * n + 1]);
    let now = hands(&tool, haptic, graphic, &loads);
    assert!(!ready.free_step(&state, &now, &mut shape, &mut free));
    assert_eq!(shape, free);
    let held = |at: usize| model.fixed.contains(&ids[at]);
    for (at, count) in pairs.iter().enumerate() {
        for axis in 0..3 {
            let force = model.penalty_n_per_m * count * dp[axis];
            let v = if held(at) {
                0.0
            } else {
                TICK_S / model.mass_kg * force
            };
            assert!((shape[n + 3 * at + axis] - v).abs() < 1e-15 + 1e-9 * v.abs());
            assert_eq!(shape[3 * at + axis], 0.0, "the place follows a step later");
        }
    }
    // Nodes above the skeleton keep their centre; nodes below shift with their ancestor.
    ready.commit(&shape, Some(&[]), &now, &mut state);
    ready.free_step(&state, &now, &mut shape, &mut free);
    let all: Vec<u32> = (0..tree.nodes().len() as u32).collect();
    let mut centres = vec![Vec3::zeros(); all.len()];
    ready.centres(&shape, &all, &mut centres);
    let mut moved = 0;
    for (id, node) in tree.nodes().iter().enumerate() {
        let shift = centres[id] - node.centre;
        if node.level < 2 && node.children > 0 {
            assert_eq!(shift, Vec3::zeros());
        }
        if node.level >= 2 {
            for child in node.first_child..node.first_child + u32::from(node.children) {
                let below = centres[child as usize] - tree.nodes()[child as usize].centre;
                assert!(norm(&(below - shift)) < 1e-15);
                moved += usize::from(norm(&shift) > 0.0);
            }
        }
    }
    assert!(moved > 4, "{moved}");
    // With the haptic tool out of contact, no load acts, although the graphic tool is near.
    let away = hands(&tool, over(Vec3::new(at.x, at.y, 2e-3)), graphic, &loads);
    assert!(ready.free_step(&vec![0.0; 2 * n], &away, &mut shape, &mut free));
    assert!(shape.iter().all(|x| *x == 0.0));
}

/// Checks that a named carrier replaces the ancestor in load and shift.
#[test]
fn a_named_carrier_bears_and_leads() {
    let tree = block();
    let mut model = skeleton(&tree);
    let ids: Vec<u32> = tree.shape_at(2).map(|(id, _)| id).collect();
    let free = ids
        .iter()
        .position(|id| !model.fixed.contains(id))
        .expect("one");
    model.carriers = vec![ids[free]; tree.nodes().len()];
    model.validate(&tree, TICK_S).expect("fits");
    let mut ready = ReadySkeleton::new(&model, &tree, 7, TICK_S);
    let (tool, loads, n) = (rod(), [Wrench::ZERO], 3 * ids.len());
    let graphic = over(Vec3::new(1.5e-3, 2e-4, 9e-4));
    let haptic = over(Vec3::new(1.5e-3, 2e-4, -4e-4));
    let (mut shape, mut free_shape) = (vec![0.0; 2 * n + 1], vec![0.0; 2 * n + 1]);
    let mut state = vec![0.0; 2 * n];
    let now = hands(&tool, haptic, graphic, &loads);
    for _ in 0..2 {
        ready.free_step(&state, &now, &mut shape, &mut free_shape);
        ready.commit(&shape, Some(&[]), &now, &mut state);
    }
    let leaves: Vec<u32> = tree
        .shape_at(7)
        .map(|(id, _)| id)
        .filter(|id| !ids.contains(id))
        .collect();
    let mut centres = vec![Vec3::zeros(); leaves.len()];
    ready.centres(&shape, &leaves, &mut centres);
    for (id, centre) in leaves.iter().zip(centres) {
        let shift = centre.z - tree.nodes()[*id as usize].centre.z;
        assert!(
            shift < 0.0 && (shift - state[3 * free + 2]).abs() < 1e-15,
            "{id}: {shift}"
        );
    }
    // The carrier has the largest downward velocity of all spheres.
    let moving = (0..ids.len()).filter(|k| state[n + 3 * k + 2] < 0.0);
    assert!(moving.clone().count() >= 1 && moving.clone().any(|k| k == free));
    let fastest = moving.fold(free, |best, k| {
        if state[n + 3 * k + 2] < state[n + 3 * best + 2] {
            k
        } else {
            best
        }
    });
    assert_eq!(fastest, free);
}

/// Pose of tick `k` in a periodic motion that presses the rod into the block and withdraws the rod.
fn press(k: u32) -> Pose {
    let t = f64::from(k) * 1e-3;
    let deep = math::fclamp(libm::sin(2.5 * t), -0.2, 1.0);
    over(Vec3::new(1.5e-3, 2e-4, 1.2e-3 - 3e-3 * deep))
}

#[test]
fn a_stable_skeleton_gives_way_and_comes_back_to_exact_rest() {
    let tree = block();
    let mut model = skeleton(&tree);
    // A sphere has several pairs, so the penalty is low enough for a wide margin to the stability limit.
    (model.spring_n_per_m, model.penalty_n_per_m) = (80.0, 2.0);
    let scene = scene(tree, TissueModel::PrintedSkeleton(model));
    scene.validate().expect("stable");
    let (mut state, mut ws) = (State::new(&scene), Workspace::new(&scene));
    let (mut deepest, mut faults) = (0.0, 0);
    for k in 0..1200 {
        let out = tick(&scene, &mut state, &mut ws, &input(&press(k)), &mut NoProbe);
        deepest = state
            .tissue
            .iter()
            .fold(deepest, |most, x| math::fmax(most, x.abs()));
        faults += u32::from(out.tools[0].status & status::FAULT != 0);
        // A fresh workspace must give the same tick: cached data must not affect the result.
        if k % 97 == 0 {
            let bytes = state.to_bytes();
            let (mut other, mut fresh) = (
                State::from_bytes(&scene, &bytes).expect("its own"),
                Workspace::new(&scene),
            );
            let next = input(&press(k + 1));
            let (mut same, mut kept) = (state.clone(), ws);
            let a = tick(&scene, &mut same, &mut kept, &next, &mut NoProbe);
            let b = tick(&scene, &mut other, &mut fresh, &next, &mut NoProbe);
            assert_eq!((a, same), (b, other), "tick {k}");
            ws = Workspace::new(&scene);
        }
    }
    assert!(deepest > 1e-4, "{deepest}");
    assert_eq!(faults, 0);
    for k in 0..20_000 {
        tick(
            &scene,
            &mut state,
            &mut ws,
            &input(&over(Vec3::new(0.0, 0.0, 0.02))),
            &mut NoProbe,
        );
        if state.tissue.iter().all(|x| *x == 0.0) {
            return assert!(k > 10, "{k}");
        }
    }
    panic!("not at rest after 20 s");
}

#[test]
fn what_diverges_goes_back_to_rest_and_is_said() {
    let tree = block();
    let mut model = skeleton(&tree);
    model.spring_n_per_m = 1e5;
    let scene = scene(tree, TissueModel::PrintedSkeleton(model));
    assert!(scene.validate().is_err());
    // The scene runs without validation.
    let (mut state, mut ws) = (State::new(&scene), Workspace::new(&scene));
    let mut faults = 0;
    for k in 0..2000 {
        let out = tick(&scene, &mut state, &mut ws, &input(&press(k)), &mut NoProbe);
        assert!(state.tissue.iter().all(|x| x.is_finite()));
        assert!(out.tools[0].wrench.force.iter().all(|x| x.is_finite()));
        faults += u32::from(out.tools[0].status & status::FAULT != 0);
    }
    assert!(faults > 0);
}

/// Checks that a tissue without penalty load behaves as the same shape, rigid.
///
/// The optimisation treats the deformed tissue as rigid (section 7).
#[test]
fn against_a_tissue_that_never_moves_the_tick_is_the_rigid_one() {
    let tree = block();
    let mut model = skeleton(&tree);
    model.penalty_n_per_m = 0.0;
    let printed = scene(tree.clone(), TissueModel::PrintedSkeleton(model));
    let rigid = scene(tree, TissueModel::Rigid);
    let (mut a, mut b) = (State::new(&printed), State::new(&rigid));
    let (mut wa, mut wb) = (Workspace::new(&printed), Workspace::new(&rigid));
    let mut contact = 0;
    for k in 0..800 {
        let now = input(&press(k));
        let x = tick(&printed, &mut a, &mut wa, &now, &mut NoProbe).tools[0];
        let y = tick(&rigid, &mut b, &mut wb, &now, &mut NoProbe).tools[0];
        assert!(
            norm(&(x.graphic.position - y.graphic.position)) < 1e-9,
            "tick {k}"
        );
        assert!(
            norm(&(x.raw_wrench.force - y.raw_wrench.force)) < 1e-5,
            "tick {k}"
        );
        contact += u32::from(y.active > 0);
    }
    assert!(contact > 300, "{contact}");
}
