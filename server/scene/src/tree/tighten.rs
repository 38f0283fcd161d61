//! Reduction of the largest error in important places, at the cost of the rest.
//!
//! Importance alone hardly reduces the largest error. It multiplies a cost with a high power, and squares dominate
//! until an error passes the knee, which is common to all places.
//!
//! Here knees are lower where importance is higher, so gaps and bulges even out there. Spheres are brought in until
//! the largest errors have a fixed ratio.
//!
//! Between two fits each large error is followed uphill along the surface to its peak, which becomes a sample. The
//! peaks between three spheres are sharper than the samples are dense.

use sulcus_core::{Sphere, Vec3};

use crate::mesh::distance::MeshDistance;
use crate::mesh::sample::Sample;
use crate::parallel;
use crate::tree::level::{Effort, Level, lower};
use crate::tree::nearest_sphere::NearestSphere;
use crate::tree::polish::{Norm, Owned, assign};
use crate::tree::samples::Samples;

/// Root of the importance by which errors are reduced relative to other places.
const ROOT: f64 = 6.0;
/// Power of the error.
const POWER: i32 = 24;
/// Knee, as a share of the largest error at the start. Only errors far above it count.
const KNEE: f64 = 0.4;
/// Least error that is followed to its peak, as a share of the largest.
const FOLLOWED: f64 = 0.65;
/// Number of steps uphill, in six directions each. A failed step halves the length.
const CLIMBS: usize = 16;
/// First step uphill, in mean distances between samples.
const FIRST_STEP: f64 = 0.25;
/// Distance below which two peaks are one, in mean distances between samples.
const APART: f64 = 0.25;

/// Reduces the largest error of `level` where `importance` is higher, in rounds; the best round is kept. Uniform
/// importance changes nothing.
///
/// Peaks are added to `samples`.
pub(crate) fn tighten(
    distance: &MeshDistance,
    importance: &(dyn Fn(&Vec3) -> f64 + Sync),
    samples: &mut Samples,
    level: &mut Level,
    effort: &Effort,
    seed: u64,
) {
    if effort.tightenings == 0 {
        return;
    }
    let strict = |p: &Vec3| libm::pow(importance(p), 1.0 / ROOT);
    samples.strictness =
        parallel::map(samples.samples.len(), |s| strict(&samples.samples[s].point));
    if samples.strictness.windows(2).all(|pair| pair[0] == pair[1]) {
        samples.strictness.fill(1.0);
        return;
    }
    let mut owned = assign(&samples.surface(distance), &level.spheres, None);
    let felt = owned.iter().zip(&samples.strictness);
    let largest = felt.fold(0.0_f64, |most, ((gap, _), s)| most.max(gap.abs() * s));
    let norm = Norm {
        knee: KNEE * largest,
        power: POWER,
    };
    let mut best = (f64::INFINITY, level.clone());
    for round in 0..=effort.tightenings {
        let peaks = peaks(distance, samples, &owned, &level.spheres, &strict);
        let highest = peaks.first().map_or(0.0, |peak| peak.felt);
        if highest < best.0 {
            best = (highest, level.clone());
        }
        if round == effort.tightenings {
            break;
        }
        let found = peaks.iter().map(|peak| Sample {
            point: peak.point,
            normal: samples.samples[peak.from].normal,
        });
        let weights = peaks.iter().map(|peak| importance(&peak.point).sqrt());
        let mut more = Samples::with(distance, found.collect(), weights.collect());
        more.strictness = peaks.iter().map(|peak| strict(&peak.point)).collect();
        samples.append(more);
        // New spheres leave new peaks, so the last rounds add none.
        let plugs = if 2 * round < effort.tightenings {
            effort.plugs
        } else {
            0
        };
        let effort = Effort {
            plugs,
            failures: plugs,
            ..*effort
        };
        let seed = seed ^ (round as u64 + 1) << 8;
        let surface = samples.surface(distance);
        owned = lower(&surface, &samples.inscribed, level, &effort, norm, seed);
    }
    *level = best.1;
}

/// A place with an error larger than all around it.
struct Peak {
    /// Error times strictness, metres.
    felt: f64,
    point: Vec3,
    /// The sample at which its search began.
    from: usize,
}

/// Returns the highest peaks, highest first.
fn peaks(
    distance: &MeshDistance,
    samples: &Samples,
    owned: &Owned,
    spheres: &[Sphere],
    strict: &(dyn Fn(&Vec3) -> f64 + Sync),
) -> Vec<Peak> {
    let index = NearestSphere::new(spheres);
    let felt = |s: usize| owned[s].0.abs() * samples.strictness[s];
    let largest = (0..owned.len()).fold(0.0_f64, |most, s| most.max(felt(s)));
    let starts: Vec<usize> = (0..owned.len())
        .filter(|&s| felt(s) > FOLLOWED * largest)
        .collect();
    let spacing = (distance.mesh().area() / samples.samples.len() as f64).sqrt();
    let mut found: Vec<Peak> = parallel::map(starts.len(), |k| {
        let from = starts[k];
        let (sign, normal) = (owned[from].0.signum(), samples.samples[from].normal);
        let across = normal.cross(&Vec3::ith(normal.iamin(), 1.0)).normalize();
        let along = normal.cross(&across);
        let (mut point, mut most) = (samples.samples[from].point, felt(from));
        let mut step = FIRST_STEP * spacing;
        for _ in 0..CLIMBS {
            let here = point;
            let mut higher = false;
            for direction in 0..6 {
                let angle = f64::from(direction) * std::f64::consts::FRAC_PI_3;
                let off = across * libm::cos(angle) + along * libm::sin(angle);
                let tried = distance.nearest(&(here + off * step)).point;
                let error = sign * index.nearest(&tried, None).0 * strict(&tried);
                if error > most {
                    (point, most, higher) = (tried, error, true);
                }
            }
            if !higher {
                step *= 0.5;
            }
        }
        Peak {
            felt: most,
            point,
            from,
        }
    });
    found.sort_by(|a, b| b.felt.total_cmp(&a.felt).then(a.from.cmp(&b.from)));
    let mut kept: Vec<Peak> = Vec::new();
    for peak in found {
        let near = |other: &Peak| (other.point - peak.point).norm() < APART * spacing;
        if !kept.iter().any(near) {
            kept.push(peak);
        }
    }
    kept
}
