//! No mesh causes a panic: random triangles, and closed surfaces that are as thin as paper, cross themselves or have
//! triangles without area.

use proptest::prelude::*;
use sulcus_core::Vec3;
use sulcus_scene::mesh::TriMesh;
use sulcus_scene::mesh::check::check;
use sulcus_scene::mesh::load::{Unit, parse_mesh, to_stl};
use sulcus_scene::mesh::repair::repair;
use sulcus_scene::mesh::shapes::{cuboid, icosphere};
use sulcus_scene::tree::build::{TreeBuildError, TreeOptions, build_tree};

/// Builds a small tree. The test is that it does not panic, and that a built tree is whole.
fn build(mesh: &TriMesh, samples: usize) {
    let options = TreeOptions {
        levels: 2,
        samples,
        ..TreeOptions::default()
    };
    let tree = match build_tree(mesh, &options, &|_, _| ()) {
        Ok(tree) => tree,
        // Closed and not flat, but rounding hides its inside.
        Err(TreeBuildError::TooThin) => return,
        // A surface that crosses itself, or is too thin for so few spheres.
        Err(TreeBuildError::Volume { .. }) => return,
        Err(error) => panic!("a tree for what passed the check: {error}"),
    };
    for node in tree.nodes() {
        assert!(node.centre.iter().all(|x| x.is_finite()) && node.contact_radius.is_finite());
    }
}

/// Repairs, checks and, if the mesh passes, builds. Returns whether it was a solid.
fn survive(mesh: TriMesh, samples: usize) -> bool {
    let (mesh, repairs) = repair(mesh);
    assert_eq!(repairs.is_empty(), repairs.sentences().is_empty());
    match check(&mesh, "soup") {
        Ok(_) => {
            build(&mesh, samples);
            true
        }
        Err(error) => {
            let said = error.to_string();
            assert!(said.starts_with("soup: ") && !said.contains('\n'), "{said}");
            assert!(said.len() < 1000, "{said}");
            false
        }
    }
}

/// Coordinates that often coincide, nearly coincide or are not numbers.
fn coordinate() -> impl Strategy<Value = f64> {
    prop_oneof![
        8 => (-3_i32..4).prop_map(|k| f64::from(k) * 2e-3),
        4 => -0.01_f64..0.01,
        2 => (-3_i32..4, -1e-8_f64..1e-8).prop_map(|(k, off)| f64::from(k) * 2e-3 + off),
    ]
}

fn vertex() -> impl Strategy<Value = Vec3> {
    (coordinate(), coordinate(), coordinate()).prop_map(|(x, y, z)| Vec3::new(x, y, z))
}

fn soup() -> impl Strategy<Value = TriMesh> {
    (3_usize..40).prop_flat_map(|count| {
        let vertices = proptest::collection::vec(vertex(), count);
        let index = 0..count as u32;
        let triangle = (index.clone(), index.clone(), index).prop_map(|(a, b, c)| [a, b, c]);
        (vertices, proptest::collection::vec(triangle, 0..160)).prop_map(|(vertices, triangles)| {
            TriMesh {
                vertices,
                triangles,
            }
        })
    })
}

/// A closed surface with faults: a ball whose vertices were moved, most of them flattened.
fn ugly() -> impl Strategy<Value = TriMesh> {
    let scale = || {
        prop_oneof![
            3 => 1e-4_f64..20e-3,
            1 => Just(1e-9),
            1 => Just(1e-6),
            1 => Just(20e-3),
        ]
    };
    (
        0_u32..3,
        (scale(), scale(), scale()),
        proptest::collection::vec((any::<prop::sample::Index>(), vertex()), 0..30),
        proptest::collection::vec(
            (any::<prop::sample::Index>(), any::<prop::sample::Index>()),
            0..30,
        ),
        (-0.1_f64..0.1, -0.1_f64..0.1),
    )
        .prop_map(|(cuts, (x, y, z), moved, swapped, (dx, dy))| {
            let mut mesh = icosphere(1.0, cuts);
            let count = mesh.vertices.len();
            for vertex in &mut mesh.vertices {
                vertex.component_mul_assign(&Vec3::new(x, y, z));
            }
            for (at, place) in moved {
                mesh.vertices[at.index(count)] = place;
            }
            // Crosses itself in every way.
            for (one, other) in swapped {
                mesh.vertices.swap(one.index(count), other.index(count));
            }
            mesh.placed(1.0, Vec3::new(dx, dy, 0.0))
        })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn heaps_of_random_triangles_never_panic(mesh in soup(), samples in 500_usize..1000) {
        // Unchanged, as a file, and unrepaired.
        let _ = check(&mesh, "soup");
        let bytes = to_stl(&mesh);
        survive(mesh, samples);
        let read = parse_mesh(bytes, std::path::Path::new("soup.stl"), Unit::Millimetre);
        survive(read.expect("STL").mesh, samples);
    }

    #[test]
    fn heaps_with_wild_numbers_never_panic(
        mesh in soup(),
        wild in proptest::collection::vec((any::<prop::sample::Index>(), 0_usize..3, 0_usize..8), 1..5),
        index in proptest::option::of(any::<u32>()),
    ) {
        let mut mesh = mesh;
        let numbers = [f64::NAN, f64::INFINITY, -f64::INFINITY, 1e308, -1e160, 5e-324, -0.0, 1e-160];
        for (at, axis, number) in wild {
            let at = at.index(mesh.vertices.len());
            mesh.vertices[at][axis] = numbers[number];
        }
        if let (Some(index), Some(triangle)) = (index, mesh.triangles.first_mut()) {
            triangle[1] = index;
        }
        let _ = check(&mesh, "soup");
        survive(mesh, 500);
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 32, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn closed_but_ugly_surfaces_never_panic(mesh in ugly(), samples in 500_usize..1000) {
        survive(mesh, samples);
    }

    #[test]
    fn surfaces_full_of_holes_never_panic(
        cuts in 2_u32..5,
        removed in proptest::collection::vec(any::<prop::sample::Index>(), 0..60),
        turned in proptest::collection::vec(any::<prop::sample::Index>(), 0..200),
        samples in 500_usize..1000,
    ) {
        let mut mesh = icosphere(0.004, cuts);
        for at in turned {
            let at = at.index(mesh.triangles.len());
            mesh.triangles[at].swap(0, 1);
        }
        for at in removed {
            // Some beside each other.
            let at = at.index(mesh.triangles.len());
            mesh.triangles.drain(at..(at + 1 + at % 3).min(mesh.triangles.len()));
        }
        survive(mesh, samples);
    }
}

/// Cuts the edges of a mesh in points that lie exactly on them: triangles without area.
fn with_caps(mesh: &TriMesh) -> TriMesh {
    let mut cut = mesh.clone();
    let [a, b, c] = cut.triangles[0];
    let middle = cut.vertices.len() as u32;
    let place = (cut.vertices[a as usize] + cut.vertices[b as usize]) * 0.5;
    cut.vertices.push(place);
    cut.triangles[0] = [a, middle, c];
    // The last one has three corners on one line.
    cut.triangles.extend([[middle, b, c], [a, b, middle]]);
    cut
}

#[test]
fn needles_caps_and_crossings_give_trees() {
    let tetrahedron = |height: f64| TriMesh {
        vertices: vec![
            Vec3::zeros(),
            Vec3::new(4e-3, 0.0, 0.0),
            Vec3::new(0.0, 4e-3, 0.0),
            Vec3::new(1e-3, 1e-3, height),
        ],
        triangles: vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]],
    };
    let mut crossed = icosphere(4e-3, 2);
    for vertex in crossed.vertices.iter_mut().step_by(5) {
        // Through the middle to the other side.
        *vertex *= -0.3;
    }
    let far = icosphere(2e-3, 2).placed(1.0, Vec3::new(100.0, -70.0, 3.0));
    let solids = [
        ("a tetrahedron", tetrahedron(4e-3)),
        ("a flat tetrahedron", tetrahedron(1e-8)),
        ("a needle", cuboid(Vec3::new(50e-3, 10e-6, 10e-6))),
        ("a sheet", cuboid(Vec3::new(50e-3, 50e-3, 1e-6))),
        (
            "a needle with caps",
            with_caps(&cuboid(Vec3::new(50e-3, 10e-6, 10e-6))),
        ),
        ("caps", with_caps(&with_caps(&cuboid(Vec3::repeat(2e-3))))),
        ("a surface that crosses itself", crossed),
        ("the smallest", cuboid(Vec3::repeat(0.25e-3))),
        ("the largest", cuboid(Vec3::repeat(0.249))),
        ("far away", far),
    ];
    for (name, mesh) in solids {
        assert!(survive(mesh, 500), "{name} is a solid");
    }
    for (name, mesh) in [
        ("a tetrahedron of no height", tetrahedron(0.0)),
        ("one of nearly none", tetrahedron(1e-15)),
        ("a point", icosphere(0.0, 1)),
        ("a line", cuboid(Vec3::new(5e-3, 0.0, 0.0))),
        (
            "a sheet of no thickness",
            cuboid(Vec3::new(5e-3, 5e-3, 0.0)),
        ),
        (
            "two triangles back to back",
            TriMesh {
                triangles: vec![[0, 1, 2], [0, 2, 1]],
                ..tetrahedron(1.0)
            },
        ),
    ] {
        assert!(!survive(mesh, 500), "{name} is no solid");
    }
}
