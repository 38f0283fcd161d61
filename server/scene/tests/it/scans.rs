//! Scans: small pieces are dropped and an open base is closed on request. Impossible requests are refused by name.

use std::path::Path;

use sulcus_core::Vec3;
use sulcus_core::math::exp_rotation;
use sulcus_scene::mesh::TriMesh;
use sulcus_scene::mesh::check::{MeshError, check};
use sulcus_scene::mesh::load::{Unit, to_stl};
use sulcus_scene::mesh::repair::{Asked, repair, repair_as};
use sulcus_scene::mesh::shapes::{cuboid, icosphere};
use sulcus_scene::mesh::solid::{Reading, Solid, SolidError, read_solid};

use crate::ngons::input;

const LARGEST: Asked = Asked {
    keep_largest: true,
    close_base: false,
};
const BASE: Asked = Asked {
    keep_largest: false,
    close_base: true,
};

fn read(name: &str, asked: Asked) -> Result<Solid, SolidError> {
    let reading = Reading {
        asked,
        ..Unit::Millimetre.into()
    };
    read_solid(&input("scan").join(name), reading)
}

#[test]
fn a_crumb_and_a_second_tooth_are_refused_unless_the_largest_piece_is_asked_for() {
    for (name, pieces) in [("tooth_with_crumb.stl", 2), ("two_teeth.stl", 2)] {
        let said = read(name, Asked::default())
            .expect_err("pieces")
            .to_string();
        assert!(
            said.contains(&format!("{pieces} separate pieces")) && said.contains("--keep-largest"),
            "{said}"
        );
        let solid = read(name, LARGEST).expect(name);
        let dropped = solid.repairs.dropped.clone().expect("dropped");
        assert_eq!(
            (dropped.pieces, dropped.kept_triangles),
            (pieces - 1, solid.report.triangles)
        );
        let said = solid.repairs.to_string();
        assert!(
            said.contains(&format!("{} triangles", dropped.triangles))
                && said.contains("were kept"),
            "{said}"
        );
    }
    let tooth = read("tooth_with_crumb.stl", LARGEST).expect("a tooth");
    assert_eq!(tooth.repairs.dropped.expect("dropped").triangles, 4);
    // Of equal pieces the first is kept.
    let first = read("two_teeth.stl", LARGEST).expect("a tooth");
    let bytes = std::fs::read(input("scan/two_teeth.stl")).expect("read");
    let corner = |at: usize| f32::from_le_bytes(bytes[at..at + 4].try_into().expect("four bytes"));
    let place = Vec3::new(corner(96).into(), corner(100).into(), corner(104).into()) * 1e-3;
    assert!(
        first
            .mesh
            .vertices
            .iter()
            .any(|v| (v - place).norm() < 1e-9)
    );
}

#[test]
fn a_piece_is_chosen_by_its_area_and_what_touches_it_in_a_vertex_is_another() {
    // Fewer triangles, more area.
    let large = cuboid(Vec3::repeat(0.005));
    let small = icosphere(0.001, 2).placed(1.0, Vec3::new(0.02, 0.0, 0.0));
    let both = beside(&small, &large);
    let (mesh, repairs) = repair_as(both, &LARGEST);
    let dropped = repairs.dropped.expect("dropped");
    assert_eq!(
        (dropped.pieces, dropped.triangles, mesh.triangles.len()),
        (1, 320, 12)
    );
    assert!(
        (dropped.largest_mm - 2.0).abs() < 0.01 && (dropped.kept_area_mm2 - 600.0).abs() < 1e-6
    );
    check(&mesh, "box").expect("a solid");

    let mut touching = beside(
        &large,
        &cuboid(Vec3::repeat(0.001)).placed(1.0, Vec3::repeat(0.006)),
    );
    let at = |p: f64| {
        let place = Vec3::repeat(p);
        move |v: &Vec3| (v - place).norm() < 1e-9
    };
    let corner = touching
        .vertices
        .iter()
        .position(at(0.005))
        .expect("a corner") as u32;
    let same = touching
        .vertices
        .iter()
        .rposition(at(0.005))
        .expect("a corner") as u32;
    for v in touching.triangles.iter_mut().flatten() {
        *v = if *v == same { corner } else { *v };
    }
    assert!(check(&repair(touching.clone()).0, "x").is_err());
    let (mesh, _) = repair_as(touching, &LARGEST);
    check(&mesh, "box").expect("a solid");

    let (mesh, repairs) = repair_as(large.clone(), &LARGEST);
    assert!(repairs.is_empty() && mesh == large);
}

#[test]
fn an_open_crown_is_refused_unless_its_base_is_to_be_closed() {
    let said = read("crown_open.stl", Asked::default())
        .expect_err("open")
        .to_string();
    assert!(
        said.contains("open edges in 1 hole") && said.contains("--close-base"),
        "{said}"
    );
    let solid = read("crown_open.stl", BASE).expect("closed");
    let base = solid.repairs.base.clone().expect("a base");
    assert!(base.area_mm2 > 1.0 && base.corners > 8, "{base}");
    let said = solid.repairs.to_string();
    assert!(
        said.contains(&format!(
            "a rim of {} corners, {} mm2",
            base.corners, base.area_mm2
        )),
        "{said}"
    );
}

#[test]
fn a_base_is_closed_in_any_place_also_concave_also_bent_a_little() {
    let turn = exp_rotation(&Vec3::new(0.9, -0.4, 1.7));
    for (name, bend) in [("flat", 0.0), ("bent", 0.6e-3)] {
        let (mut mesh, volume) = open_arch(bend);
        let high = |t: &[u32; 3]| t.iter().all(|&v| mesh.vertices[v as usize].z > 2e-3);
        let missing = mesh.triangles.iter().position(high).expect("a lid");
        mesh.triangles.swap_remove(missing);
        for v in &mut mesh.vertices {
            *v = turn * *v + Vec3::new(0.01, 0.02, -0.03);
        }
        assert!(matches!(
            check(&repair(mesh.clone()).0, "x"),
            Err(MeshError::Open { .. })
        ));
        let (mesh, repairs) = repair_as(mesh, &BASE);
        let base = repairs.base.clone().expect(name);
        assert_eq!(
            (base.corners, repairs.holes.len()),
            (96, 1),
            "{name}: {repairs}"
        );
        let report = check(&mesh, name).expect("a solid");
        assert!(
            (report.volume_mm3 / volume - 1.0).abs() < 0.03,
            "{name}: {report:?}, {volume} mm3"
        );
        assert!((base.off_plane_mm > 0.1) == (bend > 0.0), "{base}");
    }
}

#[test]
fn a_jagged_rim_gets_a_lid_without_crowded_edges() {
    // A tube of twelve sides with a tooth on each, leaning outwards.
    //
    // The triangle of the lid above a tooth shares the tooth's foot, an edge with two triangles.
    let n = 12_u32;
    let at = |k: f64, r: f64, z: f64| {
        let angle = std::f64::consts::TAU * k / f64::from(n);
        Vec3::new(r * angle.cos(), r * angle.sin(), z) * 1e-3
    };
    let mut mesh = TriMesh::default();
    for z in [0.0, 5.0] {
        mesh.vertices
            .extend((0..n).map(|k| at(f64::from(k), 4.0, z)));
    }
    mesh.vertices
        .extend((0..n).map(|k| at(f64::from(k) + 0.5, 4.1, 5.5)));
    for k in 0..n {
        let next = (k + 1) % n;
        mesh.triangles.extend([
            [k, next, n + next],
            [k, n + next, n + k],
            [n + k, n + next, 2 * n + k],
        ]);
    }
    mesh.triangles.extend((2..n).map(|k| [0, k, k - 1]));
    let before = mesh.vertices.len();
    let (closed, repairs) = repair_as(mesh, &BASE);
    let base = repairs.base.clone().expect("a base");
    assert_eq!(base.corners, 24, "{repairs}");
    assert_eq!(closed.vertices.len(), before + 12);
    let report = check(&closed, "tube").expect("a solid");
    let area = 0.5 * 12.0 * 16.0 * (std::f64::consts::TAU / 12.0).sin();
    assert!(
        (report.volume_mm3 / (5.0 * area) - 1.0).abs() < 0.06,
        "{report:?}"
    );
}

#[test]
fn two_openings_and_a_rim_that_is_far_from_flat_are_refused_by_name() {
    let dir = tempfile::tempdir().expect("a folder");
    let told = |mesh: &TriMesh| {
        let file = dir.path().join("scan.stl");
        std::fs::write(&file, to_stl(mesh)).expect("written");
        let reading = Reading {
            asked: BASE,
            ..Unit::Millimetre.into()
        };
        let error = read_solid(&file, reading).expect_err("refused");
        assert!(matches!(error, SolidError::Base { .. }), "{error}");
        error.to_string()
    };
    let without = |keep: &dyn Fn(Vec3) -> bool| {
        let mut mesh = icosphere(0.005, 4);
        let vertices = mesh.vertices.clone();
        mesh.triangles
            .retain(|t| t.iter().all(|&v| keep(vertices[v as usize])));
        mesh
    };
    let said = told(&without(&|v| v.z < 3e-3 && v.z > -4e-3));
    assert!(
        said.contains("cannot close the base: found") && said.contains("in 2 loops"),
        "{said}"
    );
    // A rim like a saddle.
    let said = told(&without(&|v| v.z < 300.0 * (v.x * v.x - v.y * v.y)));
    assert!(
        said.contains("not flat") && said.contains("best plane"),
        "{said}"
    );

    let file = dir.path().join("whole.stl");
    std::fs::write(&file, to_stl(&icosphere(0.005, 2))).expect("written");
    let reading = Reading {
        asked: Asked {
            keep_largest: true,
            close_base: true,
        },
        ..Unit::Millimetre.into()
    };
    let solid = read_solid(&file, reading).expect("a ball");
    assert!(solid.repairs.is_empty());
    assert_eq!(solid.notes.len(), 2, "{:?}", solid.notes);
}

#[test]
fn an_edge_with_three_triangles_is_called_that_and_not_a_hole() {
    for asked in [Asked::default(), LARGEST, BASE] {
        let said = read("fin.stl", asked).expect_err("a fin").to_string();
        assert!(
            said.contains(
                "1 edge shared by more than two triangles (non-manifold), the first at ("
            ),
            "{said}"
        );
        assert!(!said.contains("hole"), "{said}");
    }
    // Fins of several triangles on another solid.
    let mut mesh = cuboid(Vec3::new(0.004, 0.003, 0.002));
    let [a, b, _] = mesh.triangles[0];
    let middle = (mesh.vertices[a as usize] + mesh.vertices[b as usize]) * 0.5;
    mesh.vertices.extend([middle * 2.0, middle * 2.5]);
    mesh.triangles.extend([[a, b, 8], [a, 8, 9]]);
    let said = check(&repair(mesh).0, "x.stl")
        .expect_err("a fin")
        .to_string();
    let at = (middle * 1e3).map(|x| x + 0.0);
    assert!(
        said.contains(&format!("the first at ({}, {}, {}) mm", at.x, at.y, at.z)),
        "{said}"
    );
}

fn beside(a: &TriMesh, b: &TriMesh) -> TriMesh {
    let mut both = a.clone();
    let first = both.vertices.len() as u32;
    both.vertices.extend(&b.vertices);
    both.triangles
        .extend(b.triangles.iter().map(|t| t.map(|v| v + first)));
    both
}

/// The arch of the inputs without its bottom; its rim rises and falls by `bend` (metres). Volume, mm3.
fn open_arch(bend: f64) -> (TriMesh, f64) {
    let arch =
        read_solid(Path::new(&input("ngon/arch_ngon.obj")), Unit::Millimetre).expect("an arch");
    let mut mesh = arch.mesh;
    let low = |v: &Vec3| v.z < 1e-6;
    let vertices = mesh.vertices.clone();
    mesh.triangles
        .retain(|t| !t.iter().all(|&v| low(&vertices[v as usize])));
    // Twice as many corners, so that a triangle can be left out beside the rim.
    let mut finer = TriMesh {
        vertices: mesh.vertices.clone(),
        triangles: Vec::new(),
    };
    let mut middles = std::collections::BTreeMap::new();
    for &[a, b, c] in &mesh.triangles {
        let mut middle = |a: u32, b: u32| {
            *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                finer
                    .vertices
                    .push((vertices[a as usize] + vertices[b as usize]) * 0.5);
                finer.vertices.len() as u32 - 1
            })
        };
        let [x, y, z] = [middle(a, b), middle(b, c), middle(c, a)];
        finer
            .triangles
            .extend([[x, y, z], [a, x, z], [b, y, x], [c, z, y]]);
    }
    for v in finer.vertices.iter_mut().filter(|v| low(v)) {
        v.z += bend * (v.x * 300.0).sin();
    }
    (finer, arch.report.volume_mm3)
}
