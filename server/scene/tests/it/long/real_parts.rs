//! Trees of real teeth, a gingiva, a tongue and instruments against their meshes, at the finest level.

use sulcus_scene::error::{Sampling, measure};
use sulcus_scene::mesh::distance::MeshDistance;
use sulcus_support::long;

use crate::trees::assert_part;

/// Largest error on the pocket's walls at level 3.
const WALLS_MAX_MM: f64 = 0.15;

#[test]
fn a_real_tooth_meets_its_bounds() {
    if !long::selected("tree-of-a-real-tooth") {
        return;
    }
    assert_part(
        "tooth 36",
        4,
        &[(3, 0.015, 0.10, 0.20), (4, 0.003, 0.03, 0.08)],
    );
}

#[test]
fn a_real_probe_meets_its_bounds() {
    if !long::selected("tree-of-a-real-probe") {
        return;
    }
    assert_part("probe", 3, &[(3, 0.01, 0.05, 0.15)]);
}

#[test]
fn a_mirror_meets_its_bounds() {
    if !long::selected("tree-of-a-real-mirror") {
        return;
    }
    // A disc two millimetres thick: the spheres of its faces leave a cavity, which no tool can touch.
    assert_part("mirror", 3, &[(3, 0.05, 0.25, 1.0)]);
}

#[test]
fn a_tongue_with_a_skeleton_meets_its_bounds() {
    if !long::selected("tree-of-a-real-tongue") {
        return;
    }
    assert_part("tongue", 3, &[(3, 0.10, 0.60, 0.80)]);
}

#[test]
fn pocket_walls_fit_and_leave_the_pocket_open() {
    if !long::selected("tree-of-a-real-pocket") {
        return;
    }
    let part = crate::meshes::part("pocket patch");
    let (Some(mesh), Some(tooth_mesh)) =
        (part.mesh(), crate::meshes::data("tooth_36_first_molar.stl"))
    else {
        return;
    };
    let tree = part.tree(&mesh, 3);
    let distance = MeshDistance::new(mesh);
    let report = measure(
        &tree,
        &distance,
        part.zones(),
        &Sampling::default(),
        &|_| (),
    );
    let walls = &report.zones[0].levels[3];
    println!("{walls:?}");
    assert!(walls.mesh_to_spheres_mm.mean <= 0.05, "{walls:?}");
    assert!(walls.mesh_to_spheres_mm.max <= WALLS_MAX_MM, "{walls:?}");
    // Gingiva spheres that reach above z = 1.5 mm belong to the open pocket or the margin.
    let tooth = crate::meshes::part("tooth 36").tree(&tooth_mesh, 3);
    let mut closest = f64::INFINITY;
    for (_, wall) in tree.shape_at(3).filter(|(_, n)| n.centre.z > 1.5e-3) {
        for (_, node) in tooth.shape_at(3) {
            let gap =
                (wall.centre - node.centre).norm() - wall.contact_radius - node.contact_radius;
            closest = closest.min(gap);
        }
    }
    println!(
        "free width of the pocket, where it is narrowest: {:.3} mm",
        closest * 1e3
    );
    assert!(closest > 0.0, "{closest}");
}
