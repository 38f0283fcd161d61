//! The largest error where importance is higher, brought down at the cost of the rest.
//!
//! Importance alone hardly moves the largest error: it multiplies a cost whose power is high, and squares
//! rule until an error passes the knee, which is common to all places. Here knees are lower where importance
//! is higher, so that gaps and bulges level out there, and spheres come in from elsewhere until the largest
//! errors stand in a fixed ratio. Between two fits each large error is followed uphill along the surface to its
//! peak, which becomes a sample itself: the peaks, between three spheres, are sharper than samples are dense.

use sulcus_core::{Sphere, Vec3};

use crate::mesh::distance::MeshDistance;
use crate::mesh::sample::Sample;
use crate::parallel;
use crate::tree::level::{Effort, Level, lower};
use crate::tree::nearest_sphere::NearestSphere;
use crate::tree::polish::{Norm, Owned, assign};
use crate::tree::samples::Samples;

/// Errors are held to a share of those elsewhere: one over this root of the importance.
const ROOT: f64 = 6.0;
/// Power of the error.
const POWER: i32 = 24;
/// Knee, of the largest error at the start: what is far above it is all that counts.
const KNEE: f64 = 0.4;
/// Share of the largest error from which one is followed to its peak.
const FOLLOWED: f64 = 0.65;
/// Tries to go uphill, to six sides each; one that fails halves the step.
const CLIMBS: usize = 16;
/// First step uphill, of the mean distance between samples.
const FIRST_STEP: f64 = 0.25;
/// Peaks nearer to each other than this are one, of the mean distance between samples.
const APART: f64 = 0.25;

/// Lowers the largest error of `level` where `importance` is higher, in rounds of which the best is kept;
/// nothing happens where it is the same everywhere. Peaks are added to `samples`.
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
        // New spheres leave new peaks: the last rounds bring none.
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

/// A place where the error is larger than all round it.
struct Peak {
    /// Error times strictness, metres.
    felt: f64,
    point: Vec3,
    /// The sample from which it was found.
    from: usize,
}

/// The highest peaks, highest first.
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
