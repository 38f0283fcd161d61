//! Trees of analytic shapes and the tools that slide over them, shared by the ripple's test and bench.
//! Trees take a while to build, so they are kept in the build directory.

// Test and bench each use their part.
#![allow(dead_code)]

use std::path::Path;

use sulcus_cases::ripple::{Shape, forced};
use sulcus_cases::scenes::{self, TIP_BELOW_DEVICE};
use sulcus_core::tissue::TissueModel;
use sulcus_core::{DisplayMesh, Object, Scene, SphereTree, Tool, Vec3};
use sulcus_scene::mesh::TriMesh;
use sulcus_scene::mesh::shapes;
use sulcus_scene::tree::build::{BUILDER_VERSION, TreeOptions, build_tree};

/// A closed cylinder about the x axis: `around` sectors, rows as long as a sector is wide.
pub fn cylinder(radius: f64, half_length: f64, around: u32) -> TriMesh {
    let sector = std::f64::consts::TAU / f64::from(around);
    let rows = (2.0 * half_length / (radius * sector)).round().max(1.0) as u32;
    let ring = |r: f64, x: f64, vertices: &mut Vec<Vec3>| {
        for k in 0..around {
            let angle = sector * f64::from(k);
            vertices.push(Vec3::new(x, r * angle.cos(), r * angle.sin()));
        }
    };
    let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
    for row in 0..=rows {
        let x = half_length * (2.0 * f64::from(row) / f64::from(rows) - 1.0);
        ring(radius, x, &mut vertices);
    }
    for row in 0..rows {
        for k in 0..around {
            let (a, b) = (row * around + k, row * around + (k + 1) % around);
            triangles.extend([[a, b + around, b], [a, a + around, b + around]]);
        }
    }
    for (x, first, flip) in [(-half_length, 0, false), (half_length, rows * around, true)] {
        let middle = vertices.len() as u32;
        vertices.push(Vec3::new(x, 0.0, 0.0));
        for k in 0..around {
            let (a, b) = (first + k, first + (k + 1) % around);
            triangles.push(if flip { [middle, b, a] } else { [middle, a, b] });
        }
    }
    let mut mesh = TriMesh {
        vertices,
        triangles,
    };
    if volume(&mesh) < 0.0 {
        for t in &mut mesh.triangles {
            t.swap(1, 2);
        }
    }
    mesh
}

fn volume(mesh: &TriMesh) -> f64 {
    (0..mesh.triangles.len())
        .map(|t| {
            let [a, b, c] = mesh.corners(t);
            a.dot(&b.cross(&c)) / 6.0
        })
        .sum()
}

/// A fine mesh of the shape.
pub fn mesh(shape: &Shape) -> TriMesh {
    match *shape {
        // Facets of 81,920 triangles stand at most a micrometre off.
        Shape::Ellipsoid(semi_axes) => shapes::ellipsoid(semi_axes, 6),
        Shape::Slab(half) => shapes::cuboid(half),
        Shape::Cylinder {
            radius,
            half_length,
        } => cylinder(radius, half_length, 256),
    }
}

/// The tree of a mesh, from the build directory where it was built before.
pub fn tree(name: &str, mesh: &TriMesh, levels: u8) -> SphereTree {
    let options = TreeOptions {
        levels,
        ..TreeOptions::default()
    };
    let mut hash = blake3::Hasher::new();
    hash.update(format!("{BUILDER_VERSION} {options:?}").as_bytes());
    for v in &mesh.vertices {
        for x in v.iter() {
            hash.update(&x.to_bits().to_le_bytes());
        }
    }
    let file = Path::new(env!("CARGO_TARGET_TMPDIR"))
        .join(format!("{name}-{}.scene", &hash.finalize().to_hex()[..16]));
    if let Some(kept) = std::fs::read(&file)
        .ok()
        .and_then(|bytes| Scene::from_bytes(&bytes).ok())
    {
        return kept.objects[0].tree.clone();
    }
    sulcus_scene::mesh::check::check(mesh, name).expect("a good mesh");
    let tree = build_tree(mesh, &options, &|_, _| ()).expect("a good mesh");
    let kept = scenes::scene(name, vec![object(name, tree.clone(), levels)]);
    std::fs::write(&file, kept.to_bytes().expect("small")).expect("build directory");
    tree
}

/// A rigid thing of that tree.
pub fn object(name: &str, tree: SphereTree, level: u8) -> Object {
    Object {
        name: name.into(),
        fdi: 0,
        tree,
        level,
        tissue: TissueModel::Rigid,
        mesh: DisplayMesh::default(),
        carriers: Vec::new(),
    }
}

/// A probe's tip: a rod of spheres of 0.25 mm radius, turned with the surface.
pub fn tip() -> Tool {
    forced(scenes::rod())
}

/// A mirror: a disc of 22 mm, 2 mm thick, face down.
pub fn mirror(level: u8) -> Tool {
    let mut mesh = cylinder(11e-3, 1e-3, 96);
    for v in &mut mesh.vertices {
        // Axis from x to z, face at the tip's depth.
        *v = Vec3::new(v.y, v.z, v.x + 1e-3 - TIP_BELOW_DEVICE);
    }
    if volume(&mesh) < 0.0 {
        for t in &mut mesh.triangles {
            t.swap(1, 2);
        }
    }
    Tool {
        name: "mirror".into(),
        tree: tree("mirror", &mesh, 4),
        level,
        working_point: Vec3::new(0.0, 0.0, -TIP_BELOW_DEVICE),
        tip: Vec3::new(0.0, 0.0, -TIP_BELOW_DEVICE),
        ..tip()
    }
}
