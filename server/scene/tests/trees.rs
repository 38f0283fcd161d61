//! Sphere trees against the meshes they stand for, measured by code that the builder does not use.

use std::path::Path;
use std::sync::Mutex;

use sulcus_core::{SphereTree, Vec3};
use sulcus_scene::build::{TreeBuildError, TreeOptions, build_tree};
use sulcus_scene::distance::MeshDistance;
use sulcus_scene::error::level_error;
use sulcus_scene::load::Unit;
use sulcus_scene::mesh::TriMesh;
use sulcus_scene::parametric::{Molar, Probe};
use sulcus_scene::shapes::{ellipsoid, icosphere};
use sulcus_scene::solid::{Solid, read_solid};

fn tree(mesh: &TriMesh, options: &TreeOptions) -> SphereTree {
    build_tree(mesh, options, &|_, _| ()).expect("a tree")
}

fn to_level(levels: u8) -> TreeOptions {
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

#[test]
fn the_parametric_molar_meets_its_bounds_at_contact_level() {
    let mesh = Molar::default().mesh();
    let tree = tree(&mesh, &to_level(3));
    assert_within(&mesh, &tree, 3, 0.02, 0.17, 0.17);
}

#[test]
fn the_probe_meets_its_bounds_at_contact_level() {
    let mesh = Probe::default().touching_mesh();
    let tree = tree(
        &mesh,
        &TreeOptions {
            good_enough: 5e-6,
            samples: 20_000,
            ..to_level(3)
        },
    );
    assert_within(&mesh, &tree, 3, 0.003, 0.02, 0.02);
}

#[test]
fn a_real_tooth_meets_its_bounds() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../../shared/data/meshes/tooth_36_first_molar.stl");
    if !file.exists() {
        println!(
            "SKIPPED: {} is not there, so no real tooth was tested",
            file.display()
        );
        eprintln!(
            "SKIPPED: {} is not there, so no real tooth was tested",
            file.display()
        );
        return;
    }
    let Solid { mesh, report, .. } = read_solid(&file, Unit::Millimetre).expect("a solid");
    assert_eq!(report.triangles, 4800);
    assert!((report.volume_mm3 - 1085.7).abs() < 0.1, "{report:?}");
    let tree = tree(&mesh, &to_level(3));
    assert_within(&mesh, &tree, 3, 0.02, 0.15, 0.15);
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
        alpha: f64::NAN,
        ..to_level(2)
    });
    assert!(
        matches!(nan, TreeBuildError::Option { field: "alpha", .. }),
        "{nan}"
    );
}
