//! Boundary of blocks and of the reference tongue.

use std::collections::BTreeMap;

use crate::common::{block, reference};
use sulcus_core::Vec3;
use sulcus_fem::TetMesh;
use sulcus_fem::files::{ForceColumns, read_fixed_vertices, read_forces, read_mesh};

/// Checks that every edge occurs once in each direction and every midside node is in the middle. The divergence
/// theorem gives the volume.
fn check(mesh: &TetMesh) -> Vec<[u32; 6]> {
    let faces = mesh.boundary_faces();
    let triangles = mesh.boundary_triangles();
    assert_eq!(faces.len(), triangles.len());
    let at = |node: u32| mesh.nodes[node as usize];
    let mut ways = BTreeMap::new();
    let mut volume = 0.0;
    for (face, corners) in faces.iter().zip(&triangles) {
        assert_eq!(face[..3], corners[..]);
        for k in 0..3 {
            let (from, to) = (face[k], face[(k + 1) % 3]);
            assert!(
                ways.insert((from, to), face[3 + k]).is_none(),
                "{from} {to}"
            );
            assert!((at(face[3 + k]) - (at(from) + at(to)) * 0.5).norm() < 1e-6);
        }
        let [a, b, c] = corners.map(at);
        volume += a.dot(&b.cross(&c)) / 6.0;
    }
    for ((from, to), middle) in &ways {
        assert_eq!(
            ways.get(&(*to, *from)),
            Some(middle),
            "closed at {from} {to}"
        );
    }
    let straight = mesh.tets.iter().map(|tet| {
        let [a, b, c, d] = [0, 1, 2, 3].map(|k| at(tet[k]));
        (b - a).dot(&(c - a).cross(&(d - a))) / 6.0
    });
    let straight: f64 = straight.sum();
    assert!((volume / straight - 1.0).abs() < 1e-9, "{volume:e}");
    // Midside nodes of a file are rounded.
    assert!((volume / mesh.volume() - 1.0).abs() < 1e-5, "{volume:e}");
    faces
}

#[test]
fn a_blocks_boundary_is_closed_and_outward_and_has_two_triangles_a_square() {
    let mesh = block([3, 2, 1], Vec3::new(0.03, 0.01, 0.02));
    // The sum does not depend on the origin: a place outside of the mesh gives the same.
    let mut apart = mesh.clone();
    apart
        .nodes
        .iter_mut()
        .for_each(|x| *x += Vec3::new(1.0, -2.0, 3.0));
    assert_eq!(check(&mesh).len(), 4 * (6 + 2 + 3));
    assert_eq!(check(&apart), mesh.boundary_faces());
}

#[test]
fn parts_that_touch_in_a_face_share_it_and_in_an_edge_do_not() {
    let corners = [
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.0, 0.0, 1.0],
        [1.0, 1.0, 1.0],
    ];
    let corners = corners.map(Vec3::from).to_vec();
    let one = TetMesh::from_corners(corners.clone(), &[[0, 1, 2, 3]]);
    assert_eq!(
        one.boundary_triangles(),
        [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]
    );
    let two = TetMesh::from_corners(corners, &[[0, 1, 2, 3], [1, 2, 3, 4]]);
    two.validate().expect("upright");
    assert_eq!(check(&two).len(), 6);
}

#[test]
fn the_references_boundary_is_its_published_surface() {
    let Some(folder) = reference() else { return };
    let mesh = read_mesh(&folder).expect("a mesh");
    let faces = check(&mesh);
    assert_eq!(faces.len(), 1312);
    // The triangles and their orientation are those of the surface file.
    let text = std::fs::read_to_string(folder.join("surface.obj")).expect("a surface");
    let from_least = |[a, b, c]: [u32; 3]| match a.min(b).min(c) {
        least if least == a => [a, b, c],
        least if least == b => [b, c, a],
        _ => [c, a, b],
    };
    let mut published: Vec<[u32; 3]> = Vec::new();
    for line in text.lines().filter_map(|line| line.strip_prefix("f ")) {
        let corners = line.split_whitespace().map(|corner| {
            let id = corner.split('/').next().expect("an index");
            id.parse::<u32>().expect("an index") - 1
        });
        let corners: Vec<u32> = corners.collect();
        published.push(from_least([corners[0], corners[1], corners[2]]));
    }
    let mut found: Vec<[u32; 3]> = mesh
        .boundary_triangles()
        .into_iter()
        .map(from_least)
        .collect();
    published.sort_unstable();
    found.sort_unstable();
    assert_eq!(found, published);
}

#[test]
fn forces_of_the_vertices_have_the_same_resultant_and_spare_midside_nodes() {
    let Some(folder) = reference() else { return };
    let mesh = read_mesh(&folder).expect("a mesh");
    let n = mesh.nodes.len();
    for (name, along) in [("lateral", -Vec3::y()), ("tip_vertical", -Vec3::z())] {
        let file = folder.join(format!("{name}_forces_unit.csv"));
        let [quadratic, vertices] = [ForceColumns::Quadratic, ForceColumns::Vertices]
            .map(|columns| read_forces(&file, n, columns).expect("forces"));
        for forces in [&quadratic, &vertices] {
            let sum: Vec3 = forces.iter().sum();
            assert!((sum - along).norm() < 1e-5, "{name}: {sum}");
        }
        // The 658 vertices of the surface come first.
        assert!(vertices[658..].iter().all(|f| *f == Vec3::zeros()));
        assert!(quadratic[2462..].iter().any(|f| f.norm() > 1e-3));
        assert!(
            vertices.iter().all(|f| f.dot(&along) >= 0.0),
            "lumped forces push one way"
        );
    }
    let fixed = read_fixed_vertices(&folder.join("fixed_surface_vertices.csv"), n).expect("a list");
    assert_eq!(fixed.len(), 206);
    assert!(fixed.iter().all(|&k| k < 658 && mesh.held[k] == [true; 3]));
    assert_eq!((0..658).filter(|&k| mesh.held[k][0]).count(), 206);
}
