use super::*;
use crate::math::{Pose, exp_rotation, fmax};

/// Returns centres of spheres in an uneven layer under a bent sheet, and vertices on the sheet.
fn sheet() -> (Vec<(u32, Vec3)>, Vec<Vec3>) {
    let height = |x: f64, y: f64| 0.02 - 8.0 * x * x - 5.0 * y * y;
    let mut centres = Vec::new();
    for i in -7..=7 {
        for j in -5..=5 {
            let (i, j) = (f64::from(i), f64::from(j));
            let (x, y) = (
                4e-3 * (i + 0.3 * libm::sin(3.0 * j + i)),
                4e-3 * (j + 0.3 * libm::cos(2.0 * i + j)),
            );
            let depth = 4e-3 + 1.5e-3 * libm::sin(1.7 * i - 2.9 * j);
            // Ids with gaps, as the nodes of a tree have.
            let id = 2 * centres.len() as u32 + 3;
            centres.push((id, Vec3::new(x, y, height(x, y) - depth)));
        }
    }
    let vertices = (0..900)
        .map(|k| {
            let (x, y) = (
                1.4e-3 * (f64::from(k % 30) - 14.5),
                1.0e-3 * (f64::from(k / 30) - 14.5),
            );
            Vec3::new(x, y, height(x, y))
        })
        .collect();
    (centres, vertices)
}

/// Returns the displacement of each sphere, by node of the tree.
fn field(centres: &[(u32, Vec3)], of: impl Fn(&Vec3) -> Vec3) -> Vec<Vec3> {
    let nodes = centres.iter().map(|(id, _)| *id + 1).max().unwrap_or(0);
    // NaN in unused nodes detects a read of them.
    let mut moved = vec![Vec3::repeat(f64::NAN); nodes as usize];
    for (id, at) in centres {
        moved[*id as usize] = of(at);
    }
    moved
}

fn carried(skin: &DisplaySkin, moved: &[Vec3]) -> Vec<Vec3> {
    let mut out = vec![Vec3::zeros(); skin.vertices()];
    skin.displacements(moved, &mut out);
    out
}

#[test]
fn turned_and_stretched_spheres_are_followed_exactly() {
    let (centres, vertices) = sheet();
    let skin = DisplaySkin::new(&centres, &vertices);
    let turn = Pose::new(
        Vec3::new(0.01, -0.02, 0.005),
        exp_rotation(&Vec3::new(0.4, -0.9, 1.3)),
    );
    let stretch = |p: &Vec3| Vec3::new(0.3 * p.x + 0.1 * p.z, -0.2 * p.y, 0.4 * p.z - 0.2 * p.x);
    let motions: [&dyn Fn(&Vec3) -> Vec3; 2] = [&|p| turn.transform(p) - p, &stretch];
    for motion in motions {
        let found = carried(&skin, &field(&centres, motion));
        for (vertex, found) in vertices.iter().zip(&found) {
            let off = norm(&(found - motion(vertex)));
            assert!(off < 1e-9, "{off:e} m at {vertex:?}");
        }
    }
}

#[test]
fn work_force_and_torque_are_the_same_on_both_sides() {
    let (centres, vertices) = sheet();
    let skin = DisplaySkin::new(&centres, &vertices);
    let moved = field(&centres, |p| {
        Vec3::new(
            libm::sin(300.0 * p.x),
            p.y * p.z * 1e3,
            0.3 * libm::cos(200.0 * p.y),
        ) * 1e-3
    });
    let forces: Vec<Vec3> = (0..vertices.len())
        .map(|k| {
            Vec3::new(
                libm::sin(k as f64),
                libm::cos(3.0 * k as f64),
                libm::sin(0.1 * k as f64),
            )
        })
        .collect();
    let mut loads = vec![Vec3::zeros(); moved.len()];
    skin.loads(&forces, &mut loads);
    let at_vertices: f64 = carried(&skin, &moved)
        .iter()
        .zip(&forces)
        .map(|(u, f)| u.dot(f))
        .sum();
    let at_spheres: f64 = centres
        .iter()
        .map(|(id, _)| moved[*id as usize].dot(&loads[*id as usize]))
        .sum();
    assert!(
        (at_vertices - at_spheres).abs() < 1e-12,
        "{at_vertices} {at_spheres}"
    );
    let force: Vec3 = forces.iter().sum();
    let torque: Vec3 = vertices.iter().zip(&forces).map(|(x, f)| x.cross(f)).sum();
    let on_spheres: Vec3 = loads.iter().sum();
    let about: Vec3 = centres
        .iter()
        .map(|(id, x)| x.cross(&loads[*id as usize]))
        .sum();
    assert!(
        norm(&(force - on_spheres)) < 1e-9,
        "{force:?} {on_spheres:?}"
    );
    assert!(norm(&(torque - about)) < 1e-8, "{torque:?} {about:?}");
}

#[test]
fn nothing_jumps_along_the_surface_whatever_the_nearest_spheres_are() {
    let (centres, _) = sheet();
    let line: Vec<Vec3> = (0..20_000)
        .map(|k| {
            let x = -0.02 + 2e-6 * f64::from(k);
            Vec3::new(x, 0.3 * x, 0.02 - 8.0 * x * x - 5.0 * 0.09 * x * x)
        })
        .collect();
    let skin = DisplaySkin::new(&centres, &line);
    // Roughest possible field on the spheres.
    let rough = field(&centres, |p| {
        Vec3::new(
            libm::sin(9e4 * p.x),
            libm::cos(7e4 * p.y),
            libm::sin(8e4 * p.z),
        )
    });
    let at = carried(&skin, &rough);
    let slopes: Vec<Vec3> = at.windows(2).map(|w| (w[1] - w[0]) / 2e-6).collect();
    let steepest = slopes.iter().fold(0.0, |most, s| fmax(most, norm(s)));
    let kink = slopes
        .windows(2)
        .fold(0.0, |most, s| fmax(most, norm(&(s[1] - s[0]))));
    // Vertices 2 um apart differ by almost nothing, and so do the slopes between them: no facet edge.
    assert!(steepest * 2e-6 < 0.01, "{steepest} per metre");
    assert!(kink < 0.02 * steepest, "{kink} of {steepest}");
}

#[test]
fn what_lies_beside_too_few_or_flat_spheres_follows_their_mean() {
    // Centres in one plane, vertices off the plane.
    let flat: Vec<(u32, Vec3)> = (0..49_u32)
        .map(|k| (k, Vec3::new(f64::from(k % 7), f64::from(k / 7), 0.0) * 2e-3))
        .collect();
    let above = [
        Vec3::new(6e-3, 6e-3, 2e-3),
        Vec3::new(0.0, 0.0, 4e-3),
        Vec3::new(20e-3, 0.0, 1e-3),
    ];
    for centres in [&flat[..], &flat[..3], &flat[..1]] {
        let skin = DisplaySkin::new(centres, &above);
        for v in 0..above.len() {
            let sum: f64 = skin.carriers(v).iter().map(|(_, w)| w).sum();
            let size: f64 = skin.carriers(v).iter().map(|(_, w)| w.abs()).sum();
            assert!((sum - 1.0).abs() < 1e-12, "{sum}");
            assert!(size <= DISTRUSTED, "{size} over {} spheres", centres.len());
        }
    }
    assert_eq!(DisplaySkin::new(&[], &above).carriers(2), []);
    let skin = DisplaySkin::new(&flat[..1], &flat.iter().map(|c| c.1).collect::<Vec<_>>());
    assert!((0..49).all(|v| skin.carriers(v) == [(0, 1.0)]));
}
