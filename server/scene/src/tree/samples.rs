//! Samples of a level's fit. Important places have more and heavier samples.

use sulcus_core::Vec3;

use crate::mesh::distance::MeshDistance;
use crate::mesh::sample::{self, Sample};
use crate::parallel;
use crate::tree::medial::inscribed_centre;
use crate::tree::polish::Surface;

/// Importance of a sample on a sharp edge. Edges have no area, but tools catch on them.
const EDGE_IMPORTANCE: f64 = 2.0;

/// Samples of a level's fit.
pub(crate) struct Samples {
    pub samples: Vec<Sample>,
    /// Weight of each sample.
    pub weights: Vec<f64>,
    /// Strictness as in [`Surface`], 1 by default.
    pub strictness: Vec<f64>,
    /// Inscribed-ball centre of each.
    pub inscribed: Vec<Vec3>,
    /// Smallest radius of a sphere, metres.
    pub smallest: f64,
}

impl Samples {
    pub fn of(
        distance: &MeshDistance,
        count: usize,
        importance: &(dyn Fn(&Vec3) -> f64 + Sync),
    ) -> Self {
        let (samples, weights) = weighted_samples(distance, count, importance);
        Self::with(distance, samples, weights)
    }

    pub fn with(distance: &MeshDistance, samples: Vec<Sample>, weights: Vec<f64>) -> Self {
        let (low, high) = distance.mesh().bounds();
        let size = (high - low).norm();
        let inscribed = parallel::map(samples.len(), |s| {
            inscribed_centre(distance, &samples[s], 0.5 * size)
        });
        Self {
            strictness: vec![1.0; samples.len()],
            samples,
            weights,
            inscribed,
            smallest: 1e-6 * size,
        }
    }

    pub fn append(&mut self, more: Samples) {
        self.samples.extend(more.samples);
        self.weights.extend(more.weights);
        self.strictness.extend(more.strictness);
        self.inscribed.extend(more.inscribed);
    }

    pub fn surface<'a>(&'a self, distance: &'a MeshDistance) -> Surface<'a> {
        Surface {
            distance,
            samples: &self.samples,
            importance: &self.weights,
            strictness: &self.strictness,
            smallest: self.smallest,
        }
    }
}

/// Candidates for each sample that is kept, if importance varies.
const CANDIDATES: usize = 8;

/// Returns samples of the surface and its sharp edges with their weights.
///
/// Higher importance makes samples both denser and heavier, each by its square root: a fitted sphere needs enough
/// samples.
pub(crate) fn weighted_samples(
    distance: &MeshDistance,
    count: usize,
    importance: &(dyn Fn(&Vec3) -> f64 + Sync),
) -> (Vec<Sample>, Vec<f64>) {
    let rooted = |samples: &[Sample]| -> Vec<f64> {
        parallel::map(samples.len(), |s| importance(&samples[s].point).sqrt())
    };
    let mut samples = sample::surface(distance, count, 0.0);
    let mut roots = rooted(&samples);
    if roots.iter().any(|&root| root != roots[0]) {
        let candidates = sample::surface(distance, CANDIDATES * count, 0.0);
        let chances = rooted(&candidates);
        let share = chances.iter().sum::<f64>() / count as f64;
        (samples, roots) = (Vec::with_capacity(count), Vec::with_capacity(count));
        let mut due = 0.0;
        for (candidate, chance) in candidates.into_iter().zip(chances) {
            due += chance / share;
            if due >= 1.0 {
                due -= 1.0;
                samples.push(candidate);
                roots.push(chance);
            }
        }
    }
    let spacing = (distance.mesh().area() / count as f64).sqrt();
    let edges = sample::sharp_edges(distance, spacing, count);
    roots.extend(rooted(&edges).iter().map(|root| root * EDGE_IMPORTANCE));
    samples.extend(edges);
    (samples, roots)
}
