//! How far a sphere tree is from the mesh it stands for, measured both ways by code that shares
//! nothing with the builder but the distance query.

use serde::Serialize;
use sulcus_core::{Sphere, SphereTree, Vec3};

use crate::distance::MeshDistance;
use crate::{parallel, sample};

/// Mean, 95th percentile and maximum of a set of distances, millimetres.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Spread {
    /// Mean.
    pub mean: f64,
    /// 95th percentile.
    pub p95: f64,
    /// Largest.
    pub max: f64,
}

/// Errors of one level.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct LevelError {
    /// The level.
    pub level: u8,
    /// Spheres that are the shape at this level.
    pub spheres: usize,
    /// `|min_i(|p - c_i| - r_i)|` over dense samples `p` of the mesh: gaps and bulges alike.
    pub mesh_to_spheres_mm: Spread,
    /// Distance from the exposed surface of the union of spheres to the mesh.
    pub spheres_to_mesh_mm: Spread,
}

/// Points at which each way is measured.
const POINTS: usize = 30_000;

/// Measures every level of `tree` against the mesh in `distance` (same frame).
pub fn tree_errors(tree: &SphereTree, distance: &MeshDistance) -> Vec<LevelError> {
    (0..=tree.depth())
        .map(|level| level_error(tree, level, distance))
        .collect()
}

/// Measures one level.
pub fn level_error(tree: &SphereTree, level: u8, distance: &MeshDistance) -> LevelError {
    let spheres: Vec<Sphere> = tree
        .shape_at(level)
        .map(|(_, node)| node.sphere())
        .collect();
    // Another phase than the builder's: points that it never saw.
    let samples = sample::surface(distance, POINTS, 0.5);
    let outward = parallel::map(samples.len(), |s| {
        union_distance(&spheres, &samples[s].point).abs()
    });
    let area: f64 = spheres.iter().map(|s| s.radius * s.radius).sum();
    let inward = parallel::map(spheres.len(), |k| {
        let share = spheres[k].radius * spheres[k].radius / area;
        let count = ((share * POINTS as f64) as usize).clamp(200, 4000);
        let touching: Vec<Sphere> = spheres
            .iter()
            .enumerate()
            .filter(|&(other, s)| {
                other != k && (s.centre - spheres[k].centre).norm() < s.radius + spheres[k].radius
            })
            .map(|(_, s)| *s)
            .collect();
        ball_points(&spheres[k], count)
            .filter(|p| touching.is_empty() || union_distance(&touching, p) > 0.0)
            .map(|p| distance.signed(&p).abs())
            .collect::<Vec<f64>>()
    })
    .concat();
    LevelError {
        level,
        spheres: spheres.len(),
        mesh_to_spheres_mm: spread(outward),
        spheres_to_mesh_mm: spread(inward),
    }
}

/// Distance to a union of balls, exact outside of it.
fn union_distance(spheres: &[Sphere], p: &Vec3) -> f64 {
    spheres.iter().fold(f64::INFINITY, |least, s| {
        let d = (p - s.centre).norm() - s.radius;
        if d < least { d } else { least }
    })
}

/// Points spread evenly over a ball's surface (Fibonacci's spiral).
fn ball_points(sphere: &Sphere, count: usize) -> impl Iterator<Item = Vec3> {
    let (centre, radius) = (sphere.centre, sphere.radius);
    (0..count).map(move |k| {
        let z = 1.0 - (2.0 * k as f64 + 1.0) / count as f64;
        let angle = 2.399_963_229_728_653 * k as f64;
        let ring = (1.0 - z * z).sqrt();
        centre + Vec3::new(ring * libm::cos(angle), ring * libm::sin(angle), z) * radius
    })
}

/// Metres in, millimetres out.
fn spread(mut metres: Vec<f64>) -> Spread {
    if metres.is_empty() {
        return Spread::default();
    }
    metres.sort_by(f64::total_cmp);
    let last = metres.len() - 1;
    Spread {
        mean: 1e3 * metres.iter().sum::<f64>() / metres.len() as f64,
        p95: 1e3 * metres[last * 95 / 100],
        max: 1e3 * metres[last],
    }
}
