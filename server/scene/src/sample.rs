//! Points spread evenly over a mesh: by area, without randomness.

use sulcus_core::{Sphere, Vec3};

use crate::distance::MeshDistance;

/// A point of the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Where, metres.
    pub point: Vec3,
    /// Unit normal, outward; smooth across gentle edges, the face's at sharp ones.
    pub normal: Vec3,
}

/// Above this angle between a corner's normal and the face's, the edge is meant to be sharp.
const SHARP_COS: f64 = 0.8;

/// `count` points, one per equal share of the area. `phase` in `[0, 1)` picks another such set.
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
            // The R2 sequence (Roberts) fills a unit square evenly in any order of use.
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

/// Points spread evenly over a ball's surface (Fibonacci's spiral).
pub(crate) fn ball_points(sphere: &Sphere, count: usize) -> impl Iterator<Item = Vec3> {
    let (centre, radius) = (sphere.centre, sphere.radius);
    (0..count).map(move |k| {
        let z = 1.0 - (2.0 * k as f64 + 1.0) / count as f64;
        let angle = 2.399_963_229_728_653 * k as f64;
        let ring = (1.0 - z * z).sqrt();
        centre + Vec3::new(ring * libm::cos(angle), ring * libm::sin(angle), z) * radius
    })
}
