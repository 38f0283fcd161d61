//! Repairs, their messages, and faults that are not repaired.

use proptest::prelude::*;
use sulcus_core::Vec3;
use sulcus_scene::mesh::TriMesh;
use sulcus_scene::mesh::check::{MeshError, MeshReport, check};
use sulcus_scene::mesh::load::{Unit, to_stl};
use sulcus_scene::mesh::repair::{Repairs, SMALL_HOLE_SHARE, WELD_SHARE, repair};
use sulcus_scene::mesh::shapes::{cuboid, ellipsoid, icosphere};
use sulcus_scene::read_solid;

/// Repairs, and expects a solid of the same volume within a share.
fn mended(mesh: &TriMesh, like: &TriMesh, share: f64) -> (MeshReport, Repairs) {
    let (solid, repairs) = repair(mesh.clone());
    let report = check(&solid, "mended").expect("a solid");
    let ratio = solid.signed_volume() / like.signed_volume();
    assert!((ratio - 1.0).abs() <= share, "{ratio}: {repairs}");
    let (again, more) = repair(solid.clone());
    assert!(again == solid && more.is_empty(), "twice is once: {more}");
    assert_eq!(
        repairs.to_string().lines().count(),
        repairs.sentences().len()
    );
    (report, repairs)
}

/// Every triangle with its own three vertices.
fn unwelded(mesh: &TriMesh) -> TriMesh {
    TriMesh {
        vertices: (0..mesh.triangles.len())
            .flat_map(|t| mesh.corners(t))
            .collect(),
        triangles: (0..mesh.triangles.len() as u32)
            .map(|t| [3 * t, 3 * t + 1, 3 * t + 2])
            .collect(),
    }
}

fn tooth() -> TriMesh {
    ellipsoid(Vec3::new(5e-3, 4e-3, 9e-3), 4).placed(1.0, Vec3::new(0.02, -0.01, 0.005))
}

#[test]
fn a_good_mesh_comes_back_bit_by_bit() {
    for mesh in [
        tooth(),
        cuboid(Vec3::repeat(0.01)),
        sulcus_scene::anatomy::Molar::default().mesh(),
    ] {
        let (same, repairs) = repair(mesh.clone());
        assert!(same == mesh);
        assert!(repairs.is_empty() && repairs.sentences().is_empty());
        assert_eq!(repairs.to_string(), "nothing was repaired");
    }
}

#[test]
fn a_small_hole_is_closed_and_placed() {
    let whole = tooth();
    let mut mesh = whole.clone();
    let gone = mesh.triangles[700][0];
    mesh.triangles.retain(|t| !t.contains(&gone));
    let (report, repairs) = mended(&mesh, &whole, 1e-3);
    let [hole] = &repairs.holes[..] else {
        panic!("{repairs}")
    };
    assert_eq!(hole.edges, 6);
    let at = Vec3::from(hole.at_mm) * 1e-3;
    assert!(
        (at - whole.vertices[gone as usize]).norm() < 0.2e-3,
        "{hole}"
    );
    assert!(hole.diameter_mm > 0.5 && hole.diameter_mm < 1.2, "{hole}");
    assert_eq!(report.triangles, whole.triangles.len() - 2);
    let said = repairs.to_string();
    assert!(
        said.contains("\n1 small hole was closed (6 edges, ") && said.ends_with(") mm)"),
        "{said}"
    );
}

#[test]
fn holes_that_share_a_vertex_and_a_crooked_one_are_closed() {
    let whole = ellipsoid(Vec3::new(5e-3, 4e-3, 9e-3), 5);
    let mut mesh = whole.clone();
    // Every other triangle around a vertex: three holes that meet in it.
    let hub = mesh.triangles[700][0];
    let mut around: Vec<usize> = (0..mesh.triangles.len())
        .filter(|&t| mesh.triangles[t].contains(&hub))
        .collect();
    let first = around[0];
    around.retain(|&t| {
        t == first
            || mesh.triangles[t]
                .iter()
                .filter(|v| mesh.triangles[first].contains(v))
                .count()
                == 1
    });
    let gone: Vec<[u32; 3]> = around.iter().map(|&t| mesh.triangles[t]).collect();
    assert!(gone.len() >= 2);
    // And a strip elsewhere, far from convex.
    let far = mesh.triangles[2000];
    mesh.triangles
        .retain(|t| !gone.contains(t) && t.iter().filter(|v| far.contains(v)).count() < 2);
    let (report, repairs) = mended(&mesh, &whole, 1e-3);
    assert!(repairs.holes.len() >= 2, "{repairs}");
    assert_eq!((report.triangles, report.genus), (whole.triangles.len(), 0));
}

#[test]
fn a_missing_triangle_is_put_back_even_in_a_coarse_mesh() {
    let whole = icosphere(0.002, 2);
    let mut mesh = whole.clone();
    let gone = mesh.triangles.pop().expect("triangles");
    let (solid, repairs) = repair(mesh);
    assert_eq!(repairs.holes[0].edges, 3);
    let put = solid.triangles[solid.triangles.len() - 1];
    assert!((0..3).any(|k| [gone[k], gone[(k + 1) % 3], gone[(k + 2) % 3]] == put));
}

#[test]
fn a_patch_follows_the_surface_and_does_not_fold() {
    // A hole of a dozen and more edges over the sharp end of an ellipsoid.
    let whole = ellipsoid(Vec3::new(20e-3, 4e-3, 4e-3), 5);
    let tip = Vec3::new(20e-3, 0.0, 0.0);
    let mut mesh = whole.clone();
    mesh.triangles.retain(|t| {
        t.iter()
            .all(|&v| (whole.vertices[v as usize] - tip).norm() > 0.7e-3)
    });
    let before = mesh.triangles.len();
    let (solid, repairs) = repair(mesh);
    assert!(repairs.holes[0].edges > 8, "{repairs}");
    check(&solid, "mended").expect("a solid");
    for t in before..solid.triangles.len() {
        assert!(
            solid.area_vector(t).x > 0.0,
            "triangle {t} of the patch faces away"
        );
    }
}

#[test]
fn large_holes_are_left_open() {
    let mut mesh = tooth();
    let size = {
        let (low, high) = mesh.bounds();
        (high - low).norm()
    };
    let centre = mesh.vertices[mesh.triangles[700][0] as usize];
    let vertices = mesh.vertices.clone();
    mesh.triangles.retain(|t| {
        t.iter()
            .all(|&v| (vertices[v as usize] - centre).norm() > 0.06 * size)
    });
    let (left, repairs) = repair(mesh.clone());
    assert!(repairs.holes.is_empty());
    assert_eq!(left.triangles.len(), mesh.triangles.len());
    let Err(MeshError::Open { openings, .. }) = check(&left, "x") else {
        panic!("open")
    };
    assert!(openings[0].diameter_mm > SMALL_HOLE_SHARE * size * 1e3);
    assert!((Vec3::from(openings[0].at_mm) * 1e-3 - centre).norm() < 0.5e-3);
}

#[test]
fn flipped_faces_are_turned() {
    let whole = tooth();
    let mut mesh = whole.clone();
    for t in [17, 18, 500, 2001] {
        mesh.triangles[t].swap(0, 1);
    }
    let (_, repairs) = mended(&mesh, &whole, 0.0);
    assert_eq!(
        (repairs.turned_triangles, repairs.turned_outward),
        (4, false)
    );
    let corners = whole.corners(17);
    let at = (corners[0] + corners[1] + corners[2]) / 3.0;
    let found = Vec3::from(repairs.first_turned_mm.expect("a place")) * 1e-3;
    assert!((at - found).norm() < 1e-6);
    assert!(
        repairs
            .to_string()
            .starts_with("4 triangles were turned to agree with their neighbours, the first at (")
    );
}

#[test]
fn a_mesh_turned_inside_out_is_turned_outward() {
    let whole = tooth();
    let mut mesh = whole.clone();
    mesh.triangles.iter_mut().for_each(|t| t.swap(1, 2));
    let (_, repairs) = mended(&mesh, &whole, 0.0);
    assert_eq!(
        repairs,
        Repairs {
            turned_outward: true,
            ..Repairs::default()
        }
    );
    assert!(repair(mesh).0 == whole);
}

#[test]
fn every_triangle_turned_at_random_is_one_surface_again() {
    let whole = tooth();
    let mut mesh = whole.clone();
    for (k, triangle) in mesh.triangles.iter_mut().enumerate() {
        if (k * k * 7 + k / 3) % 5 < 2 {
            triangle.swap(0, 2);
        }
    }
    let (_, repairs) = mended(&mesh, &whole, 1e-12);
    assert!(
        repairs.turned_triangles > 1000 && repairs.turned_triangles < 3000,
        "{repairs}"
    );
}

#[test]
fn duplicate_vertices_are_joined() {
    let whole = tooth();
    let (report, repairs) = mended(&unwelded(&whole), &whole, 1e-12);
    assert_eq!(report.vertices, whole.vertices.len());
    let joined = 3 * whole.triangles.len() - whole.vertices.len();
    assert_eq!(
        repairs,
        Repairs {
            duplicate_vertices: joined,
            ..Repairs::default()
        }
    );
    assert_eq!(
        repairs.to_string(),
        format!("{joined} vertices were joined with another in the same place")
    );
}

#[test]
fn a_seam_of_duplicate_vertices_is_closed_and_nothing_else_touched() {
    // Texture coordinates duplicate the vertices of one half of a ball.
    let whole = icosphere(0.004, 3);
    let mut mesh = whole.clone();
    let count = mesh.vertices.len() as u32;
    mesh.vertices.extend(&whole.vertices);
    for triangle in &mut mesh.triangles {
        if triangle
            .iter()
            .all(|&v| whole.vertices[v as usize].z < 1e-9)
        {
            triangle.iter_mut().for_each(|v| *v += count);
        }
    }
    let (report, repairs) = mended(&mesh, &whole, 1e-12);
    assert_eq!(report.vertices, whole.vertices.len());
    assert!(
        repairs.duplicate_vertices > 20 && repairs.duplicate_vertices < 100,
        "{repairs}"
    );
    assert!(
        repairs.unused_vertices > 500 && repairs.holes.is_empty(),
        "{repairs}"
    );
}

#[test]
fn an_unwelded_mesh_with_the_noise_of_single_precision_is_welded() {
    let whole = tooth();
    let mut mesh = unwelded(&whole);
    for (k, vertex) in mesh.vertices.iter_mut().enumerate() {
        for (axis, x) in vertex.iter_mut().enumerate() {
            let noise = ((k * 3 + axis) * 2_654_435_761 % 1000) as f64 / 1000.0 - 0.5;
            *x *= 1.0 + noise * f64::from(f32::EPSILON);
        }
    }
    let (report, repairs) = mended(&mesh, &whole, 1e-6);
    assert_eq!(
        (report.vertices, report.triangles),
        (whole.vertices.len(), whole.triangles.len())
    );
    assert!(
        repairs.welded_vertices + repairs.duplicate_vertices
            == mesh.vertices.len() - whole.vertices.len()
    );
    assert!(
        repairs.largest_weld_mm > 0.0 && repairs.largest_weld_mm < 1e-5,
        "{repairs}"
    );
    assert!(
        repairs.holes.is_empty() && repairs.degenerate_triangles == 0,
        "{repairs}"
    );
}

#[test]
fn edges_shorter_than_the_weld_tolerance_are_not_collapsed() {
    // A hole so small that all vertices of its rim are within the tolerance of each other.
    let mut mesh = tooth();
    let (low, high) = mesh.bounds();
    let tolerance = WELD_SHARE * (high - low).norm();
    let gone = mesh.triangles[700][0];
    let centre = mesh.vertices[gone as usize];
    let mut rim: Vec<u32> = mesh
        .triangles
        .iter()
        .filter(|t| t.contains(&gone))
        .flatten()
        .copied()
        .filter(|&v| v != gone)
        .collect();
    rim.sort_unstable();
    rim.dedup();
    for &v in &rim {
        let place = &mut mesh.vertices[v as usize];
        *place = centre + (*place - centre).normalize() * (0.3 * tolerance);
    }
    mesh.triangles.retain(|t| !t.contains(&gone));
    let (solid, repairs) = repair(mesh.clone());
    assert_eq!(
        (repairs.welded_vertices, repairs.degenerate_triangles),
        (0, 0)
    );
    assert_eq!((rim.len(), repairs.holes[0].edges), (6, 6));
    assert_eq!(solid.triangles.len(), mesh.triangles.len() + 4);
    check(&solid, "mended").expect("a solid");
}

#[test]
fn duplicate_degenerate_and_unused_parts_are_dropped() {
    let whole = tooth();
    let mut mesh = whole.clone();
    mesh.triangles.insert(3, [5, 5, 6]);
    let [a, b, c] = mesh.triangles[9];
    mesh.triangles.extend([[b, c, a], [a, c, b]]);
    mesh.vertices.insert(0, Vec3::repeat(f64::NAN));
    mesh.triangles.iter_mut().flatten().for_each(|v| *v += 1);
    let (report, repairs) = mended(&mesh, &whole, 0.0);
    assert_eq!(report.triangles, whole.triangles.len());
    assert_eq!(
        repairs,
        Repairs {
            unused_vertices: 1,
            degenerate_triangles: 1,
            duplicate_triangles: 2,
            ..Repairs::default()
        }
    );
    assert_eq!(repairs.sentences().len(), 3);
}

#[test]
fn a_triangle_without_length_is_collapsed() {
    // An edge is cut in a point that is there twice, so two triangles have no length.
    let whole = cuboid(Vec3::repeat(5e-3));
    let mut mesh = whole.clone();
    let [a, b, c] = mesh.triangles[0];
    let twin = mesh.vertices.len() as u32;
    mesh.vertices.push(mesh.vertices[a as usize]);
    // Triangle 0 uses the twin; two needles of no width close the gaps.
    let d = mesh.triangles[1][2];
    assert_eq!(mesh.triangles[1], [a, c, d]);
    mesh.triangles[0] = [twin, b, c];
    mesh.triangles.extend([[a, twin, c], [a, b, twin]]);
    let (report, repairs) = mended(&mesh, &whole, 0.0);
    assert_eq!((report.triangles, report.vertices), (12, 8));
    assert_eq!(
        (repairs.duplicate_vertices, repairs.degenerate_triangles),
        (1, 2)
    );
}

#[test]
fn both_sides_of_every_triangle_are_one_surface() {
    let whole = tooth();
    let mut mesh = whole.clone();
    mesh.triangles
        .extend(whole.triangles.iter().map(|&[a, b, c]| [a, c, b]));
    let (_, repairs) = mended(&mesh, &whole, 0.0);
    assert_eq!(repairs.duplicate_triangles, whole.triangles.len());
}

#[test]
fn three_hundred_thousand_triangles_are_read_and_checked() {
    let ball = icosphere(0.005, 7);
    assert_eq!(ball.triangles.len(), 327_680);
    let dir = tempfile::tempdir().expect("temporary directory");
    let file = dir.path().join("ball.stl");
    std::fs::write(&file, to_stl(&ball)).expect("written");
    let solid = read_solid(&file, Unit::Millimetre).expect("a solid");
    assert!(solid.repairs.is_empty());
    assert_eq!(
        (
            solid.report.triangles,
            solid.report.vertices,
            solid.report.genus
        ),
        (327_680, 163_842, 0)
    );
    // And broken in every way at once.
    let mut mesh = unwelded(&solid.mesh);
    mesh.triangles.swap_remove(1000);
    mesh.triangles
        .iter_mut()
        .step_by(7)
        .for_each(|t| t.swap(0, 1));
    let (_, repairs) = mended(&mesh, &solid.mesh, 1e-6);
    assert_eq!(repairs.holes.len(), 1);
    assert!(repairs.turned_triangles > 46_000);
}

#[test]
fn what_has_no_one_answer_is_left_as_it_is() {
    let ball = icosphere(0.005, 2);
    let mut two = ball.clone();
    let first = two.vertices.len() as u32;
    two.vertices
        .extend(ball.vertices.iter().map(|v| v + Vec3::new(0.02, 0.0, 0.0)));
    two.triangles
        .extend(ball.triangles.iter().map(|t| t.map(|v| v + first)));
    let flat = cuboid(Vec3::new(5e-3, 5e-3, 1e-15));
    let index = TriMesh {
        triangles: vec![[0, 1, 900]],
        ..ball.clone()
    };
    let mut infinite = ball.clone();
    infinite.vertices[3].x = f64::INFINITY;
    let huge = ball.clone().placed(1e200, Vec3::zeros());
    for mesh in [two, flat, index, infinite, huge, TriMesh::default()] {
        let (same, repairs) = repair(mesh.clone());
        assert!(same == mesh);
        assert!(repairs.is_empty());
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn damage_is_mended_or_refused_and_always_told(
        removed in proptest::collection::vec(0_usize..1280, 0..6),
        turned in proptest::collection::vec(0_usize..1280, 0..200),
        copied in proptest::collection::vec(0_usize..1280, 0..6),
        split in any::<bool>(),
    ) {
        let whole = icosphere(0.005, 3);
        let mut mesh = whole.clone();
        for &t in &turned {
            mesh.triangles[t].swap(0, 1);
        }
        for &t in &copied {
            mesh.triangles.push(whole.triangles[t]);
        }
        let mut t = 0;
        mesh.triangles.retain(|_| { t += 1; !removed.contains(&(t - 1)) });
        let damaged = mesh.triangles != whole.triangles;
        if split {
            mesh = unwelded(&mesh);
        }
        let (solid, repairs) = repair(mesh);
        let checked = check(&solid, "mended");
        if damaged || split {
            prop_assert!(!repairs.is_empty() || checked.is_err());
        } else {
            prop_assert!(repairs.is_empty() && checked.is_ok());
        }
        if let Ok(report) = checked {
            prop_assert_eq!(report.genus, 0);
            prop_assert!((solid.signed_volume() / whole.signed_volume() - 1.0).abs() < 0.02);
        }
    }
}
