//! The soft block: 60 x 40 x 20 mm, 100 kPa, held below and at one end, pressed and stroked by a capsule of 3 mm.

use std::f64::consts::PI;
use std::path::Path;
use std::rc::Rc;

use rapier3d::prelude::{
    ColliderBuilder, SoftBodyBuilder, SoftBodyCellModel, SoftBodyMaterial, SoftBodySolver, Vector,
};
use sulcus_core::tissue::TissueModel;
use sulcus_core::{DisplayMesh, Object, Params, Pose, Quat, Scene as Compiled, Vec3};
use sulcus_scene::cache::{default_cache_dir, kept_or_built};
use sulcus_scene::mesh::TriMesh;
use sulcus_scene::organ::{SurfaceOptions, organ};
use sulcus_scene::tree::build::TreeOptions;

use crate::TICK_S;
use crate::capsule::Capsule;
use crate::engine::{Engine, Entrant};
use crate::ours::{Ours, Skin};
use crate::rapier::{Carried, Rapier, mm, smooth};
use crate::scene::Scene;

/// Edges of the block, metres. It begins at the origin.
pub const EDGES: [f64; 3] = [60e-3, 40e-3, 20e-3];
/// Young's modulus, Pa.
pub const YOUNG: f64 = 100e3;
/// Poisson's ratio.
pub const POISSON: f64 = 0.45;
/// Mass, kg: for the engine that has one.
const MASS: f64 = 0.05;
/// How deep the hand's capsule goes at most, metres.
pub const PRESS: f64 = 6e-3;
/// Edge of the squares of its surface mesh, metres.
const MESH: f64 = 2e-3;
/// Distance of the surface points that are looked at, metres.
const POINTS: f64 = 1e-3;
/// What the other engine is told is one unit of length, mm. Of 1, 10, 100 and 1000 the one with which its soft body is fastest
/// and keeps the tool out (with 1 it lets the tool through, with 1000 its finite elements take half as long again).
const LENGTH_UNIT: f32 = 10.0;
/// Particles of the other body along each edge.
const PARTICLES: usize = 4;

/// The tool. Its turn is the hand's: 0.5 mm between spheres are 10 um less than a capsule.
pub const CAPSULE: Capsule = Capsule {
    radius: 3e-3,
    spacing: 0.5e-3,
    turning: None,
};

/// Whether a place is held.
pub fn held(place: &Vec3) -> bool {
    place.x < 1e-6 || place.z < 1e-6
}

/// Where the hand's capsule is when it is `depth` into the block at rest.
pub fn pressing(x: f64, y: f64, depth: f64) -> Pose {
    let z = EDGES[2] + CAPSULE.radius - depth;
    Pose::new(Vec3::new(x, y, z), Quat::identity())
}

/// Presses to 6 mm every two seconds, from 4.5 mm above (out of reach of any skin), on a way to and fro across the block.
fn hand(k: usize) -> Pose {
    let t = k as f64 * TICK_S;
    let above = 4.5e-3;
    let depth = 0.5 * (PRESS + above) * (1.0 - libm::cos(PI * t)) - above;
    let x = 32e-3 + 12e-3 * libm::sin(2.0 * PI * 0.23 * t);
    let y = 20e-3 + 5e-3 * libm::sin(2.0 * PI * 0.13 * t);
    pressing(x, y, depth)
}

/// The scene for so many ticks.
pub fn scene(ticks: usize) -> Scene {
    let path: Vec<Pose> = (0..ticks).map(hand).collect();
    let top = EDGES[2] + CAPSULE.radius;
    let depth = |pose: &Pose, points: &[Vec3]| {
        let depths = points.iter().map(|point| CAPSULE.depth_of(pose, point));
        depths.fold(f64::NEG_INFINITY, f64::max)
    };
    Scene {
        name: "soft block",
        touches: path.iter().map(|pose| pose.position.z < top).collect(),
        path,
        depth: Box::new(depth),
        every: 5,
        entrants: entrants(),
    }
}

fn entrants() -> Vec<Entrant> {
    let mut all = Vec::new();
    for level in [3, 4] {
        let compiled = Rc::new(ours(level));
        let skin = Rc::new(Skin::new(&compiled, &points()));
        let spheres = compiled.objects[0].tree.shape_at(level).count();
        all.push(Entrant {
            name: format!("sulcus surface_compliance, level {level}"),
            note: format!("{spheres} spheres, 128 masters; penetration is of the drawn skin, residual of the spheres that touch"),
            make: Box::new(move || Box::new(Ours::new(&compiled, &skin))),
        });
    }
    for (solver, name) in [
        (SoftBodySolver::Constraints, "constraints"),
        (SoftBodySolver::Fem, "fem"),
    ] {
        for skin in [true, false] {
            let (kept, note) = if skin {
                (
                    "as it comes",
                    "its contact skin, half a cell, holds the tool 3.3 mm off what is drawn",
                )
            } else {
                (
                    "no skin",
                    "contact skin set to 0, so that it touches where it is drawn",
                )
            };
            all.push(Entrant {
                name: format!("rapier3d soft body, 64 particles, {name}, {kept}"),
                note: note.to_owned(),
                make: Box::new(move || Box::new(theirs(solver, skin))),
            });
        }
    }
    all
}

/// The points of the top that are looked at, at rest.
pub fn points() -> Vec<Vec3> {
    let count = |edge: f64| (edge / POINTS).round() as usize;
    let (nx, ny) = (count(EDGES[0]), count(EDGES[1]));
    let at = |i: usize, j: usize| Vec3::new(i as f64 * POINTS, j as f64 * POINTS, EDGES[2]);
    (0..=nx)
        .flat_map(|i| (0..=ny).map(move |j| at(i, j)))
        .collect()
}

/// The block's surface in squares, two triangles each.
pub fn surface() -> TriMesh {
    let mut mesh = TriMesh::default();
    let mut known = std::collections::BTreeMap::new();
    let cells = EDGES.map(|edge| (edge / MESH).round() as usize);
    for (axis, far) in [0, 1, 2]
        .into_iter()
        .flat_map(|axis| [(axis, false), (axis, true)])
    {
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        for (i, j) in (0..cells[u]).flat_map(|i| (0..cells[v]).map(move |j| (i, j))) {
            let mut vertex = |i: usize, j: usize| {
                let mut at = [0; 3];
                (at[axis], at[u], at[v]) = (if far { cells[axis] } else { 0 }, i, j);
                *known.entry(at).or_insert_with(|| {
                    mesh.vertices.push(Vec3::from(at.map(|k| k as f64 * MESH)));
                    mesh.vertices.len() as u32 - 1
                })
            };
            let [a, b, c, d] =
                [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)].map(|(i, j)| vertex(i, j));
            let two = if far {
                [[a, b, c], [a, c, d]]
            } else {
                [[a, c, b], [a, d, c]]
            };
            mesh.triangles.extend(two);
        }
    }
    mesh
}

/// Ours: finite elements of 5 mm, condensed to their surface.
fn ours(level: u8) -> Compiled {
    let (mesh, kept) = (surface(), default_cache_dir());
    let wanted = TreeOptions {
        levels: level,
        volumetric: true,
        ..TreeOptions::default()
    };
    let tree = kept_or_built(&mesh, &wanted, kept.as_deref(), &|_, _| ()).expect("a tree of a box");
    let options = SurfaceOptions {
        young_kpa: YOUNG * 1e-3,
        poisson: POISSON,
        fixed_root: 1e-4,
        fixed_bottom: 1e-4,
        // All of the bottom is held, up to its far edge.
        free_tip: -1.0,
        ..SurfaceOptions::default()
    };
    let made = organ(
        &tree,
        &mesh,
        &options,
        Path::new(""),
        kept.as_deref(),
        &|_, _| (),
    );
    let block = Object {
        name: "block".into(),
        fdi: 0,
        tree,
        level,
        tissue: TissueModel::Surface(Box::new(made.expect("elements of a box"))),
        mesh: DisplayMesh::default(),
        carriers: Vec::new(),
    };
    let scene = Compiled {
        name: "block".into(),
        source_hash: String::new(),
        params: Params::default(),
        tools: vec![CAPSULE.tool(hand(0))],
        objects: vec![block],
    };
    scene.validate().expect("the block is a scene");
    scene
}

/// Theirs: 4 x 4 x 4 particles.
fn theirs(solver: SoftBodySolver, skin: bool) -> Rapier {
    let mut engine = Rapier::new(&CAPSULE, &hand(0), 4, LENGTH_UNIT);
    let half = Vec3::from(EDGES) * 0.5;
    let n = PARTICLES;
    let builder = SoftBodyBuilder::cuboid(mm(&half), mm(&half), n, n, n)
        .cell_model(SoftBodyCellModel::Corotational)
        .material(SoftBodyMaterial {
            // In kilograms, millimetres and seconds.
            young_modulus: (YOUNG * 1e-3) as f32,
            poisson_ratio: POISSON as f32,
            ..SoftBodyMaterial::default()
        })
        .solver(solver)
        .mass(MASS as f32)
        .surface_collider(smooth(ColliderBuilder::ball(1.0)))
        .can_sleep(false);
    let at: Vec<Vec3> = builder.particle_positions().iter().map(in_metres).collect();
    let pinned = (0..at.len()).filter(|k| held(&at[*k])).map(|k| k as u32);
    let builder = builder.pinned_particles(pinned);
    let handle = engine.world.insert_soft_body(builder);
    let body = &engine.world.soft_bodies[handle];
    engine.soft = Some((handle, carried(&at, body.boundary())));
    if !skin {
        let root = body.root_body();
        for (_, collider) in engine.world.colliders.iter_mut() {
            if collider.parent() == Some(root) {
                collider.set_contact_skin(0.0);
            }
        }
    }
    engine
}

fn in_metres(v: &Vector) -> Vec3 {
    Vec3::new(f64::from(v.x), f64::from(v.y), f64::from(v.z)) * 1e-3
}

/// Where each of [`points`] is on the triangles between these particles.
fn carried(at: &[Vec3], triangles: &[[u32; 3]]) -> Vec<Carried> {
    let on_top =
        |triangle: &&[u32; 3]| triangle.iter().all(|k| at[*k as usize].z > EDGES[2] - 1e-6);
    let top: Vec<[usize; 3]> = triangles
        .iter()
        .filter(on_top)
        .map(|t| t.map(|k| k as usize))
        .collect();
    let shares = |triangle: &[usize; 3], p: &Vec3| {
        let [a, b, c] = triangle.map(|k| at[k]);
        let area = |a: &Vec3, b: &Vec3, c: &Vec3| (b - a).cross(&(c - a)).z;
        let all = area(&a, &b, &c);
        [
            area(p, &b, &c) / all,
            area(&a, p, &c) / all,
            area(&a, &b, p) / all,
        ]
    };
    let of = |p: &Vec3| {
        let all = top.iter().map(|triangle| (*triangle, shares(triangle, p)));
        let inner = |s: &[f64; 3]| s.iter().copied().fold(f64::INFINITY, f64::min);
        all.max_by(|a, b| inner(&a.1).total_cmp(&inner(&b.1)))
            .expect("the top has triangles")
    };
    points().iter().map(of).collect()
}

/// Force with which each entrant holds the hand's capsule 6 mm deep in the middle after a second, newtons.
pub fn held_forces(scene: &Scene) -> Vec<f64> {
    let force = |entrant: &Entrant| {
        let mut engine: Box<dyn Engine> = (entrant.make)();
        let mut shown = 0.0;
        for k in 0..2000 {
            let share = (f64::from(k) * TICK_S).min(1.0);
            let start = hand(0).position;
            let place = start + (pressing(32e-3, 20e-3, PRESS).position - start) * share;
            let now = crate::scene::ticked(engine.as_mut(), &Pose::new(place, Quat::identity()));
            shown = now.force.z;
        }
        shown
    };
    scene.entrants.iter().map(force).collect()
}
