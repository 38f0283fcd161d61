//! Penetration of one solid into another by their meshes, without the spheres of any tree.

use sulcus_core::math::norm;
use sulcus_core::{DisplayMesh, Object, Pose, Tool, Vec3};
use sulcus_scene::error::level_error;
use sulcus_scene::mesh::TriMesh;
use sulcus_scene::mesh::distance::MeshDistance;
use sulcus_scene::tree::blend::blend_error;

/// Points on a tool in a tree of balls, so that a query skips most of them.
#[derive(Clone, Debug)]
pub struct Points {
    points: Vec<Vec3>,
    /// Balls, breadth first: the halves of ball `k` are `2 k + 1` and `2 k + 2`.
    balls: Vec<Ball>,
}

#[derive(Clone, Copy, Debug)]
struct Ball {
    centre: Vec3,
    radius: f64,
    first: usize,
    count: usize,
}

/// Largest number of points in the smallest balls.
const FEW: usize = 4;

impl Points {
    /// Points on all triangles of a mesh in the tool's frame, at most `spacing` metres apart, filtered by `kept`.
    ///
    /// # Panics
    /// `kept` leaves no point.
    pub fn of(mesh: &TriMesh, spacing: f64, kept: impl Fn(&Vec3) -> bool) -> Self {
        let mut points = all_over(mesh, spacing);
        points.retain(kept);
        assert!(!points.is_empty(), "no point of the tool is wanted");
        let mut balls: Vec<Ball> = Vec::new();
        let mut parts = vec![(0, points.len())];
        // The tree is complete, so that the index of a ball gives its position.
        while parts.iter().any(|(_, count)| *count > FEW) || balls.is_empty() {
            let mut halves = Vec::with_capacity(2 * parts.len());
            for (first, count) in parts {
                let part = &mut points[first..first + count];
                balls.push(ball(part, first));
                let (low, high) = bounds(part);
                let axis = (high - low).imax();
                part.sort_unstable_by(|a, b| a[axis].total_cmp(&b[axis]));
                halves.push((first, count / 2));
                halves.push((first + count / 2, count - count / 2));
            }
            parts = halves;
        }
        for (first, count) in parts {
            balls.push(ball(&points[first..first + count], first));
        }
        Self { points, balls }
    }

    /// Depth of the deepest point inside `solid` (world) with the tool at `pose` (`world_from_tool`), metres, but at
    /// least `known`. A negative depth is the distance of the nearest point outside.
    pub fn deepest_inside(&self, solid: &MeshDistance, pose: &Pose, known: f64) -> f64 {
        let mut deepest = known;
        let mut open = vec![0];
        while let Some(k) = open.pop() {
            let Some(ball) = self.balls.get(k).filter(|ball| ball.count > 0) else {
                continue;
            };
            // A distance changes by no more than the distance between the points.
            let inside = |at: &Vec3| -solid.signed(&pose.transform(at));
            if inside(&ball.centre) + ball.radius <= deepest {
                continue;
            }
            if 2 * k + 1 < self.balls.len() {
                open.extend([2 * k + 1, 2 * k + 2]);
                continue;
            }
            for point in &self.points[ball.first..ball.first + ball.count] {
                deepest = deepest.max(inside(point));
            }
        }
        deepest
    }
}

fn bounds(points: &[Vec3]) -> (Vec3, Vec3) {
    let huge = Vec3::repeat(f64::INFINITY);
    points
        .iter()
        .fold((huge, -huge), |(low, high), p| (low.inf(p), high.sup(p)))
}

fn ball(points: &[Vec3], first: usize) -> Ball {
    let (low, high) = bounds(points);
    let centre = if points.is_empty() {
        Vec3::zeros()
    } else {
        (low + high) * 0.5
    };
    let distances = points.iter().map(|point| norm(&(point - centre)));
    Ball {
        centre,
        radius: distances.fold(0.0, f64::max),
        first,
        count: points.len(),
    }
}

fn all_over(mesh: &TriMesh, spacing: f64) -> Vec<Vec3> {
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

/// Solid of an object's display mesh, for parts whose tree was made from that mesh. The display mesh is stored to a
/// nanometre.
pub fn solid_of(mesh: &DisplayMesh) -> MeshDistance {
    MeshDistance::new(TriMesh {
        vertices: mesh
            .vertices
            .iter()
            .map(|p| Vec3::new(p[0].into(), p[1].into(), p[2].into()))
            .collect(),
        triangles: mesh.triangles.clone(),
    })
}

/// Largest penetration of `tool`, with the surface `of_tool`, into a blended object with the surface `solid`, metres.
///
/// The bound is the sum of the stated errors of both trees at the levels in contact, for a tip of 0.25 mm radius.
pub fn allowed_inside(
    (object, solid): (&Object, &MeshDistance),
    (tool, of_tool): (&Tool, &MeshDistance),
) -> f64 {
    let of_object = blend_error(&object.tree, object.level, solid, 2.5e-4).max;
    let of_tool = level_error(&tool.tree, tool.level, of_tool).max_gap_mm;
    (of_object + of_tool) * 1e-3
}

#[cfg(test)]
mod tests {
    use sulcus_core::math::exp_rotation;
    use sulcus_scene::mesh::shapes::{cuboid, icosphere};

    use super::*;

    #[test]
    fn a_ball_that_dips_into_a_box_is_as_deep_as_it_was_put() {
        let solid = MeshDistance::new(cuboid(Vec3::new(0.01, 0.01, 0.01)));
        let points = Points::of(&icosphere(1e-3, 4), 1e-4, |_| true);
        let turn = exp_rotation(&Vec3::new(0.3, -1.0, 0.5));
        for depth in [-2e-3, -1e-4, 0.0, 1e-4, 5e-4] {
            let pose = Pose::new(Vec3::new(1e-3, -2e-3, 0.011 - depth), turn);
            let found = points.deepest_inside(&solid, &pose, f64::NEG_INFINITY);
            // A ball of triangles is smaller than the sphere by their sagitta, up to 3 um.
            assert!((found - depth).abs() < 4e-6, "{depth:e} {found:e}");
            let all = points.points.iter();
            let all = all.map(|p| -solid.signed(&pose.transform(p)));
            assert_eq!(found, all.fold(f64::NEG_INFINITY, f64::max));
            // A depth no larger than `known` is not searched.
            assert_eq!(points.deepest_inside(&solid, &pose, 1e-3), 1e-3);
        }
    }
}
