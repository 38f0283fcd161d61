//! Sphere trees against their meshes, measured by code that the builder does not use. Real teeth and tongues,
//! instruments and importance are among the long proofs.

use std::sync::Mutex;

use sulcus_core::{SphereTree, Vec3};
use sulcus_scene::anatomy::Molar;
use sulcus_scene::error::level_error;
use sulcus_scene::mesh::TriMesh;
use sulcus_scene::mesh::distance::MeshDistance;
use sulcus_scene::mesh::shapes::{ellipsoid, icosphere};
use sulcus_scene::tree::build::{TreeBuildError, TreeOptions, build_tree};

pub fn tree(mesh: &TriMesh, options: &TreeOptions) -> SphereTree {
    build_tree(mesh, options, &|_, _| ()).expect("a tree")
}

pub fn to_level(levels: u8) -> TreeOptions {
    TreeOptions {
        levels,
        ..TreeOptions::default()
    }
}

/// Bounds of one level, millimetres: mesh to spheres mean and max, spheres to mesh max.
fn assert_within(mesh: &TriMesh, tree: &SphereTree, level: u8, mean: f64, max: f64, bulge: f64) {
    let found = level_error(tree, level, &MeshDistance::new(mesh.clone()));
    println!("{found:?}");
    assert!(found.spheres <= 8_usize.pow(u32::from(level)), "{found:?}");
    assert!(found.mesh_to_spheres_mm.mean <= mean, "{found:?}");
    assert!(found.mesh_to_spheres_mm.max <= max, "{found:?}");
    assert!(found.spheres_to_mesh_mm.max <= bulge, "{found:?}");
}

#[test]
fn an_ellipsoid_is_followed_at_every_level() {
    let mesh = ellipsoid(Vec3::new(6e-3, 4e-3, 2.5e-3), 4);
    let options = TreeOptions {
        samples: 20_000,
        ..to_level(3)
    };
    let tree = tree(&mesh, &options);
    assert_within(&mesh, &tree, 1, 0.2, 0.8, 0.8);
    assert_within(&mesh, &tree, 2, 0.04, 0.25, 0.25);
    assert_within(&mesh, &tree, 3, 0.006, 0.05, 0.05);
}

#[test]
fn a_ball_is_one_sphere() {
    let mesh = icosphere(5e-3, 4);
    let tree = tree(
        &mesh,
        &TreeOptions {
            good_enough: 0.05e-3,
            samples: 5_000,
            ..to_level(3)
        },
    );
    assert_eq!(tree.nodes().len(), 1, "a node that fits is not split");
    assert!((tree.nodes()[0].contact_radius - 5e-3).abs() < 0.03e-3);
}

/// Builds a part and checks its finest level, and the named ones above, against bounds in millimetres.
///
/// A bound is a level, mesh to spheres mean and max, and spheres to mesh max. Maxima are proven, not sampled.
pub fn assert_part(name: &str, levels: u8, bounds: &[(u8, f64, f64, f64)]) {
    let part = crate::meshes::part(name);
    let Some(mesh) = part.mesh() else { return };
    let tree = part.tree(&mesh, levels);
    for &(level, mean, max, bulge) in bounds {
        assert_within(&mesh, &tree, level, mean, max, bulge);
    }
}

#[test]
fn the_parametric_molar_meets_its_bounds() {
    assert_part("parametric molar", 3, &[(3, 0.015, 0.10, 0.15)]);
}

#[test]
fn a_skeleton_has_nodes_through_the_depth_and_children_at_the_surface_only() {
    let mesh = ellipsoid(Vec3::new(30e-3, 20e-3, 12e-3), 4);
    let options = TreeOptions {
        volumetric: true,
        samples: 20_000,
        ..to_level(3)
    };
    let tree = tree(&mesh, &options);
    let second: Vec<_> = tree.nodes().iter().filter(|n| n.level == 2).collect();
    assert_eq!(second.len(), 64);
    // A fit to the surface alone would put all centres near the middle plane.
    let low = second.iter().filter(|n| n.centre.z < -4e-3).count();
    let high = second.iter().filter(|n| n.centre.z > 4e-3).count();
    assert!(low >= 10 && high >= 10, "{low} low, {high} high");
    let distance = MeshDistance::new(mesh.clone());
    for node in second.iter().filter(|n| n.children == 0) {
        // Spheres that stay at finer levels must not stick out.
        assert!(distance.signed(&node.centre) + node.contact_radius < 0.1e-3);
    }
    assert_within(&mesh, &tree, 3, 0.05, 0.4, 0.4);
}

#[test]
fn the_same_input_gives_the_same_bits() {
    let mesh = Molar {
        grid_mm: 0.5,
        ..Molar::default()
    }
    .mesh();
    assert_eq!(
        mesh,
        Molar {
            grid_mm: 0.5,
            ..Molar::default()
        }
        .mesh()
    );
    let options = TreeOptions {
        samples: 5_000,
        ..to_level(3)
    };
    let (one, other) = (tree(&mesh, &options), tree(&mesh, &options));
    assert_eq!(one.nodes().len(), other.nodes().len());
    for (a, b) in one.nodes().iter().zip(other.nodes()) {
        assert_eq!(a.centre.map(f64::to_bits), b.centre.map(f64::to_bits));
        assert_eq!(a.contact_radius.to_bits(), b.contact_radius.to_bits());
    }
}

#[test]
fn progress_rises_from_zero_to_one() {
    let seen = Mutex::new(Vec::new());
    let options = TreeOptions {
        samples: 2_000,
        ..to_level(2)
    };
    build_tree(&icosphere(5e-3, 3), &options, &|_, share| {
        seen.lock().expect("lock").push(share)
    })
    .expect("a tree");
    let seen = seen.into_inner().expect("lock");
    assert!(
        seen.windows(2).all(|pair| pair[0] <= pair[1]) && seen.last() == Some(&1.0),
        "{seen:?}"
    );
}

#[test]
fn options_out_of_range_are_named() {
    let mesh = icosphere(5e-3, 2);
    let refused =
        |options: TreeOptions| build_tree(&mesh, &options, &|_, _| ()).expect_err("refused");
    assert_eq!(
        refused(to_level(0)).to_string(),
        "levels is 0, expected 1 to 6"
    );
    let nan = refused(TreeOptions {
        good_enough: f64::NAN,
        ..to_level(2)
    });
    assert!(
        matches!(
            nan,
            TreeBuildError::Option {
                field: "good_enough",
                ..
            }
        ),
        "{nan}"
    );
}
