//! Contacts with caches equal those of every leaf against every leaf.

use proptest::prelude::*;

use super::*;
use crate::math::{Quat, exp_rotation};
use crate::tissue::{TissueModel, tests::Winkler};
use crate::tree::{Node, Sphere, SphereTree};
use crate::{DisplayMesh, Object, Params, Scene, Tool};

/// Pseudo-random numbers in [0, 1), the same on every platform.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }
    fn vector(&mut self, size: f64) -> Vec3 {
        let mut one = || (2.0 * self.next() - 1.0) * size;
        Vec3::new(one(), one(), one())
    }
}

/// Returns a tree of balls on a bumpy ellipsoid: inner nodes with tight shapes as in a fitted tree, and ragged leaves.
fn bumpy(count: usize, semi_axes: Vec3, centre: Vec3, random: &mut Random) -> SphereTree {
    let balls: Vec<Sphere> = (0..count)
        .map(|_| {
            let direction = random.vector(1.0) + Vec3::new(1e-3, 0.0, 0.0);
            let direction = direction / crate::math::norm(&direction);
            let radius = 2e-4 + 8e-4 * random.next();
            let on = semi_axes.component_mul(&direction);
            Sphere {
                centre: centre + on - direction * radius,
                radius,
            }
        })
        .collect();
    let mut nodes = SphereTree::over_leaves(&balls)
        .expect("valid")
        .nodes()
        .to_vec();
    for node in &mut nodes {
        if node.children > 0 {
            node.contact_radius *= 0.7;
        }
    }
    SphereTree::with_bounds(nodes).expect("valid")
}

fn object(tree: SphereTree, tissue: TissueModel) -> Object {
    Object {
        name: "object".into(),
        fdi: 0,
        tree,
        level: 7,
        tissue,
        mesh: DisplayMesh::default(),
        carriers: Vec::new(),
    }
}

fn tool(tree: SphereTree) -> Tool {
    Tool {
        name: "tool".into(),
        tree,
        level: 7,
        working_point: Vec3::new(0.0, 0.0, -0.02),
        tip: Vec3::new(0.0, 0.0, -0.024),
        tip_axis: -Vec3::z(),
        stiffness_n_per_m: 500.0,
        stiffness_nm_per_rad: 0.5,
        park: Pose::new(Vec3::new(0.0, 0.0, 0.1), Quat::identity()),
        bands: vec![],
        mesh: DisplayMesh::default(),
    }
}

/// Returns a scene with two rods, three rigid objects and one yielding object.
fn scene(seed: u64) -> Scene {
    let random = &mut Random(seed);
    let rod = |count, random: &mut Random| {
        bumpy(
            count,
            Vec3::new(5e-4, 5e-4, 8e-3),
            Vec3::new(0.0, 0.0, -0.016),
            random,
        )
    };
    let semi_axes = Vec3::new(4e-3, 6e-3, 5e-3);
    let mut objects: Vec<Object> = [(700, -5e-3), (90, 4e-3), (1, 9e-3)]
        .map(|(count, x)| {
            let centre = Vec3::new(x, 0.0, -5e-3);
            object(bumpy(count, semi_axes, centre, random), TissueModel::Rigid)
        })
        .into();
    let yielding = TissueModel::Winkler(Winkler {
        compliance: Mat3::identity() * 1e-3,
    });
    let below = Vec3::new(0.0, 5e-3, -6e-3);
    objects.push(object(bumpy(40, semi_axes, below, random), yielding));
    Scene {
        name: "walk".into(),
        source_hash: String::new(),
        params: Params::default(),
        tools: vec![tool(rod(120, random)), tool(rod(9, random))],
        objects,
    }
}

/// Returns every number of every contact as bits, in order.
fn bits(list: &ContactList) -> Vec<[u64; 11]> {
    let of = |c: &Contact| {
        let mut all = [0; 11];
        (all[0], all[1]) = (u64::from(c.tool), u64::from(c.object));
        (all[2], all[3]) = (u64::from(c.object_sphere), u64::from(c.tool_sphere));
        let numbers = c.normal.iter().chain(c.arm.iter()).chain([&c.gap]);
        for (bits, number) in all[4..].iter_mut().zip(numbers) {
            *bits = number.to_bits();
        }
        all
    };
    list.as_slice().iter().map(of).collect()
}

struct Query {
    poses: [Pose; 2],
    /// Levels of the tools and of the objects.
    levels: (u8, u8),
    /// Prediction distance per object.
    d: [Distance; 4],
    limit: usize,
    overflow: Overflow,
}

/// Queries all tools against all objects. Returns whether the list had room for all contacts.
fn ask(scene: &Scene, query: &Query, predictor: &mut Predictor, out: &mut ContactList) -> bool {
    out.begin(query.limit, query.overflow);
    let mut fits = true;
    for (slot, tool) in scene.tools.iter().enumerate() {
        let posed = PosedTool {
            nodes: tool.tree.nodes(),
            pose: &query.poses[slot],
            level: query.levels.0,
            working_point: &tool.working_point,
            slot: slot as u8,
        };
        predictor.begin(&posed);
        for (k, object) in scene.objects.iter().enumerate() {
            let object = (k as u16, object.tree.nodes(), query.levels.1);
            fits &= predictor.predict(&posed, object, query.d[k], out).is_ok();
        }
    }
    out.sort();
    fits
}

/// Lists the contacts of every shape sphere of the tools with every shape sphere of the objects.
fn brute_force(scene: &Scene, query: &Query, out: &mut ContactList) {
    out.begin(query.limit, query.overflow);
    for (slot, tool) in scene.tools.iter().enumerate() {
        let pose = &query.poses[slot];
        let rotation = pose.orientation.to_rotation_matrix().into_inner();
        let working_point = centre(&rotation, pose, &tool.working_point);
        for (t, node) in tool.tree.shape_at(query.levels.0) {
            let at = centre(&rotation, pose, &node.centre);
            let lever = crate::math::norm(&(node.centre - tool.working_point));
            for (k, object) in scene.objects.iter().enumerate() {
                for (o, other) in object.tree.shape_at(query.levels.1) {
                    let between = at - other.centre;
                    let reach = node.contact_radius + other.contact_radius;
                    let (squared, most) = (between.dot(&between), reach + query.d[k].at(lever));
                    if squared < most * most {
                        let distance = squared.sqrt();
                        out.push(Contact {
                            tool: slot as u8,
                            object: k as u16,
                            object_sphere: o,
                            tool_sphere: t,
                            normal: between / distance,
                            gap: distance - reach,
                            arm: at - working_point,
                        })
                        .expect("room for all");
                    }
                }
            }
        }
    }
    out.sort();
}

fn stepped(pose: &mut Pose, size: f64, random: &mut Random) {
    pose.position += random.vector(size);
    let turn = exp_rotation(&random.vector(20.0 * size));
    pose.orientation = crate::tick::haptic::renormalised(&(turn * pose.orientation));
}

#[test]
fn a_long_walk_finds_the_contacts_of_brute_force_to_the_last_bit() {
    let most = 400_000;
    let (mut kept, mut plain, mut every) = (
        ContactList::with_capacity(most),
        ContactList::with_capacity(most),
        ContactList::with_capacity(most),
    );
    let (mut found, mut empty, mut made, mut queries) = (0, 0, 0, 0);
    for seed in 1..=6 {
        let scene = scene(seed);
        let random = &mut Random(seed * 77);
        let (mut predictor, mut reference) = (Predictor::new(&scene), Predictor::plain(&scene));
        let above = Pose::new(Vec3::new(-2e-4, 0.0, 0.021), Quat::identity());
        let mut query = Query {
            poses: [above; 2],
            levels: (7, 7),
            d: [1e-4.into(); 4],
            limit: most,
            overflow: Overflow::Stop,
        };
        for step in 0..250 {
            let size = [0.0, 1e-6, 1e-5, 3e-5, 1e-4][step / 7 % 5];
            for pose in &mut query.poses {
                stepped(pose, size, random);
                if random.next() < 0.04 {
                    *pose = above;
                    stepped(pose, 2e-3, random);
                }
            }
            if step % 9 == 0 {
                let mut pick = || (random.next() * 4.0) as usize;
                query.d = std::array::from_fn(|_| Distance {
                    base: [1e-6, 5e-5, 1e-4, 5e-4][pick()],
                    turn: [0.0, 0.0, 2e-3, 2e-2][pick()],
                });
            }
            if step % 31 == 30 {
                let level = |random: &mut Random| (random.next() * 6.0) as u8;
                query.levels = (level(random), level(random));
            }
            if step % 62 == 61 {
                query.levels = (7, 7);
            }
            ask(&scene, &query, &mut predictor, &mut kept);
            ask(&scene, &query, &mut reference, &mut plain);
            brute_force(&scene, &query, &mut every);
            assert_eq!(bits(&kept), bits(&plain), "seed {seed}, step {step}");
            assert_eq!(bits(&kept), bits(&every), "seed {seed}, step {step}");
            found += usize::from(!kept.as_slice().is_empty());
            empty += usize::from(kept.as_slice().is_empty());
        }
        let work = predictor.work();
        made += work.lists;
        queries += work.queries;
        assert_eq!(reference.work().lists, 0);
    }
    assert!(
        found > 800 && empty > 20,
        "{found} with contacts, {empty} without"
    );
    // Three of four objects are rigid: without reuse of lists, 3/4 of the queries would build one.
    assert!(made * 2 < queries, "{made} lists in {queries} queries");
}

#[test]
fn a_full_list_says_so_at_the_same_query_and_keeps_the_same_contacts() {
    let scene = scene(3);
    let random = &mut Random(5);
    let (mut predictor, mut reference) = (Predictor::new(&scene), Predictor::plain(&scene));
    let (mut kept, mut plain) = (
        ContactList::with_capacity(64),
        ContactList::with_capacity(64),
    );
    let above = Pose::new(Vec3::new(-2e-3, 0.0, 0.0225), Quat::identity());
    let mut full = 0;
    for step in 0..300 {
        let mut query = Query {
            poses: [above; 2],
            levels: (7, 7),
            d: [2e-4.into(); 4],
            limit: 1 + step % 64,
            overflow: Overflow::Stop,
        };
        query
            .poses
            .iter_mut()
            .for_each(|pose| stepped(pose, 2e-4, random));
        let fits = ask(&scene, &query, &mut predictor, &mut kept);
        assert_eq!(
            fits,
            ask(&scene, &query, &mut reference, &mut plain),
            "step {step}"
        );
        full += u32::from(!fits);
        query.overflow = Overflow::KeepSmallestGaps;
        assert!(ask(&scene, &query, &mut predictor, &mut kept));
        ask(&scene, &query, &mut reference, &mut plain);
        assert_eq!(bits(&kept), bits(&plain), "step {step}");
    }
    assert!(full > 50 && full < 300, "{full} of 300 were full");
}

#[test]
fn a_list_without_room_is_answered_by_the_traversal() {
    // 2,700 spheres at nearly the same place against a rod of 120 spheres: more pairs than a list holds.
    let mut scene = scene(2);
    let heap: Vec<Sphere> = (0..2700)
        .map(|k| Sphere {
            centre: Vec3::new(1e-6 * f64::from(k), 0.0, 0.0),
            radius: 3e-3,
        })
        .collect();
    scene.objects.truncate(1);
    scene.objects[0].tree = SphereTree::over_leaves(&heap).expect("valid");
    let mut out = ContactList::with_capacity(400_000);
    let mut every = ContactList::with_capacity(400_000);
    let mut predictor = Predictor::new(&scene);
    let query = Query {
        poses: [Pose::new(Vec3::new(0.0, 0.0, 0.02), Quat::identity()); 2],
        levels: (7, 7),
        d: [1e-4.into(); 4],
        limit: 400_000,
        overflow: Overflow::Stop,
    };
    for _ in 0..2 {
        assert!(ask(&scene, &query, &mut predictor, &mut out));
        brute_force(&scene, &query, &mut every);
        assert_eq!(bits(&out), bits(&every));
    }
    assert!(predictor.work().unlisted > 0);
    assert!(out.as_slice().len() > 10_000);
}

proptest! {
    #[test]
    fn the_filter_lets_every_near_ball_through(
        balls in proptest::collection::vec((-0.05..0.05f64, -0.05..0.05f64, -0.05..0.05f64, 1e-6..0.02f64), 1..=8),
        away in (-1.0..1.0f64, -1.0..1.0f64, -1.0..1.0f64), shift in -10.0..10.0f64, d in 0.0..1e-3f64,
        hair in -1e-13..1e-15f64,
    ) {
        // A point at the reach of the first ball, within rounding.
        let shift = Vec3::new(shift, -shift, 0.5 * shift);
        let nodes: Vec<Node> = balls.iter().map(|&(x, y, z, r)| Node {
            centre: shift + Vec3::new(x, y, z), contact_radius: r, bound_radius: r, first_child: 0, children: 0, level: 1,
        }).collect();
        let direction = Vec3::new(away.0, away.1, away.2 + 1e-6).normalize();
        let reach = nodes[0].contact_radius + d;
        let point = nodes[0].centre + direction * (reach + hair);
        let mut all = vec![Node { children: nodes.len() as u8, first_child: 1, level: 0, bound_radius: 20.0, ..nodes[0] }];
        all.extend(&nodes);
        let packs = packs::Packs::new(&all);
        let near = packs.shapes[1].within(packs::Felt::new(&(point - packs.origin), d));
        for (lane, node) in nodes.iter().enumerate() {
            let between = point - node.centre;
            let reach = node.contact_radius + d;
            if between.dot(&between) < reach * reach {
                prop_assert!(near >> lane & 1 == 1, "lane {}", lane);
            }
        }
    }
}
