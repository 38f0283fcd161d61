//! Meshes that are not solids are refused, with numbers and places.

use sulcus_core::Vec3;
use sulcus_scene::mesh::TriMesh;
use sulcus_scene::mesh::check::check;
use sulcus_scene::mesh::load::{Unit, to_stl};
use sulcus_scene::mesh::shapes::{cuboid, icosphere};
use sulcus_scene::read_solid;

fn message(mesh: &TriMesh) -> String {
    check(mesh, "tooth.stl").expect_err("broken").to_string()
}

/// Message about a file with this mesh.
fn told(mesh: &TriMesh, unit: Unit) -> String {
    let dir = tempfile::tempdir().expect("temporary directory");
    let file = dir.path().join("tooth.stl");
    std::fs::write(&file, to_stl(mesh)).expect("written");
    let said = read_solid(&file, unit).expect_err("refused").to_string();
    let place = dir.path().display().to_string();
    assert!(said.starts_with(&place) && !said.contains('\n'), "{said}");
    said[place.len() + 1..].to_owned()
}

/// Returns both meshes as one.
fn beside(a: &TriMesh, b: &TriMesh) -> TriMesh {
    let mut both = a.clone();
    let first = both.vertices.len() as u32;
    both.vertices.extend(&b.vertices);
    both.triangles
        .extend(b.triangles.iter().map(|t| t.map(|v| v + first)));
    both
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
fn large_holes_are_counted_measured_and_placed() {
    // Two lids are missing: all triangles above z = 3 mm, and all below z = -4 mm.
    let mut mesh = icosphere(0.005, 4);
    let vertices = mesh.vertices.clone();
    mesh.triangles.retain(|t| {
        let z = t.map(|v| vertices[v as usize].z);
        z.iter().all(|z| *z <= 3e-3) && z.iter().all(|z| *z >= -4e-3)
    });
    let said = told(&mesh, Unit::Millimetre);
    assert!(said.starts_with("tooth.stl: found "), "{said}");
    assert!(said.contains(" open edges in 2 holes ("), "{said}");
    assert!(
        said.ends_with(
            "expected a closed surface without holes (of those in files, small ones up to 5 % of the size are closed on reading)"
        ),
        "{said}"
    );
    let sulcus_scene::mesh::check::MeshError::Open {
        edges, openings, ..
    } = check(&mesh, "x").expect_err("open")
    else {
        panic!("not open")
    };
    assert_eq!(edges, openings[0].edges + openings[1].edges);
    for (opening, (z, radius)) in openings.iter().zip([(3.0, 4.0), (-4.0, 3.0)]) {
        assert!(
            (opening.diameter_mm - 2.0 * radius).abs() < 0.6,
            "{opening}"
        );
        let [x, y, found] = opening.at_mm;
        assert!(x.abs() < 0.1 && y.abs() < 0.1, "{opening}");
        assert!((found - z).abs() < 0.2, "{opening}");
    }
}

#[test]
fn a_flipped_face_is_counted_and_placed() {
    let mut mesh = icosphere(0.005, 2);
    mesh.triangles[17].swap(0, 1);
    let said = message(&mesh);
    assert!(
        said.contains("3 edges whose two triangles face opposite ways"),
        "{said}"
    );
    assert!(said.contains("the first at ("), "{said}");
    assert!(
        said.ends_with("mm, expected all triangles to face outwards"),
        "{said}"
    );
}

#[test]
fn a_surface_that_cannot_be_oriented_is_refused() {
    // The projective plane with six vertices: closed, one-sided.
    let one_sided = TriMesh {
        vertices: (0..6)
            .map(|k| Vec3::new(f64::from(k), f64::from(k * k), f64::from(k * k * k)) * 1e-4)
            .collect(),
        triangles: vec![
            [0, 1, 2],
            [0, 2, 3],
            [0, 3, 4],
            [0, 4, 5],
            [0, 5, 1],
            [1, 2, 4],
            [2, 3, 5],
            [3, 4, 1],
            [4, 5, 2],
            [5, 1, 3],
        ],
    };
    let said = told(&one_sided, Unit::Millimetre);
    assert!(
        said.contains("edges whose two triangles face opposite ways"),
        "{said}"
    );
}

#[test]
fn a_wrong_unit_is_computed_and_named() {
    let ball = icosphere(0.005, 1);
    let size = ball.bounds().1.x * 2e3;
    let metres_for_mm = ball.clone().placed(1e-3, Vec3::zeros());
    let said = told(&metres_for_mm, Unit::Millimetre);
    assert!(
        said.starts_with("tooth.stl: found an overall size of 0.01 mm, expected 4 to 300 mm for any object in a mouth"),
        "{said}"
    );
    assert!(
        said.contains(&format!("in metres it would be {size} mm")),
        "{said}"
    );
    assert!(
        said.contains("`unit = \"m\"` in a scene file or `--unit m` on the command line"),
        "{said}"
    );
    let said = told(&ball, Unit::Metre);
    assert!(said.contains("found an overall size of 10000 mm"), "{said}");
    assert!(said.contains("in millimetres it would be 10 mm"), "{said}");
    assert!(said.contains("`--unit mm`"), "{said}");
    // No unit makes sense: the message about micrometres read as millimetres must not recommend mm.
    let said = told(&ball.clone().placed(1e3, Vec3::zeros()), Unit::Millimetre);
    assert!(
        said.contains("neither millimetres, metres nor inches gives a plausible size (it was read in millimetres)"),
        "{said}"
    );
    // A mesh that is not from a file.
    assert!(message(&ball.placed(1e3, Vec3::zeros())).contains("`--unit mm`"));
}

#[test]
fn what_is_not_finite_or_not_there_is_named() {
    let mut mesh = icosphere(0.005, 1);
    mesh.vertices[7].y = f64::NAN;
    assert!(
        message(&mesh).contains("vertex 7 is ("),
        "{}",
        message(&mesh)
    );
    assert!(told(&mesh, Unit::Millimetre).contains("NaN"));
    mesh.vertices[7].y = f64::INFINITY;
    assert!(told(&mesh, Unit::Millimetre).contains("inf"));
    mesh.vertices[7].y = 0.0;
    mesh.triangles[3][1] = 999;
    assert!(message(&mesh).contains("triangle 3 names vertex 999, expected one of 42"));
}

#[test]
fn nothing_is_refused() {
    assert!(message(&TriMesh::default()).contains("found no triangle"));
    assert!(told(&TriMesh::default(), Unit::Metre).contains("found no triangle"));
}

#[test]
fn two_shells_are_refused_with_the_size_of_each() {
    let ball = icosphere(0.005, 2);
    let small = icosphere(0.001, 1).placed(1.0, Vec3::new(0.02, 0.0, 0.0));
    let said = told(&beside(&small, &ball), Unit::Millimetre);
    let (high, low) = (ball.bounds().1.x * 1e3, small.bounds().0 * 1e3);
    assert!(
        said.contains("found 2 separate pieces (320 triangles between (-"),
        "{said}"
    );
    assert!(
        said.contains(&format!(
            "({high}, {high}, {high}) mm; 80 triangles between ({:.0}, ",
            low.x
        )),
        "{said}"
    );
    assert!(said.contains("expected one (`--keep-largest`"), "{said}");
}

#[test]
fn inside_out_crowded_pinched_and_flat_are_refused_with_the_place() {
    let ball = icosphere(0.005, 1);
    let mut inward = ball.clone();
    inward.triangles.iter_mut().for_each(|t| t.swap(0, 1));
    let said = message(&inward);
    assert!(
        said.contains("enclosed volume of -") && said.contains("between (-5, "),
        "{said}"
    );

    // Two balls that share one vertex.
    let mut pinched = beside(&ball, &ball.clone().placed(1.0, Vec3::new(0.02, 0.0, 0.0)));
    pinched
        .triangles
        .iter_mut()
        .flatten()
        .filter(|v| **v == 42)
        .for_each(|v| *v = 0);
    let at = ball.vertices[0] * 1e3;
    let place = format!("the first at ({:.3}, {:.3}, {}) mm", at.x, at.y, at.z);
    let said = message(&pinched);
    assert!(
        said.contains("1 vertex where the surface touches itself") && said.contains(&place),
        "{said}"
    );

    // Two boxes that share an edge at x = y = 1 mm.
    let cube = cuboid(Vec3::repeat(1e-3));
    let edge = beside(&cube, &cube.clone().placed(1.0, Vec3::new(2e-3, 2e-3, 0.0)));
    let said = told(&edge, Unit::Millimetre);
    assert!(
        said.contains(
            "1 edge shared by more than two triangles (non-manifold), the first at (1, 1, 0) mm"
        ),
        "{said}"
    );

    let flat = told(&cuboid(Vec3::new(5e-3, 5e-3, 1e-15)), Unit::Millimetre);
    assert!(
        flat.contains("mm3 between (-5, -5, 0) and (5, 5, 0) mm, which is flat"),
        "{flat}"
    );
}

#[test]
fn every_mesh_of_the_data_needs_no_repair() {
    let Some(dir) = sulcus_support::data("meshes") else {
        return;
    };
    let mut read = 0;
    for file in std::fs::read_dir(&dir).expect("a folder") {
        let file = file.expect("entry").path();
        if file.extension().is_some_and(|extension| extension == "stl") {
            let loaded = sulcus_scene::mesh::load::load_mesh(&file, Unit::Millimetre)
                .expect("readable")
                .mesh;
            match read_solid(&file, Unit::Millimetre) {
                Ok(solid) => {
                    assert!(
                        solid.repairs.is_empty(),
                        "{}: {}",
                        file.display(),
                        solid.repairs
                    );
                    assert_eq!(solid.mesh, loaded, "{}", file.display());
                }
                Err(error) => panic!("{error}"),
            }
            read += 1;
        }
    }
    assert!(read > 0, "{} holds no mesh", dir.display());
}
