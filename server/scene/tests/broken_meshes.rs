//! Meshes that are not solids are refused, with numbers.

use sulcus_core::Vec3;
use sulcus_scene::check::check;
use sulcus_scene::mesh::TriMesh;

use sulcus_scene::shapes::{cuboid, icosphere};

fn message(mesh: &TriMesh) -> String {
    check(mesh, "tooth.stl").expect_err("broken").to_string()
}

#[test]
fn a_good_mesh_is_described() {
    let report = check(&cuboid(Vec3::new(0.005, 0.004, 0.003)), "box").expect("good");
    assert_eq!(report.size_mm, [10.0, 8.0, 6.0]);
    assert_eq!(
        (report.volume_mm3, report.area_mm2, report.genus),
        (480.0, 376.0, 0)
    );
}

#[test]
fn a_hole_is_counted() {
    let mut mesh = icosphere(0.005, 3);
    let [a, ..] = mesh.triangles[0];
    mesh.triangles.retain(|t| !t.contains(&a));
    assert_eq!(
        message(&mesh),
        "tooth.stl: found 5 open edges, expected a closed surface without holes"
    );
}

#[test]
fn a_flipped_face_is_counted() {
    let mut mesh = icosphere(0.005, 2);
    mesh.triangles[17].swap(0, 1);
    assert!(message(&mesh).contains("3 edges whose two triangles face opposite ways"));
}

#[test]
fn a_wrong_unit_is_asked_about() {
    let metres_as_mm = icosphere(0.005, 1).placed(1e3, Vec3::zeros());
    assert_eq!(
        message(&metres_as_mm),
        "tooth.stl: found an overall size of 10000 mm, expected 0.5 to 500 mm: is it in another unit?"
    );
    assert!(message(&icosphere(0.005, 1).placed(1e-3, Vec3::zeros())).contains("another unit"));
}

#[test]
fn what_is_not_finite_is_named() {
    let mut mesh = icosphere(0.005, 1);
    mesh.vertices[7].y = f64::NAN;
    assert!(
        message(&mesh).contains("vertex 7 is ("),
        "{}",
        message(&mesh)
    );
    mesh.vertices[7].y = 0.0;
    mesh.triangles[3][1] = 999;
    assert!(message(&mesh).contains("triangle 3 names vertex 999, expected one of 42"));
}

#[test]
fn inside_out_two_pieces_crowded_and_pinched_are_refused() {
    let ball = icosphere(0.005, 1);
    let mut inward = ball.clone();
    inward.triangles.iter_mut().for_each(|t| t.swap(0, 1));
    assert!(message(&inward).contains("enclosed volume of -"));

    let mut two = ball.clone();
    two.vertices
        .extend(ball.vertices.iter().map(|v| v + Vec3::new(0.02, 0.0, 0.0)));
    two.triangles
        .extend(ball.triangles.iter().map(|t| t.map(|v| v + 42)));
    assert!(message(&two).contains("2 separate pieces"));

    // The same two balls, sharing one vertex.
    let mut pinched = two.clone();
    pinched
        .triangles
        .iter_mut()
        .flatten()
        .filter(|v| **v == 42)
        .for_each(|v| *v = 0);
    assert!(message(&pinched).contains("1 vertices where the surface touches itself"));

    let mut crowded = ball.clone();
    crowded.triangles.push(ball.triangles[0]);
    assert!(message(&crowded).contains("3 edges shared by more than two"));
    assert!(message(&TriMesh::default()).contains("no triangle"));
}
