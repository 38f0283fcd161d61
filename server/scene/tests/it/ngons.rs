//! Faces with many corners are filled as drawn, or refused. A surface that folds onto itself has no tree.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use proptest::prelude::*;
use sulcus_core::Vec3;
use sulcus_core::math::exp_rotation;
use sulcus_scene::mesh::TriMesh;
use sulcus_scene::mesh::check::{MeshReport, check};
use sulcus_scene::mesh::load::{Unit, load_mesh, parse_mesh};
use sulcus_scene::mesh::repair::repair;
use sulcus_scene::read_solid;
use sulcus_scene::tree::build::{TreeBuildError, TreeOptions, build_tree};
use sulcus_scene::tree::filled::filled;

/// Returns a file of `tests/inputs`.
pub(crate) fn input(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../tests/inputs")
        .join(name)
}

/// Vertices (mm) and faces.
#[derive(Clone)]
struct Faces {
    vertices: Vec<Vec3>,
    faces: Vec<Vec<usize>>,
}

impl Faces {
    /// Returns a prism over a counter-clockwise polygon. Its lids are one face each, beginning at corner `start`.
    fn prism(polygon: &[[f64; 2]], height: f64, start: usize) -> Self {
        let n = polygon.len();
        let mut vertices: Vec<Vec3> = Vec::new();
        for z in [0.0, height] {
            vertices.extend(polygon.iter().map(|[x, y]| Vec3::new(*x, *y, z)));
        }
        let mut bottom: Vec<usize> = (0..n).rev().collect();
        let mut top: Vec<usize> = (n..2 * n).collect();
        bottom.rotate_left(start % n);
        top.rotate_left(start % n);
        let mut faces = vec![bottom, top];
        faces.extend((0..n).map(|k| vec![k, (k + 1) % n, n + (k + 1) % n, n + k]));
        Self { vertices, faces }
    }

    /// Returns the same faces, turned by a rotation vector and moved.
    fn placed(mut self, turn: Vec3, by: Vec3) -> Self {
        let turn = exp_rotation(&turn);
        for v in &mut self.vertices {
            *v = turn * *v + by;
        }
        self
    }

    fn obj(&self) -> Vec<u8> {
        let mut text = String::new();
        for v in &self.vertices {
            let _ = writeln!(text, "v {} {} {}", v.x, v.y, v.z);
        }
        for face in &self.faces {
            text.push('f');
            for v in face {
                let _ = write!(text, " {}", v + 1);
            }
            text.push('\n');
        }
        text.into_bytes()
    }

    /// Returns a PLY file: `a`scii, `l`ittle or `b`ig endian.
    fn ply(&self, order: char) -> Vec<u8> {
        let format = match order {
            'a' => "ascii",
            'l' => "binary_little_endian",
            _ => "binary_big_endian",
        };
        let mut bytes = format!(
            "ply\nformat {format} 1.0\nelement vertex {}\nproperty double x\nproperty double y\nproperty double z\nelement face {}\nproperty list uchar int vertex_indices\nend_header\n",
            self.vertices.len(),
            self.faces.len()
        )
        .into_bytes();
        for v in &self.vertices {
            match order {
                'a' => bytes.extend(format!("{} {} {}\n", v.x, v.y, v.z).bytes()),
                'l' => bytes.extend(v.iter().flat_map(|x| x.to_le_bytes())),
                _ => bytes.extend(v.iter().flat_map(|x| x.to_be_bytes())),
            }
        }
        for face in &self.faces {
            if order == 'a' {
                bytes.extend(face.len().to_string().bytes());
                bytes.extend(face.iter().flat_map(|v| format!(" {v}").into_bytes()));
                bytes.push(b'\n');
                continue;
            }
            bytes.push(face.len() as u8);
            for &v in face {
                let v = v as i32;
                bytes.extend(if order == 'l' {
                    v.to_le_bytes()
                } else {
                    v.to_be_bytes()
                });
            }
        }
        bytes
    }
}

/// Area of a polygon, and its length.
fn measures(polygon: &[[f64; 2]]) -> (f64, f64) {
    let next = polygon.iter().cycle().skip(1);
    let each = polygon.iter().zip(next);
    each.fold((0.0, 0.0), |(area, length), ([a, b], [c, d])| {
        (
            area + 0.5 * (a * d - b * c),
            length + ((c - a).powi(2) + (d - b).powi(2)).sqrt(),
        )
    })
}

/// Returns a horseshoe with this number of corners.
fn horseshoe(corners: usize, inner: f64, outer: f64) -> Vec<[f64; 2]> {
    let half = corners / 2;
    let at = |k: usize, r: f64| {
        let angle = 0.3 + 5.6 * k as f64 / (half - 1) as f64;
        [r * angle.cos(), r * angle.sin()]
    };
    let out = (0..half).map(|k| at(k, outer));
    out.chain((0..half).rev().map(|k| at(k, inner))).collect()
}

/// Polygons whose fans from most corners are wrong.
fn polygons() -> Vec<(&'static str, Vec<[f64; 2]>)> {
    let star = |k: u32| {
        let (angle, r) = (
            0.31 * f64::from(k),
            if k.is_multiple_of(2) { 9.0 } else { 3.0 },
        );
        [r * angle.cos(), r * angle.sin()]
    };
    let mut comb = vec![[0.0, 0.0], [12.0, 0.0]];
    for k in (0..6).rev() {
        let x = 2.0 * f64::from(k);
        comb.extend([[x + 2.0, 8.0], [x + 1.0, 1.0]]);
    }
    comb.push([0.0, 8.0]);
    vec![
        ("a horseshoe", horseshoe(24, 12.0, 16.0)),
        ("a long horseshoe", horseshoe(64, 20.0, 25.0)),
        ("a star", (0..20).map(star).collect()),
        ("a comb", comb),
        (
            "a dart",
            vec![[0.0, 0.0], [8.0, -6.0], [3.0, 0.0], [8.0, 6.0]],
        ),
        (
            "a square with corners on its edges",
            vec![
                [0.0, 0.0],
                [4.0, 0.0],
                [8.0, 0.0],
                [8.0, 3.0],
                [8.0, 8.0],
                [2.0, 8.0],
                [1.0, 8.0],
                [0.0, 8.0],
                [0.0, 5.0],
            ],
        ),
        (
            "an L with a corner on an edge",
            vec![
                [0.0, 0.0],
                [5.0, 0.0],
                [9.0, 0.0],
                [9.0, 3.0],
                [3.0, 3.0],
                [3.0, 9.0],
                [0.0, 9.0],
            ],
        ),
        (
            "a quadrilateral with a corner on an edge",
            vec![[0.0, 0.0], [4.0, 0.0], [8.0, 0.0], [3.0, 7.0]],
        ),
    ]
}

fn parsed(bytes: Vec<u8>, name: &str) -> Result<TriMesh, String> {
    let loaded = parse_mesh(bytes, Path::new(name), Unit::Millimetre);
    loaded
        .map(|loaded| loaded.mesh)
        .map_err(|error| error.to_string())
}

/// The report of a closed mesh that needed no repair.
fn whole(mesh: TriMesh, name: &str) -> MeshReport {
    let (mesh, repairs) = repair(mesh);
    assert!(repairs.is_empty(), "{name}: {repairs}");
    check(&mesh, name).expect("a solid")
}

#[test]
fn concave_lids_are_filled_as_drawn_from_any_corner_in_any_plane_and_format() {
    for (name, polygon) in polygons() {
        let (area, length) = measures(&polygon);
        let (volume, surface) = (5.0 * area, 2.0 * area + 5.0 * length);
        for start in 0..polygon.len() {
            let turn = Vec3::new(0.7, -1.1, 0.4) * start as f64;
            let faces = Faces::prism(&polygon, 5.0, start).placed(turn, Vec3::new(3.0, -8.0, 20.0));
            let files = [
                ("a.obj", faces.obj()),
                ("a.ply", faces.ply('a')),
                ("l.ply", faces.ply('l')),
                ("b.ply", faces.ply('b')),
            ];
            for (file, bytes) in files {
                let said = format!("{name} from {start} in {file}");
                let report = whole(parsed(bytes, file).expect(&said), &said);
                assert!(
                    (report.volume_mm3 / volume - 1.0).abs() < 1e-4,
                    "{said}: {report:?}"
                );
                // A fan has the right volume and too much surface.
                assert!(
                    (report.area_mm2 / surface - 1.0).abs() < 1e-4,
                    "{said}: {report:?}"
                );
                assert_eq!(report.triangles, 4 * polygon.len() - 4, "{said}");
            }
        }
    }
}

#[test]
fn convex_quadrilaterals_are_cut_from_their_first_corner_as_ever() {
    let faces = Faces::prism(&[[0.0, 0.0], [7.0, 0.0], [6.0, 5.0], [1.0, 6.0]], 4.0, 1);
    let mesh = parsed(faces.ply('l'), "a.ply").expect("a PLY file");
    let fans = faces.faces.iter().flat_map(|face| {
        let [a, b, c, d] = face[..] else {
            panic!("four corners")
        };
        [[a, b, c], [a, c, d]].map(|t| t.map(|v| v as u32))
    });
    assert_eq!(mesh.triangles, fans.collect::<Vec<_>>());
}

#[test]
fn faces_that_cross_touch_or_bend_are_refused_with_the_face_and_the_reason() {
    let good = Faces::prism(&horseshoe(16, 10.0, 14.0), 5.0, 3);
    let with = |face: &[usize], lift: Option<(usize, f64)>| {
        let mut faces = good.clone();
        faces.faces.insert(2, face.to_vec());
        if let Some((vertex, by)) = lift {
            faces.vertices[vertex].z += by;
        }
        let obj = parsed(faces.obj(), "a.obj").expect_err("refused");
        assert!(obj.contains("expected a flat face"), "{obj}");
        for order in ['a', 'l', 'b'] {
            let ply = parsed(faces.ply(order), "a.ply").expect_err("refused");
            assert!(
                ply.contains("in `face`") && ply.contains("expected a flat face"),
                "{ply}"
            );
        }
        obj
    };
    // 32 vertices: the third face is in line 35.
    let bow = with(&[0, 8, 1, 9], None);
    assert!(
        bow.contains("crosses or touches itself in line 35"),
        "{bow}"
    );
    let crossed = with(&[0, 1, 2, 6, 5, 3, 4], None);
    assert!(
        crossed.contains("crosses itself at the edge from corner")
            && crossed.contains("in line 35"),
        "{crossed}"
    );
    let twice = with(&[0, 1, 2, 3, 1], None);
    assert!(
        twice.contains("corners 2 and 5 are the same vertex in line 35"),
        "{twice}"
    );
    let twice = with(&[0, 1, 2, 2], None);
    assert!(
        twice.contains("corners 3 and 4 are the same vertex"),
        "{twice}"
    );
    // The first face has a corner 4 mm off the plane of the others, which are 28 mm across.
    let bent = with(&[0, 1, 2], Some((4, 4.0)));
    assert!(
        bent.contains("not flat")
            && bent.contains("% of the face's size off the best plane")
            && bent.contains("in line 33"),
        "{bent}"
    );
}

#[test]
fn a_face_that_touches_itself_or_has_two_corners_in_one_place_is_refused() {
    let refused = |points: &[[f64; 2]]| {
        let mut text = String::new();
        for [x, y] in points {
            let _ = writeln!(text, "v {x} {y} 1");
        }
        let _ = writeln!(
            text,
            "f {}",
            (1..=points.len())
                .map(|k| k.to_string())
                .collect::<Vec<_>>()
                .join(" ")
        );
        parsed(text.into_bytes(), "a.obj").expect_err("refused")
    };
    let said = refused(&[[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [2.0, 0.0], [0.0, 4.0]]);
    assert!(
        said.contains("touches itself at the edge from corner 1 to 2"),
        "{said}"
    );
    let said = refused(&[
        [0.0, 0.0],
        [4.0, 0.0],
        [4.0, 4.0],
        [2.0, 2.0],
        [0.0, 4.0],
        [2.0, 2.0],
    ]);
    assert!(said.contains("corners 4 and 6 are in one place"), "{said}");
    let said = refused(&[[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [3.0, 0.0], [4.0, 0.0]]);
    assert!(said.contains("without area"), "{said}");
    let said = refused(&[
        [0.0, 0.0],
        [1e300, 0.0],
        [1e300, 1e300],
        [0.0, 1e300],
        [-1.0, 5.0],
    ]);
    assert!(said.contains("a face"), "{said}");
}

#[test]
fn four_corners_on_a_line_fill_nothing_and_are_no_fault() {
    let text = "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 3 0 0\nf 1 2 3 4\n";
    assert_eq!(
        parsed(text.into(), "a.obj").expect("OBJ").triangles.len(),
        2
    );
}

#[test]
fn the_arches_with_faces_of_48_corners_are_the_arch_in_triangles() {
    for name in [
        "arch_tri.obj",
        "arch_ngon.obj",
        "arch_ngon_rot.obj",
        "arch_ngon.ply",
    ] {
        let solid = read_solid(&input("ngon").join(name), Unit::Millimetre).expect(name);
        assert!(solid.repairs.is_empty() && solid.notes.is_empty(), "{name}");
        let found = solid.report.volume_mm3;
        assert!((found - 8465.8).abs() < 0.1, "{name}: {found} mm3");
    }
}

/// The arch with its lids as fans: closed, of the right volume, folded.
fn folded() -> TriMesh {
    let arch = load_mesh(&input("ngon/arch_ngon.obj"), Unit::Millimetre)
        .expect("read")
        .mesh;
    let count = arch.vertices.len() as u32 / 2;
    // The walls are the faces with four corners, which are last; vertices are in the order of the lids.
    let walls = &arch.triangles[arch.triangles.len() - 2 * count as usize..];
    let mut triangles = Vec::new();
    for first in [0, count] {
        triangles.extend((2..count).map(|k| [first, first + k - 1, first + k]));
    }
    triangles.extend(walls);
    TriMesh {
        vertices: arch.vertices,
        triangles,
    }
}

#[test]
fn the_tree_of_a_surface_that_folds_onto_itself_is_refused_with_both_volumes() {
    let (mesh, _) = repair(folded());
    let report = check(&mesh, "folded").expect("closed, and of the right volume");
    assert!((report.volume_mm3 - 8465.8).abs() < 0.1, "{report:?}");
    for levels in [1, 2, 3] {
        let options = TreeOptions {
            levels,
            samples: 20_000,
            ..TreeOptions::default()
        };
        let error = build_tree(&mesh, &options, &|_, _| ()).expect_err("refused");
        let TreeBuildError::Volume {
            tree_mm3, mesh_mm3, ..
        } = error
        else {
            panic!("{error}")
        };
        assert!((mesh_mm3 - 8465.8).abs() < 0.1 && tree_mm3 > 2.0 * mesh_mm3);
        let said = error.to_string();
        assert!(
            said.contains("8465.79") && said.contains(" mm3") && said.contains('%'),
            "{said}"
        );
    }
}

#[test]
fn the_tree_of_the_arch_fills_its_volume() {
    let mesh = read_solid(&input("ngon/arch_ngon_rot.obj"), Unit::Millimetre)
        .expect("a solid")
        .mesh;
    let options = TreeOptions {
        levels: 3,
        ..TreeOptions::default()
    };
    let tree = build_tree(&mesh, &options, &|_, _| ()).expect("a tree");
    let share = filled(&tree) / mesh.signed_volume() - 1.0;
    assert!(share.abs() < 0.01, "{share}");
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn polygons_seen_from_a_point_keep_their_area(
        radii in proptest::collection::vec(1.0_f64..20.0, 3..60),
        turn in (-3.0_f64..3.0, -3.0_f64..3.0, -3.0_f64..3.0),
        start in 0_usize..60,
    ) {
        let n = radii.len() as f64;
        let corner = |(k, r): (usize, &f64)| {
            let angle = std::f64::consts::TAU * k as f64 / n;
            [r * angle.cos(), r * angle.sin()]
        };
        let polygon: Vec<[f64; 2]> = radii.iter().enumerate().map(corner).collect();
        let (area, _) = measures(&polygon);
        let faces = Faces::prism(&polygon, 5.0, start).placed(Vec3::new(turn.0, turn.1, turn.2), Vec3::zeros());
        let mesh = parsed(faces.obj(), "a.obj").expect("simple polygons");
        let (mesh, _) = repair(mesh);
        let report = check(&mesh, "prism").expect("closed");
        prop_assert!((report.volume_mm3 / (5.0 * area) - 1.0).abs() < 1e-3, "{:?}", report);
        let lids: f64 = (0..2 * (polygon.len() - 2)).map(|t| 0.5e6 * mesh.area_vector(t).norm()).sum();
        prop_assert!((lids / (2.0 * area) - 1.0).abs() < 1e-6, "{} {}", lids, area);
    }

    #[test]
    fn any_face_is_filled_or_refused_and_never_a_panic(
        places in proptest::collection::vec((-4_i32..5, -4_i32..5, -1_i32..2), 3..12),
        wild in proptest::option::of((0_usize..12, 0_usize..6)),
        corners in proptest::collection::vec(0_usize..12, 3..20),
    ) {
        let mut text = String::new();
        for (k, (x, y, z)) in places.iter().enumerate() {
            let numbers = ["nan", "inf", "1e308", "-1e200", "1e-300", "5e-324"];
            match wild {
                Some((at, number)) if at == k => { let _ = writeln!(text, "v {} {y} {z}", numbers[number]); }
                _ => { let _ = writeln!(text, "v {x} {y} {}", 0.01 * f64::from(*z)); }
            }
        }
        text.push('f');
        for corner in &corners {
            let _ = write!(text, " {}", corner % places.len() + 1);
        }
        match parsed(text.into_bytes(), "a.obj") {
            Ok(mesh) => prop_assert_eq!(mesh.triangles.len(), corners.len() - 2),
            Err(said) => prop_assert!(said.contains("in line") && said.contains("expected a flat face"), "{}", said),
        }
    }
}
