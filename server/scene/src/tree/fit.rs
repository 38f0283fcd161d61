//! One ball for a set of surface samples.
//!
//! Candidates lie on the lines from the surface to the inscribed balls' centres. A random descent with a fixed seed
//! follows.

use sulcus_core::{Sphere, Vec3};

use crate::mesh::distance::MeshDistance;
use crate::mesh::sample::Sample;
use crate::random::Random;

/// Number of samples of a fit. More samples change only the time.
const LOOKED_AT: usize = 240;
const LINES: usize = 10;
const STATIONS: [f64; 6] = [0.2, 0.4, 0.6, 0.75, 0.9, 1.0];
const REFINEMENTS: usize = 80;

/// Fits a ball to `members`; also returns its cost, square metres. A `start` saves most of the search.
///
/// `members` are indices into `samples`, whose inscribed-ball centres are `centres`.
pub(crate) fn fit(
    distance: &MeshDistance,
    samples: &[Sample],
    centres: &[Vec3],
    members: &[u32],
    start: Option<Sphere>,
    smallest: f64,
    random: &mut Random,
) -> (f64, Sphere) {
    let stride = members.len().div_ceil(LOOKED_AT);
    let points: Vec<Vec3> = members
        .iter()
        .step_by(stride)
        .map(|&m| samples[m as usize].point)
        .collect();
    let mut best = (
        f64::INFINITY,
        Sphere {
            centre: points[0],
            radius: smallest,
        },
    );
    if let Some(start) = start {
        consider(distance, &points, start.centre, smallest, &mut best);
    }
    // Without a start inside the solid, the lines to the medial centres are searched.
    let lines = if best.0.is_finite() {
        0
    } else {
        LINES.min(members.len())
    };
    for line in 0..lines {
        let member = members[(2 * line + 1) * members.len() / (2 * lines)] as usize;
        let (p, m) = (samples[member].point, centres[member]);
        for station in STATIONS {
            consider(
                distance,
                &points,
                p + (m - p) * station,
                smallest,
                &mut best,
            );
        }
    }
    // Decreasing steps around the best ball so far.
    let (mut reach, steps) = if lines == 0 {
        (0.2, REFINEMENTS / 2)
    } else {
        (0.5, REFINEMENTS)
    };
    reach *= best.1.radius;
    for _ in 0..steps {
        let offset = Vec3::from_fn(|_, _| random.between(-1.0, 1.0)) * reach;
        let before = best.0;
        consider(
            distance,
            &points,
            best.1.centre + offset,
            smallest,
            &mut best,
        );
        reach *= if best.0 < before { 1.2 } else { 0.93 };
    }
    best
}

/// Tests several radii about one centre.
fn consider(
    distance: &MeshDistance,
    points: &[Vec3],
    centre: Vec3,
    smallest: f64,
    best: &mut (f64, Sphere),
) {
    let (mut sum, mut squares, mut far) = (0.0, 0.0, 0.0_f64);
    for point in points {
        let d2 = (point - centre).norm_squared();
        let d = d2.sqrt();
        sum += d;
        squares += d2;
        far = far.max(d);
    }
    let count = points.len() as f64;
    let mean = sum / count;
    // No radius is better than the spread of the distances, so most centres need no distance query.
    if squares / count - mean * mean >= best.0 {
        return;
    }
    let depth = -distance.signed(&centre);
    if depth <= 0.0 {
        return;
    }
    // The cost is a parabola in the radius between a few kinks. Its terms are mean((d - r)^2) + protrusion^2 + 0.15
    // gap^2.
    for radius in [
        mean,
        depth,
        0.5 * (mean + depth),
        0.75 * depth + 0.25 * mean,
        (mean + depth + 0.15 * far) / 2.15,
    ] {
        let radius = radius.max(smallest);
        let protrusion = (radius - depth).max(0.0);
        let gap = (far - radius).max(0.0);
        let cost = squares / count - 2.0 * radius * mean
            + radius * radius
            + protrusion * protrusion
            + 0.15 * gap * gap;
        if cost < best.0 {
            *best = (cost, Sphere { centre, radius });
        }
    }
}
