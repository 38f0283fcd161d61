//! Whether one solid is inside another, by their meshes: no sphere of any tree is asked.

use sulcus_core::math::norm;
use sulcus_core::{Pose, Vec3};
use sulcus_scene::distance::MeshDistance;
use sulcus_scene::mesh::TriMesh;

/// Points all over a mesh's triangles, no farther apart than `spacing` metres, neighbours one after the other.
pub fn points_of(mesh: &TriMesh, spacing: f64) -> Vec<Vec3> {
    let mut points = Vec::new();
    for t in 0..mesh.triangles.len() {
        let [a, b, c] = mesh.corners(t);
        let longest = norm(&(b - a)).max(norm(&(c - b))).max(norm(&(a - c)));
        let n = ((longest / spacing).ceil() as usize).max(1);
        let step = 1.0 / n as f64;
        for i in 0..=n {
            for j in 0..=n - i {
                points.push(a + (b - a) * (step * i as f64) + (c - a) * (step * j as f64));
            }
        }
    }
    points
}

/// How deep the deepest of `points` (tool frame, metres) is inside `solid` (world) with the tool at `pose` (`world_from_tool`), metres:
/// exact for the points; negative where all are outside, by how far the nearest is.
pub fn deepest_inside(solid: &MeshDistance, points: &[Vec3], pose: &Pose) -> f64 {
    let mut least = f64::INFINITY;
    let mut last: Option<(Vec3, f64)> = None;
    for point in points {
        let at = pose.transform(point);
        // A distance changes by no more than the way gone: most points cannot be the nearest.
        if last.is_some_and(|(from, clear)| clear - norm(&(at - from)) >= least) {
            continue;
        }
        let signed = solid.signed(&at);
        least = least.min(signed);
        last = Some((at, signed));
    }
    -least
}

#[cfg(test)]
mod tests {
    use sulcus_core::math::exp_rotation;
    use sulcus_scene::shapes::{cuboid, icosphere};

    use super::*;

    #[test]
    fn a_ball_that_dips_into_a_box_is_as_deep_as_it_was_put() {
        let solid = MeshDistance::new(cuboid(Vec3::new(0.01, 0.01, 0.01)));
        let points = points_of(&icosphere(1e-3, 4), 1e-4);
        let turn = exp_rotation(&Vec3::new(0.3, -1.0, 0.5));
        for depth in [-2e-3, -1e-4, 0.0, 1e-4, 5e-4] {
            let pose = Pose::new(Vec3::new(1e-3, -2e-3, 0.011 - depth), turn);
            let found = deepest_inside(&solid, &points, &pose);
            // A ball of triangles is smaller by their sagitta, up to 3 um.
            assert!((found - depth).abs() < 4e-6, "{depth:e} {found:e}");
            let all = points.iter().map(|p| -solid.signed(&pose.transform(p)));
            assert_eq!(found, all.fold(f64::NEG_INFINITY, f64::max));
        }
    }
}
