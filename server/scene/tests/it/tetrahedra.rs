//! Tetrahedra for closed surfaces: valid meshes that follow the surface, keep their angles, and bear loads.

use std::collections::BTreeMap;

use sulcus_core::Vec3;
use sulcus_fem::{Elastic, Factored, TetMesh};
use sulcus_scene::anatomy::Tongue;
use sulcus_scene::mesh::TriMesh;
use sulcus_scene::mesh::check::check;
use sulcus_scene::mesh::distance::MeshDistance;
use sulcus_scene::mesh::shapes::{cuboid, icosphere};
use sulcus_scene::organ::tetrahedra::{TetraError, boundary, dihedral_angles, hold, tetrahedra};

/// Over all ways to be cut; see the lattice's own test.
const ANGLES: [f64; 2] = [10.5, 163.8];

/// Checks all that holds for any surface. Returns the mesh and its excess of volume over the surface, as a share.
fn filled(name: &str, surface: &TriMesh, size: f64) -> (TetMesh, f64) {
    let distance = MeshDistance::new(surface.clone());
    let started = std::time::Instant::now();
    let mesh = tetrahedra(&distance, size, &|_| ()).unwrap_or_else(|e| panic!("{name}: {e}"));
    let seconds = started.elapsed().as_secs_f64();
    mesh.validate().expect("a mesh");
    assert!(mesh.held.iter().flatten().all(|held| !held));
    assert_eq!(lonely_faces(&mesh), boundary(&mesh).triangles.len());
    check(&boundary(&mesh), name).expect("the boundary of a solid");
    let corners = boundary(&mesh).vertices;
    let off = corners.iter().map(|x| distance.signed(x).abs());
    let off: Vec<f64> = off.filter(|away| *away > 1e-9 * size).collect();
    assert!(
        off.iter().all(|away| *away < 0.35 * size),
        "{name}: {off:?}"
    );
    let [least, most] = dihedral_angles(&mesh);
    assert!(
        least > ANGLES[0] && most < ANGLES[1],
        "{name}: {least} to {most}"
    );
    let more = mesh.volume() / surface.signed_volume() - 1.0;
    println!(
        "{name} {:.2} mm: {} tetrahedra, {} nodes, {least:.1} to {most:.1} degrees, volume {:+.2} %, {} of {} corners off, {seconds:.2} s",
        size * 1e3,
        mesh.tets.len(),
        mesh.nodes.len(),
        100.0 * more,
        off.len(),
        corners.len(),
    );
    (mesh, more)
}

/// Faces of one tetrahedron only; all others must be of two, seen from opposite sides, with the same middle nodes.
fn lonely_faces(mesh: &TetMesh) -> usize {
    let mut faces: BTreeMap<[u32; 6], Vec<bool>> = BTreeMap::new();
    for tet in &mesh.tets {
        for [a, b, c, ab, bc, ca] in [
            [1, 2, 3, 5, 9, 8],
            [0, 3, 2, 7, 9, 6],
            [0, 1, 3, 4, 8, 7],
            [0, 2, 1, 6, 5, 4],
        ] {
            // From its lowest corner on, one way or the other.
            let mut face = [[a, b, c], [ab, bc, ca]].map(|of| of.map(|k: usize| tet[k]));
            let lowest = (0..3).min_by_key(|&k| face[0][k]).expect("three");
            face.iter_mut().for_each(|of| of.rotate_left(lowest));
            let [[a, mut b, mut c], [mut ab, bc, mut ca]] = face;
            let turned = b > c;
            if turned {
                std::mem::swap(&mut b, &mut c);
                std::mem::swap(&mut ab, &mut ca);
            }
            faces.entry([a, b, c, ab, bc, ca]).or_default().push(turned);
        }
    }
    let lonely = |sides: &Vec<bool>| match sides[..] {
        [_] => true,
        [one, other] => {
            assert_ne!(one, other, "two tetrahedra on one side of a face");
            false
        }
        _ => panic!("a face of {} tetrahedra", sides.len()),
    };
    faces.values().filter(|sides| lonely(sides)).count()
}

/// Solid of cells of a grid in x and y, from -`z` to `z`: sharp edges, gaps and necks as wanted.
fn blocks(xs: &[f64], ys: &[f64], cells: &[[usize; 2]], z: f64) -> TriMesh {
    let index = |i: usize, j: usize, top: bool| (2 * (i * ys.len() + j) + usize::from(top)) as u32;
    let mut all = TriMesh::default();
    for (x, y) in xs.iter().flat_map(|x| ys.iter().map(move |y| (x, y))) {
        all.vertices
            .extend([Vec3::new(*x, *y, -z), Vec3::new(*x, *y, z)]);
    }
    let mut quad = |[a, b, c, d]: [u32; 4]| all.triangles.extend([[a, b, c], [a, c, d]]);
    for &[i, j] in cells {
        let round = [[i, j], [i + 1, j], [i + 1, j + 1], [i, j + 1]];
        quad(round.map(|[i, j]| index(i, j, true)));
        quad([0, 3, 2, 1].map(|k: usize| index(round[k][0], round[k][1], false)));
        let next = [(0, -1), (1, 0), (0, 1), (-1, 0)];
        for (k, (di, dj)) in next.into_iter().enumerate() {
            let beside = [i as i64 + di, j as i64 + dj];
            if !cells.iter().any(|c| c.map(|x| x as i64) == beside) {
                let ([a, b], [c, d]) = (round[k], round[(k + 1) % 4]);
                quad([
                    index(a, b, false),
                    index(c, d, false),
                    index(c, d, true),
                    index(a, b, true),
                ]);
            }
        }
    }
    sulcus_scene::mesh::repair::repair(all).0
}

fn turned(mut mesh: TriMesh, axis: Vec3, angle: f64) -> TriMesh {
    let (axis, c, s) = (axis.normalize(), libm::cos(angle), libm::sin(angle));
    for v in &mut mesh.vertices {
        *v = *v * c + axis.cross(v) * s + axis * (axis.dot(v) * (1.0 - c));
    }
    mesh
}

#[test]
fn tetrahedra_of_a_sphere_converge_to_its_volume() {
    let sphere = icosphere(0.01, 6);
    let lost = [4e-3, 2e-3, 1e-3].map(|size| -filled("sphere", &sphere, size).1);
    assert!(lost[1] < 0.015 && lost[2] < 0.004, "{lost:?}");
    // Of second order in the size.
    assert!(
        lost[0] / lost[1] > 3.0 && lost[1] / lost[2] > 3.0,
        "{lost:?}"
    );
}

#[test]
fn tetrahedra_of_the_parametric_tongue_converge_to_its_volume() {
    let tongue = Tongue::default().mesh();
    let lost = [6e-3, 3e-3, 1.5e-3].map(|size| -filled("tongue", &tongue, size).1);
    assert!(lost[0] < 0.02 && lost[1] < 0.005, "{lost:?}");
    assert!(
        lost[0] / lost[1] > 3.0 && lost[1] / lost[2] > 3.0,
        "{lost:?}"
    );
    // Smooth surfaces are far from the worst case.
    let [least, most] = dihedral_angles(&filled("tongue", &tongue, 5e-3).0);
    assert!(least > 15.0 && most < 157.0, "{least} to {most}");
}

#[test]
fn tetrahedra_of_turned_boxes_lose_no_more_than_their_edges() {
    let half = Vec3::new(0.02, 0.01, 0.005);
    for (k, size) in [4e-3, 2e-3, 1.3e-3]
        .into_iter()
        .cycle()
        .take(12)
        .enumerate()
    {
        let axis = Vec3::new(1.0, 0.3 * k as f64 - 1.0, 0.5);
        let surface = turned(cuboid(half), axis, 0.4 * k as f64);
        let (_, more) = filled("box", &surface, size);
        // A sharp edge is bevelled within a cube, and a corner within one.
        let edges = 8.0 * (half.x + half.y + half.z);
        let bound = edges * size * size * 0.5 / surface.signed_volume();
        assert!(-more < bound && more < 1e-3, "{more} {bound}");
    }
}

/// Two legs with a gap between them, wide and narrow against the lattice.
#[test]
fn tetrahedra_on_both_sides_of_a_narrow_gap_do_not_touch() {
    let cells = [[0, 0], [1, 0], [2, 0], [0, 1], [2, 1]];
    for k in 0..24 {
        let gap = 1e-3 * [0.05, 0.3, 0.6, 0.9, 1.2, 2.0][k % 6];
        let (xs, ys) = ([-5e-3 - gap, -gap, 0.0, 5e-3], [-6e-3, -3e-3, 6e-3]);
        let surface = turned(
            blocks(&xs, &ys, &cells, 5e-3),
            Vec3::new(1.0, 2.0, 3.0),
            0.3 * k as f64,
        );
        let (_, more) = filled(&format!("legs {:.2} mm apart", gap * 1e3), &surface, 1.5e-3);
        assert!(more > -0.15 && more < 0.05, "{more}");
    }
}

#[test]
fn tetrahedra_have_the_same_bits_twice_and_tell_how_far_they_are() {
    let distance = MeshDistance::new(Tongue::default().mesh());
    let told = std::cell::RefCell::new(Vec::new());
    let one = tetrahedra(&distance, 6e-3, &|share| told.borrow_mut().push(share)).expect("a mesh");
    let other = tetrahedra(&distance, 6e-3, &|_| ()).expect("a mesh");
    let bits = |mesh: &TetMesh| -> Vec<u64> {
        mesh.nodes
            .iter()
            .flat_map(|x| [x.x, x.y, x.z])
            .map(f64::to_bits)
            .collect()
    };
    assert_eq!(bits(&one), bits(&other));
    assert_eq!(one.tets, other.tets);
    let told = told.into_inner();
    assert!(
        told.len() > 3 && told.is_sorted() && told.last() == Some(&1.0),
        "{told:?}"
    );
}

fn refused(surface: TriMesh, size: f64) -> String {
    let error = tetrahedra(&MeshDistance::new(surface), size, &|_| ()).expect_err("refused");
    error.to_string()
}

#[test]
fn tetrahedra_are_refused_with_what_was_found_and_expected() {
    let sphere = icosphere(0.01, 3);
    for size in [0.0, -1e-3, f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let expected = format!("size is {size}, expected a length over 0, metres");
        assert_eq!(refused(sphere.clone(), size), expected);
    }
    for size in [1e-4, 1e-9, f64::MIN_POSITIVE] {
        let error = refused(sphere.clone(), size);
        assert!(
            error.starts_with("size is ") && error.contains("at most 2e6 nodes"),
            "{error}"
        );
    }
    for size in [1.0, f64::MAX] {
        let error = refused(sphere.clone(), size);
        assert!(error.contains("number of tetrahedra is 0 with"), "{error}");
    }
    let mut open = sphere;
    open.triangles.pop();
    let error = refused(open.clone(), 1e-3);
    assert!(error.contains("open edges"), "{error}");
    open.triangles.clear();
    assert!(refused(open, 1e-3).contains("found no triangle"));
    let mut wild = icosphere(0.01, 3);
    wild.vertices[7].x = f64::NAN;
    assert!(refused(wild, 1e-3).contains("finite"));
    // Two blocks and a neck between them that the lattice does not see.
    let (xs, ys) = ([-9e-3, -3e-3, 3e-3, 9e-3], [-4e-3, 0.0, 2e-5, 4e-3]);
    let cells = [[0, 0], [0, 1], [0, 2], [1, 1], [2, 0], [2, 1], [2, 2]];
    let error = tetrahedra(
        &MeshDistance::new(blocks(&xs, &ys, &cells, 4e-3)),
        1.1e-3,
        &|_| (),
    );
    let Err(error @ TetraError::Field { field, .. }) = &error else {
        panic!("{error:?}")
    };
    assert_eq!(*field, "volume apart from the largest piece");
    assert!(
        error
            .to_string()
            .contains("in 1 more with a lattice of 1.1 mm, expected at most 1 %"),
        "{error}"
    );
}

#[test]
fn tetrahedra_of_real_organs() {
    for (file, size, bound) in [
        ("tongue.stl", 5e-3, 0.015),
        ("tongue_sofa.stl", 5e-3, 0.03),
        // Narrow gaps: the lattice is placed anew until the sides do not touch.
        ("gingiva_patch_36_pocket.stl", 1.25e-3, 0.03),
        ("mandible.stl", 2.5e-3, 0.03),
    ] {
        if let Some(surface) = crate::meshes::data(file) {
            let (_, more) = filled(file, &surface, size);
            assert!(more.abs() < bound, "{file}: {more}");
        }
    }
}

/// Returns the force (N) on each node from a load of 1 N along z, on the faces towards it.
///
/// The load is down or up, spread about `at` as a bell of `width`. Quadratic triangles with their middle nodes as
/// points of integration are used.
fn load(mesh: &TetMesh, at: Vec3, width: f64, down: bool) -> Vec<Vec3> {
    let bits = |x: Vec3| [x.x, x.y, x.z].map(f64::to_bits);
    let mut forces = vec![Vec3::zeros(); mesh.nodes.len()];
    let nodes = (0..).zip(&mesh.nodes).map(|(k, x)| (bits(*x), k));
    let nodes: BTreeMap<[u64; 3], usize> = nodes.collect();
    let surface = boundary(mesh);
    for t in 0..surface.triangles.len() {
        let (corners, area) = (surface.corners(t), surface.area_vector(t).z);
        if (area > 0.0) == down {
            for (a, b) in [(0, 1), (1, 2), (2, 0)] {
                let place = (corners[a] + corners[b]) * 0.5;
                let away = (place - at).norm() / width;
                forces[nodes[&bits(place)]].z -= area * libm::exp(-0.5 * away * away);
            }
        }
    }
    let whole: f64 = forces.iter().map(|f| f.z.abs()).sum();
    forces.iter().map(|f| f / whole).collect()
}

/// A load on the back of a tongue held by its root below, and a squeeze between back and underside; displacements
/// along their own directions.
///
/// The squeeze tests the tetrahedra: it is the same at any size.
///
/// The load also depends on the nodes in the small held region, whose edge no lattice follows: at 3.5 and 3 mm it
/// sinks by 95.3 and 95.4 mm/N. The bound covers this effect at these sizes.
#[test]
fn tetrahedra_of_the_tongue_bear_loads_alike_at_any_size() {
    let surface = Tongue::default().mesh();
    let (low, high) = surface.bounds();
    let material = Elastic {
        young: 15e3,
        poisson: 0.49,
    };
    let (mut sinks, mut squeezes) = (Vec::new(), Vec::new());
    for size in [8e-3, 6e-3, 4.5e-3] {
        let (mut mesh, _) = filled("tongue", &surface, size);
        let held = hold(&mut mesh, |x| {
            x.x < low.x + 0.12 * (high.x - low.x) && x.z < low.z + 0.25 * (high.z - low.z)
        });
        let started = std::time::Instant::now();
        let on_back = load(&mesh, Vec3::new(0.0, 0.0, high.z), 8e-3, true);
        let below = load(&mesh, Vec3::new(0.0, 0.0, low.z), 8e-3, false);
        let squeeze = on_back.iter().zip(&below).map(|(a, b)| a + b).collect();
        let loads = [on_back, squeeze];
        let factored = Factored::new(&mesh, &material).expect("factored");
        let moved = factored.solve(&loads).expect("displacements");
        // Twice the work.
        let [sink, squeezed] = [0, 1].map(|k| -> f64 {
            let pairs = loads[k].iter().zip(&moved[k]);
            pairs.map(|(f, u)| f.dot(u)).sum()
        });
        println!(
            "{:.1} mm: {held} nodes held, sinks {:.2} mm/N, squeezed {:.3} mm/N, {:.2} s",
            size * 1e3,
            sink * 1e3,
            squeezed * 1e3,
            started.elapsed().as_secs_f64()
        );
        sinks.push(sink);
        squeezes.push(squeezed);
    }
    let steps = |of: &[f64]| [(of[1] / of[0] - 1.0).abs(), (of[2] / of[1] - 1.0).abs()];
    assert!(
        steps(&squeezes).iter().all(|step| *step < 0.003),
        "{squeezes:?}"
    );
    assert!(steps(&sinks).iter().all(|step| *step < 0.1), "{sinks:?}");
}
