//! The rigid tooth: the parametric lower first molar, and a capsule of 0.5 mm whose hand goes round the crown and up to
//! about 1.5 mm into it.

use std::f64::consts::PI;
use std::path::Path;
use std::rc::Rc;

use rapier3d::prelude::{ColliderBuilder, RigidBodyBuilder, TriMeshFlags};
use sulcus_core::{Pose, Quat, Scene as Compiled, Vec3};
use sulcus_scene::anatomy::Tooth;
use sulcus_scene::error::level_error;
use sulcus_scene::mesh::distance::MeshDistance;
use sulcus_scene::{BuildOptions, compile_text};

use crate::TICK_S;
use crate::capsule::{Capsule, HALF};
use crate::engine::Entrant;
use crate::ours::{Ours, Skin};
use crate::parry::{self, Parry};
use crate::rapier::{Rapier, mm, smooth};
use crate::scene::Scene;

/// FDI number.
const FDI: u8 = 36;
/// The tool: 0.25 mm between spheres are 16 um less than a capsule.
const CAPSULE: Capsule = Capsule {
    radius: 0.5e-3,
    spacing: 0.25e-3,
    turning: Some(0.05),
};
/// Depths of the hand's tip, metres: it goes from the least to the most and back.
const DEPTHS: [f64; 2] = [-1.0e-3, 1.5e-3];
/// What the other engine is told is one unit of length, mm. Of 0.1, 1, 10, 100 and 1000 the one with which it is fastest at p50
/// and p99.9 together and does not stop short of the tooth.
const LENGTH_UNIT: f32 = 1.0;
/// Point that the way goes round, metres: in the middle of the crown.
const MIDDLE: Vec3 = Vec3::new(0.0, 0.0, 3.5e-3);
/// Where the search for the surface begins, metres from there, and its step.
const OUTSIDE: f64 = 12e-3;
const STEP: f64 = 0.05e-3;
/// Ticks over which its distance is smoothed, twice.
const SMOOTH: usize = 61;

/// Direction of the ray at a tick, and the flat one below it.
fn ray(k: i32) -> (Vec3, Vec3) {
    let t = f64::from(k) * TICK_S;
    let (around, up) = (
        2.0 * PI * t / 10.0,
        0.7 + 0.5 * libm::sin(2.0 * PI * t / 3.7),
    );
    let flat = Vec3::new(libm::cos(around), libm::sin(around), 0.0);
    (flat * libm::cos(up) + Vec3::z() * libm::sin(up), flat)
}

/// How far from the middle of the crown the tip is at the asked depth, along the ray, from outside.
fn reach(tooth: &MeshDistance, k: i32) -> f64 {
    let (out, _) = ray(k);
    let wave = 0.5 * (1.0 - libm::cos(2.0 * PI * f64::from(k) * TICK_S / 1.3));
    let wanted = CAPSULE.radius - (DEPTHS[0] + (DEPTHS[1] - DEPTHS[0]) * wave);
    let at = |s: f64| tooth.signed(&(MIDDLE + out * s));
    let mut far = OUTSIDE;
    while far > STEP && at(far - STEP) > wanted {
        far -= STEP;
    }
    let mut near = far - STEP;
    for _ in 0..30 {
        let middle = 0.5 * (near + far);
        if at(middle) > wanted {
            far = middle;
        } else {
            near = middle;
        }
    }
    far
}

/// The means of so many neighbours each, of which half are lost at either end.
fn smooth_over(all: &[f64], width: usize) -> Vec<f64> {
    let mean = |some: &[f64]| some.iter().sum::<f64>() / width as f64;
    all.windows(width).map(mean).collect()
}

/// Where the hand is: its tip about as deep as asked on a ray from the middle of the crown, its shaft outward and swaying. (A
/// ray that leaves a cusp jumps to what is behind it; a hand does not.)
fn hands(tooth: &MeshDistance, ticks: usize) -> Vec<Pose> {
    let beyond = SMOOTH as i32 - 1;
    let reaches: Vec<f64> = (-beyond..ticks as i32 + beyond)
        .map(|k| reach(tooth, k))
        .collect();
    let reaches = smooth_over(&smooth_over(&reaches, SMOOTH), SMOOTH);
    let pose = |(k, reach): (usize, &f64)| {
        let (out, flat) = ray(k as i32);
        let sway = 0.4 * libm::sin(2.0 * PI * k as f64 * TICK_S / 2.9);
        let shaft = (out + Vec3::z().cross(&flat) * sway).normalize();
        let turned = Quat::rotation_between(&Vec3::y(), &shaft).unwrap_or_else(Quat::identity);
        Pose::new(MIDDLE + out * *reach + shaft * HALF, turned)
    };
    reaches.iter().take(ticks).enumerate().map(pose).collect()
}

/// How deep the capsule is in a surface, metres: its radius minus the least distance of its axis.
fn depth(tooth: &MeshDistance, pose: &Pose) -> f64 {
    let least = Capsule::axis(pose).map(|point| tooth.signed(&point));
    CAPSULE.radius - least.fold(f64::INFINITY, f64::min)
}

/// The scene for so many ticks.
pub fn scene(ticks: usize) -> Scene {
    let mesh = Tooth::lower(FDI).expect("a molar").mesh_of_side();
    println!("rigid tooth: {} triangles", mesh.triangles.len());
    let tooth = Rc::new(MeshDistance::new(mesh));
    let path = hands(&tooth, ticks);
    let depths: Vec<f64> = path.iter().map(|pose| depth(&tooth, pose)).collect();
    let fastest = path
        .windows(2)
        .map(|two| (two[1].position - two[0].position).norm() / TICK_S);
    println!(
        "the hand is inside in {:.0} % of the ticks, at most {:.2} mm; it moves at up to {:.0} mm/s",
        100.0 * depths.iter().filter(|depth| **depth > 0.0).count() as f64 / ticks as f64,
        1e3 * depths.iter().copied().fold(0.0, f64::max),
        1e3 * fastest.fold(0.0, f64::max)
    );
    let entrants = entrants(&tooth, &path[0]);
    let measured = Rc::clone(&tooth);
    Scene {
        name: "rigid tooth",
        touches: depths.iter().map(|depth| *depth > 0.0).collect(),
        path,
        depth: Box::new(move |pose, _| depth(&measured, pose)),
        every: 5,
        entrants,
    }
}

fn entrants(tooth: &Rc<MeshDistance>, park: &Pose) -> Vec<Entrant> {
    let mut all = Vec::new();
    for (level, blend) in [(3, true), (4, true), (3, false), (4, false)] {
        let compiled = Rc::new(ours(level, blend, park));
        let skin = Rc::new(Skin::default());
        let error = level_error(&compiled.objects[0].tree, level, tooth);
        let touched = if blend { "blended" } else { "bare spheres" };
        all.push(Entrant {
            name: format!("sulcus, level {level}, {touched}"),
            note: format!(
                "touches {} spheres, not the mesh: they are up to {:.0} um short of it and up to {:.0} um out of it (mean {:.0} um)",
                error.spheres, 1e3 * error.max_gap_mm, 1e3 * error.max_bulge_mm, 1e3 * error.mesh_to_spheres_mm.mean
            ),
            make: Box::new(move || Box::new(Ours::new(&compiled, &skin))),
        });
    }
    let (mesh, start) = (Rc::new(parry::mesh(tooth.mesh())), *park);
    all.push(Entrant {
        name: "parry3d contact manifolds (a query)".into(),
        note: "nothing answers it: the tool is shown where the hand is".into(),
        make: Box::new(move || Box::new(Parry::new(&CAPSULE, &mesh, &start))),
    });
    for (iterations, oriented) in [(4, false), (16, false), (4, true), (16, true)] {
        let (tooth, park) = (Rc::clone(tooth), *park);
        let solid = if oriented { ", oriented" } else { "" };
        all.push(Entrant {
            name: format!("rapier3d dynamic body, {iterations} iterations{solid}"),
            note: if oriented {
                "the mesh is told to be a solid and its inner edges are mended".to_owned()
            } else {
                "the mesh as it comes".to_owned()
            },
            make: Box::new(move || Box::new(theirs(&tooth, &park, iterations, oriented))),
        });
    }
    all
}

/// Ours: the tooth as a scene file names it.
fn ours(level: u8, blend: bool, park: &Pose) -> Compiled {
    let text = format!(
        "name = \"tooth\"\n[params]\nblend = {blend}\n\
         [[tool]]\nname = \"probe\"\nkind = \"periodontal_probe\"\npark_mm = [0.0, 0.0, 150.0]\n\
         [[object]]\nname = \"tooth\"\nkind = \"tooth\"\nfdi = {FDI}\nlevel = {level}\nlevels = 4\n"
    );
    let compiled = compile_text(
        &text,
        Path::new("tooth.toml"),
        &BuildOptions::cached(),
        &|_, _| (),
    );
    let mut scene = compiled.expect("a tooth and a probe").scene;
    // The probe was only there to be a scene.
    scene.tools = vec![CAPSULE.tool(*park)];
    scene.validate().expect("a tooth and a capsule");
    scene
}

/// Theirs: the mesh of the same tooth.
fn theirs(tooth: &MeshDistance, park: &Pose, iterations: usize, oriented: bool) -> Rapier {
    let mut engine = Rapier::new(&CAPSULE, park, iterations, LENGTH_UNIT);
    let mesh = tooth.mesh();
    let vertices = mesh.vertices.iter().map(mm).collect();
    let flags = if oriented {
        TriMeshFlags::ORIENTED | TriMeshFlags::FIX_INTERNAL_EDGES
    } else {
        TriMeshFlags::empty()
    };
    let shape = ColliderBuilder::trimesh_with_flags(vertices, mesh.triangles.clone(), flags);
    let shape = smooth(shape.expect("a closed mesh"));
    engine.world.insert(RigidBodyBuilder::fixed(), shape);
    engine
}
