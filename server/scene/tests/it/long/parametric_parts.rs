//! Trees of the parametric instruments, and of a mesh with weighted places.

use sulcus_core::{SphereTree, Vec3};
use sulcus_scene::mesh::shapes::ellipsoid;
use sulcus_scene::tree::build::{TreeOptions, build_weighted};
use sulcus_support::long;

use crate::trees::{assert_part, to_level, tree};

#[test]
fn the_parametric_instruments_meet_their_bounds() {
    if long::selected("trees-of-parametric-instruments") {
        assert_part("parametric probe", 3, &[(3, 0.003, 0.02, 0.02)]);
        assert_part("parametric mirror", 3, &[(3, 0.05, 0.25, 1.0)]);
    }
}

#[test]
fn importance_brings_spheres_to_where_it_is_high() {
    if !long::selected("importance-of-places") {
        return;
    }
    let mesh = ellipsoid(Vec3::new(6e-3, 4e-3, 2.5e-3), 4);
    let options = TreeOptions {
        samples: 20_000,
        ..to_level(3)
    };
    let weighted = build_weighted(
        &mesh,
        &options,
        &|p| if p.x > 4e-3 { 1e4 } else { 1.0 },
        &|_, _| (),
    )
    .expect("a tree");
    let at_the_end = |tree: &SphereTree| {
        let spheres: Vec<_> = tree.shape_at(3).map(|(_, n)| n.sphere()).collect();
        let points = mesh.vertices.iter().filter(|v| v.x > 4.2e-3);
        let gaps: Vec<f64> = points
            .map(|p| {
                spheres.iter().fold(f64::INFINITY, |least, s| {
                    least.min((p - s.centre).norm() - s.radius)
                })
            })
            .collect();
        gaps.iter().map(|gap| gap.abs()).sum::<f64>() / gaps.len() as f64
    };
    let (even, uneven) = (at_the_end(&tree(&mesh, &options)), at_the_end(&weighted));
    assert!(uneven < 0.8 * even, "{uneven} against {even}");
}
