//! Measurement of shapes whose errors are known by hand.

use std::f64::consts::PI;

use super::*;
use crate::mesh::shapes::{cuboid, icosphere};
use crate::tree::zone::Region;

fn ball(x: f64, y: f64, z: f64, radius: f64) -> Sphere {
    Sphere {
        centre: Vec3::new(x, y, z),
        radius,
    }
}

/// Default sampling, with a smaller budget for shapes with the same error everywhere.
fn quick() -> Sampling {
    Sampling {
        budget: 300_000,
        ..Sampling::default()
    }
}

fn measured(spheres: &[Sphere], mesh: &MeshDistance, sampling: &Sampling) -> LevelError {
    let tree = SphereTree::over_leaves(spheres).expect("a tree");
    let level = tree.depth();
    Level::new(&tree, level, mesh, sampling).error()
}

fn near(found: f64, expected: f64, tolerance: f64) {
    assert!(
        (found - expected).abs() <= tolerance,
        "found {found}, expected {expected} within {tolerance}"
    );
}

/// A union of two equal balls, as a mesh of revolution.
///
/// Two icospheres cut at the plane between them would leave a seam.
fn peanut(radius: f64, half: f64, rings: usize, around: usize) -> MeshDistance {
    // Profile from pole to pole: angle on the left ball, then on the right.
    let seam = (half / radius).acos();
    let arc = PI - seam;
    let mut profile = vec![];
    for k in 1..=rings {
        let angle = PI - arc * k as f64 / rings as f64;
        profile.push((-half - radius * (PI - angle).cos(), radius * angle.sin()));
    }
    for k in 1..rings {
        let (x, r) = profile[rings - 1 - k];
        profile.push((-x, r));
    }
    let mut mesh = crate::mesh::TriMesh::default();
    mesh.vertices.push(Vec3::new(-half - radius, 0.0, 0.0));
    for &(x, r) in &profile {
        for k in 0..around {
            let turn = 2.0 * PI * k as f64 / around as f64;
            mesh.vertices
                .push(Vec3::new(x, r * turn.cos(), r * turn.sin()));
        }
    }
    mesh.vertices.push(Vec3::new(half + radius, 0.0, 0.0));
    let at = |ring: usize, k: usize| (1 + ring * around + k % around) as u32;
    let last = mesh.vertices.len() as u32 - 1;
    for k in 0..around {
        mesh.triangles.push([0, at(0, k + 1), at(0, k)]);
        for ring in 0..profile.len() - 1 {
            let (a, b) = (at(ring, k), at(ring, k + 1));
            let (c, d) = (at(ring + 1, k), at(ring + 1, k + 1));
            mesh.triangles.extend([[a, b, d], [a, d, c]]);
        }
        mesh.triangles
            .push([last, at(profile.len() - 1, k), at(profile.len() - 1, k + 1)]);
    }
    assert!(mesh.signed_volume() > 0.0);
    MeshDistance::new(mesh)
}

#[test]
fn one_ball_against_a_ball_that_is_larger() {
    // The mesh's flat triangles lie inside their sphere by at most the sagitta of the largest.
    let mesh = MeshDistance::new(icosphere(0.005, 5));
    let edge = 0.005 * 1.11 / 32.0;
    // Edges differ by a fifth.
    let sagitta_mm = 1.4e3 * edge * edge / (6.0 * 0.005);
    let found = measured(&[ball(0.0, 0.0, 0.0, 0.0049)], &mesh, &quick());
    let (out, back) = (found.mesh_to_spheres_mm, found.spheres_to_mesh_mm);
    near(out.max, 0.1, 1e-9);
    near(out.mean, 0.1, sagitta_mm);
    near(back.max, 0.1, 1.1 * sagitta_mm);
    near(back.mean, 0.1, sagitta_mm);
    for spread in [out, back] {
        assert!(spread.p95 <= spread.max && spread.p95 >= spread.mean);
        let at_most = spread.max_at_most.expect("searched");
        assert!(
            at_most >= spread.max && at_most < 1.15 * spread.max,
            "{spread:?}"
        );
    }
    near(found.max_gap_mm, 0.1, 1e-9);
    assert_eq!(found.max_bulge_mm, 0.0);
    assert_eq!(found.uncovered_area_percent, 100.0);
    let beyond = found.uncovered_beyond.map(|u| u.percent);
    assert_eq!(beyond, [100.0, 100.0, 0.0, 0.0]);
    assert_eq!(found.cavity_area_percent, 0.0);
    let volume = found.volume.expect("volumes");
    let mesh_volume = mesh.mesh().signed_volume();
    let expected = 100.0 * (4.0 / 3.0 * PI * 0.0049_f64.powi(3) / mesh_volume - 1.0);
    near(volume.volume_error_percent, expected, 0.02);
    near(volume.missing_volume_percent, -expected, 0.02);
    near(volume.excess_volume_percent, 0.0, 1e-9);

    let larger = measured(&[ball(0.0, 0.0, 0.0, 0.0052)], &mesh, &quick());
    assert_eq!(larger.uncovered_area_percent, 0.0);
    near(larger.max_bulge_mm, 0.2, 1.1 * sagitta_mm);
    assert_eq!(larger.max_gap_mm, 0.0);
}

#[test]
fn two_overlapping_balls_against_their_own_surface() {
    let (radius, half) = (0.003, 0.002);
    let mesh = peanut(radius, half, 60, 120);
    let both = [ball(-half, 0.0, 0.0, radius), ball(half, 0.0, 0.0, radius)];
    let found = measured(&both, &mesh, &quick());
    // Chords of 2 and 3 degrees: 0.5 and 1 um under the arc, at most together.
    assert!(found.mesh_to_spheres_mm.max < 0.002, "{found:?}");
    assert!(found.spheres_to_mesh_mm.max < 0.002, "{found:?}");
    // Volume of the union: two balls less the lens, by hand.
    let lens = PI * (4.0 * radius + 2.0 * half) * (2.0 * radius - 2.0 * half).powi(2) / 12.0;
    let exact = 2.0 * 4.0 / 3.0 * PI * radius.powi(3) - lens;
    let expected = 100.0 * (exact / mesh.mesh().signed_volume() - 1.0);
    near(
        found.volume.expect("volumes").volume_error_percent,
        expected,
        0.01,
    );

    // One of the two balls alone. The farthest point of the mesh is the other's pole.
    //
    // The hidden part of the ball is farthest from the surface at the largest depth of the seam plane.
    let one = measured(&both[..1], &mesh, &quick());
    near(one.mesh_to_spheres_mm.max, 1e3 * 2.0 * half, 1e-6);
    near(
        one.spheres_to_mesh_mm.max,
        deepest_mm(&mesh, &both[0]),
        0.006,
    );
    let missing = 100.0 * (exact - 4.0 / 3.0 * PI * radius.powi(3)) / exact;
    near(
        one.volume.expect("volumes").missing_volume_percent,
        missing,
        0.1,
    );
}

/// Returns the largest distance to the mesh over a ball, millimetres, along its meridian. All shapes here are
/// rotationally symmetric about x.
fn deepest_mm(mesh: &MeshDistance, ball: &Sphere) -> f64 {
    (0..=20_000).fold(0.0, |most, k| {
        let angle = PI * f64::from(k) / 20_000.0;
        let p = ball.centre + Vec3::new(angle.cos(), 0.0, angle.sin()) * ball.radius;
        fmax(most, 1e3 * mesh.signed(&p).abs())
    })
}

#[test]
fn a_displaced_ball_shows_by_exactly_what_it_was_displaced() {
    // A row of balls that touches both sides of a box from inside.
    let mesh = MeshDistance::new(cuboid(Vec3::new(0.010, 0.001, 0.001)));
    let mut row: Vec<Sphere> = (0..41)
        .map(|k| ball(-0.009 + 0.018 * f64::from(k) / 40.0, 0.0, 0.0, 0.001))
        .collect();
    let before = measured(&row, &mesh, &quick());
    assert_eq!(before.max_bulge_mm, 0.0);
    // One ball of the row sticks out by 0.123 mm.
    row[17].centre.y += 0.000_123;
    let after = measured(&row, &mesh, &quick());
    near(
        after.spheres_to_mesh_mm.max,
        before.spheres_to_mesh_mm.max.max(0.123),
        1e-3,
    );
    near(after.max_bulge_mm, 0.123, 1e-3);
    let zone = Zone {
        name: "there".into(),
        regions: vec![Region::Box {
            low: Vec3::new(row[17].centre.x - 0.0005, 0.0009, -0.0003),
            high: Vec3::new(row[17].centre.x + 0.0005, 0.002, 0.0003),
        }],
    };
    let tree = SphereTree::over_leaves(&row).expect("a tree");
    let report = measure(&tree, &mesh, &[zone], &quick(), &|_| {});
    let there = report.zones[0].levels.last().expect("levels");
    near(there.spheres_to_mesh_mm.max, 0.123, 1e-3);
    assert!(there.spheres_to_mesh_mm.max_at_most.expect("searched") >= 0.123);
    near(report.zones[0].area_mm2, 0.6, 0.02);
    assert_eq!(there.volume, None);
    // The root is a ball about everything, far from that place, and still counts.
    let root = &report.zones[0].levels[0];
    assert!(root.spheres_to_mesh_mm.max > 8.0, "{root:?}");
}

#[test]
fn where_no_sphere_is_nearest_there_is_no_distance_rather_than_none_at_all() {
    let mesh = MeshDistance::new(cuboid(Vec3::repeat(0.005)));
    let corner = Zone {
        name: "corner".into(),
        regions: vec![Region::Ball {
            centre: Vec3::repeat(0.005),
            radius: 0.001,
        }],
    };
    let tree = SphereTree::over_leaves(&[ball(0.0, 0.0, 0.0, 0.001)]).expect("a tree");
    let report = measure(&tree, &mesh, &[corner], &quick(), &|_| {});
    let there = &report.zones[0].levels[0];
    assert!(there.spheres_to_mesh_mm.max.is_nan(), "{there:?}");
    assert_eq!(there.measured.exposed_points, 0);
    near(
        there.mesh_to_spheres_mm.max,
        5.0 * 3.0_f64.sqrt() - 1.0,
        1e-9,
    );
}

#[test]
fn a_patch_is_the_part_of_the_surface_in_the_zone() {
    let mesh = cuboid(Vec3::repeat(0.005));
    let disc = |radius: f64| Zone {
        name: "disc".into(),
        regions: vec![Region::Ball {
            centre: Vec3::new(0.0, 0.0, 0.005),
            radius,
        }],
    };
    let patch = zone_patch(&mesh, &disc(0.002));
    near(patch.area() / (PI * 0.002 * 0.002), 1.0, 0.005);
    assert!(patch.vertices.iter().all(|v| v.z == 0.005));
    assert!(zone_patch(&mesh, &disc(1.0)).triangles.len() == 12);
    let nowhere = Zone {
        name: "inside".into(),
        regions: vec![Region::Ball {
            centre: Vec3::zeros(),
            radius: 0.004,
        }],
    };
    assert!(zone_patch(&mesh, &nowhere).triangles.is_empty());
}

#[test]
fn maxima_hardly_depend_on_the_number_of_points() {
    let mesh = MeshDistance::new(cuboid(Vec3::new(0.004, 0.003, 0.002)));
    let spheres: Vec<Sphere> = (0..27)
        .map(|k| {
            let at = |n: i32, size: f64| f64::from(n % 3 - 1) * size;
            ball(at(k, 0.0021), at(k / 3, 0.0014), at(k / 9, 0.0007), 0.0014)
        })
        .collect();
    let coarse = Sampling {
        mesh_points: 3_000,
        ..quick()
    };
    let fine = Sampling {
        mesh_points: 48_000,
        points_per_sphere: 80_000,
        rays: 800_000,
        ..quick()
    };
    let (a, b) = (
        measured(&spheres, &mesh, &coarse),
        measured(&spheres, &mesh, &fine),
    );
    let pairs = [
        (a.mesh_to_spheres_mm, b.mesh_to_spheres_mm),
        (a.spheres_to_mesh_mm, b.spheres_to_mesh_mm),
    ];
    for (a, b) in pairs {
        near(a.max / b.max, 1.0, 0.003);
        near(a.mean / b.mean, 1.0, 0.03);
        near(a.p95 / b.p95, 1.0, 0.03);
        let (least, most) = (fmax(a.max, b.max), a.max_at_most.expect("searched"));
        assert!(
            least <= most,
            "the bound of one is not below what the other met"
        );
    }
    let volumes = [a, b].map(|e| e.volume.expect("volumes").symmetric_difference_percent);
    near(volumes[0], volumes[1], 0.05);
}

#[test]
fn a_shell_of_balls_has_a_cavity_and_a_full_one_has_none() {
    let mesh = MeshDistance::new(icosphere(0.005, 3));
    let directions = icosphere(1.0, 2).vertices;
    let mut shell: Vec<Sphere> = directions
        .iter()
        .map(|d| ball(0.004 * d.x, 0.004 * d.y, 0.004 * d.z, 0.001))
        .collect();
    let hollow = measured(&shell, &mesh, &quick());
    // The cavity is about a ball of radius 3 mm: 22 % of the volume, and slightly more than a quarter of the exposed
    // area.
    let volume = hollow.volume.expect("volumes");
    assert!(
        (21.0..30.0).contains(&volume.cavity_volume_percent),
        "{hollow:?}"
    );
    assert!(
        (20.0..35.0).contains(&hollow.cavity_area_percent),
        "{hollow:?}"
    );
    // Its walls are part of the union's surface, and are counted apart.
    assert!(hollow.spheres_to_mesh_mm.max > 1.8, "{hollow:?}");
    assert!(hollow.outer_to_mesh_mm.max < 0.7, "{hollow:?}");

    // With a way out there is no cavity.
    let open: Vec<Sphere> = shell
        .iter()
        .filter(|s| s.centre.z < 0.003)
        .copied()
        .collect();
    let opened = measured(&open, &mesh, &quick());
    assert_eq!(opened.cavity_area_percent, 0.0, "{opened:?}");

    shell.push(ball(0.0, 0.0, 0.0, 0.0035));
    let full = measured(&shell, &mesh, &quick());
    assert!(full.cavity_area_percent < 0.5, "{full:?}");
    assert!(full.volume.expect("volumes").cavity_volume_percent < 0.1);
}

#[test]
fn signed_errors_are_gaps_above_and_bulges_below_zero() {
    let points = [Vec3::new(0.0, 0.0, 0.003), Vec3::new(0.0015, 0.0, 0.0)];
    let found = surface_error(&[ball(0.0, 0.0, 0.0, 0.002)], &points);
    near(found[0], 0.001, 1e-15);
    near(found[1], -0.0005, 1e-15);
}

#[test]
fn points_of_a_surface_add_up_to_its_area_however_it_is_cut() {
    for cuts in [0, 4] {
        let mesh = icosphere(0.005, cuts);
        let points = surface_points(&mesh, 1000);
        assert!(points.len() >= 1000.max(mesh.triangles.len()));
        let sum: f64 = points.iter().map(|p| p.area).sum();
        near(sum / mesh.area(), 1.0, 1e-12);
        let distance = MeshDistance::new(mesh);
        let off = points
            .iter()
            .fold(0.0, |most, p| fmax(most, distance.signed(&p.point).abs()));
        assert!(off < 1e-15, "{off}");
    }
}
