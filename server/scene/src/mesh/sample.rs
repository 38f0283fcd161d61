//! Points distributed evenly over a mesh by area, without randomness.

use sulcus_core::{Sphere, Vec3};

use crate::mesh::distance::MeshDistance;

/// A point of the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Place, metres.
    pub point: Vec3,
    /// Unit normal, outward. It is smooth across gentle edges, and the face's at sharp ones.
    pub normal: Vec3,
}

/// Cosine of the smallest angle between a corner's normal and the face's at a sharp edge.
const SHARP_COS: f64 = 0.8;

/// Returns `count` points, one for each equal share of the area. `phase` in `[0, 1)` selects another set.
pub fn surface(distance: &MeshDistance, count: usize, phase: f64) -> Vec<Sample> {
    let mesh = distance.mesh();
    let share = mesh.area() / count as f64;
    let mut samples = Vec::with_capacity(count);
    let mut passed = 0.0;
    for (t, triangle) in mesh.triangles.iter().enumerate() {
        passed += 0.5 * mesh.area_vector(t).norm();
        let corners = mesh.corners(t);
        let face = distance.face_normal(t as u32);
        while samples.len() < count && (samples.len() as f64 + 0.5) * share <= passed {
            // The R2 sequence (Roberts) fills a unit square evenly, whatever part of it is used.
            let k = samples.len() as f64 + phase;
            let (mut u, mut v) = (
                (0.5 + k * 0.754_877_666_246_692_7).fract(),
                (0.5 + k * 0.569_840_290_998_053_2).fract(),
            );
            if u + v > 1.0 {
                (u, v) = (1.0 - u, 1.0 - v);
            }
            let weights = [1.0 - u - v, u, v];
            let mut point = Vec3::zeros();
            let mut normal = Vec3::zeros();
            for k in 0..3 {
                point += corners[k] * weights[k];
                let smooth = distance.vertex_normal(triangle[k]);
                normal += if smooth.dot(&face) > SHARP_COS {
                    smooth
                } else {
                    face
                } * weights[k];
            }
            samples.push(Sample {
                point,
                normal: normal.normalize(),
            });
        }
    }
    samples
}

/// Returns points along the sharp edges, corners included, at a distance of `spacing` metres; more if there would be
/// over about `most`.
///
/// Edges have no area, so samples of the surface miss them, and the error is largest there.
pub(crate) fn sharp_edges(distance: &MeshDistance, spacing: f64, most: usize) -> Vec<Sample> {
    let mesh = distance.mesh();
    let mut edges: Vec<(u32, u32, u32)> = Vec::with_capacity(mesh.triangles.len() * 3);
    for (t, &[a, b, c]) in mesh.triangles.iter().enumerate() {
        for (from, to) in [(a, b), (b, c), (c, a)] {
            edges.push((from.min(to), from.max(to), t as u32));
        }
    }
    edges.sort_unstable();
    let mut sharp = Vec::new();
    for shared in edges.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
        let [one, other] = shared else { continue };
        let (n, m) = (distance.face_normal(one.2), distance.face_normal(other.2));
        if n.dot(&m) > SHARP_COS || n.dot(&m) < -0.999 {
            continue;
        }
        let (from, to) = (mesh.vertices[one.0 as usize], mesh.vertices[one.1 as usize]);
        sharp.push((one.0, from, to, (n + m).normalize()));
    }
    let total: f64 = sharp
        .iter()
        .map(|(_, from, to, _)| (to - from).norm())
        .sum();
    let spacing = spacing.max(2.0 * total / most.max(1) as f64);
    let corners = 2 * sharp.len() <= most;
    let (mut samples, mut due, mut last) = (Vec::new(), 0.5, u32::MAX);
    for (corner, from, to, normal) in sharp {
        // Edges are sorted by their lower corner, so each corner occurs once.
        if corners && corner != last {
            samples.push(Sample {
                point: from,
                normal,
            });
            last = corner;
        }
        let length = (to - from).norm();
        let before = due;
        due += length / spacing;
        let mut mark = before.floor() + 1.0;
        while mark <= due {
            let along = ((mark - before) * spacing / length).clamp(0.0, 1.0);
            samples.push(Sample {
                point: from + (to - from) * along,
                normal,
            });
            mark += 1.0;
        }
        due -= due.floor();
    }
    samples
}

/// Returns points distributed evenly over a ball's surface (Fibonacci's spiral).
pub(crate) fn ball_points(sphere: &Sphere, count: usize) -> impl Iterator<Item = Vec3> {
    let (centre, radius) = (sphere.centre, sphere.radius);
    (0..count).map(move |k| {
        let z = 1.0 - (2.0 * k as f64 + 1.0) / count as f64;
        let angle = 2.399_963_229_728_653 * k as f64;
        let ring = (1.0 - z * z).sqrt();
        centre + Vec3::new(ring * libm::cos(angle), ring * libm::sin(angle), z) * radius
    })
}
