//! Motion of all spheres of a level together until the union fits the surface in both directions.
//!
//! A family of eight fits its own share of the surface without regard to its neighbours. Here each sample belongs to
//! the sphere with the nearest surface, whatever its parent.
//!
//! Each sphere takes one damped Gauss-Newton step. The step uses the samples of the sphere and the part of its own
//! surface that no other sphere covers.
//!
//! Errors count by a mixed norm: squares for the mean, a high power for the largest (iteratively reweighted least
//! squares).

use nalgebra::{Matrix4, Vector4};
use sulcus_core::{Sphere, Vec3};

use crate::mesh::distance::MeshDistance;
use crate::mesh::sample::{Sample, ball_points};
use crate::parallel;
use crate::tree::nearest_sphere::NearestSphere;

/// The surface of a fit.
pub(crate) struct Surface<'a> {
    pub distance: &'a MeshDistance,
    pub samples: &'a [Sample],
    /// Importance of each sample, 1 by default.
    pub importance: &'a [f64],
    /// Strictness of each sample: its knee is divided by it, so the high power dominates earlier.
    pub strictness: &'a [f64],
    /// Smallest radius, metres.
    pub smallest: f64,
}

/// Cost of an error: `e^2 (1 + (e / knee)^(power - 2))`.
///
/// Below the knee squares dominate and reduce the mean. Above it the high power dominates and reduces the largest
/// error.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Norm {
    /// Error at which both terms are equal, metres.
    pub knee: f64,
    pub power: i32,
}

impl Norm {
    pub fn of(self, error: f64) -> f64 {
        error * error * (1.0 + (error / self.knee).powi(self.power - 2))
    }

    /// Returns the norm for errors whose knee is lower by this factor.
    fn stricter(self, strictness: f64) -> Self {
        Self {
            knee: self.knee / strictness,
            ..self
        }
    }

    /// Returns the weight of a residual with which weighted squares have the norm's gradient.
    fn weight(self, error: f64) -> f64 {
        1.0 + 0.5 * f64::from(self.power) * (error / self.knee).powi(self.power - 2)
    }
}

impl Surface<'_> {
    /// Returns the cost of an error at a sample.
    pub fn cost(&self, norm: Norm, sample: u32, error: f64) -> f64 {
        let s = sample as usize;
        self.importance[s] * norm.stricter(self.strictness[s]).of(error)
    }
}

/// Effort of a polish.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PolishOptions {
    pub rounds: usize,
    /// Points on each sphere whose exposed part must lie on the mesh.
    pub ball_points: usize,
}

/// Weight of the exposed part of a sphere against the samples that it owns.
const EXPOSED: f64 = 1.0;
/// Longest step of a sphere in one round, as a share of its radius.
const LONGEST: f64 = 0.25;

/// Moves `spheres[..movable]`; the others take part but do not move. Returns the cost of the best state and, per
/// sample, distance to and index of the nearest sphere.
pub(crate) fn polish(
    surface: &Surface<'_>,
    spheres: &mut [Sphere],
    movable: usize,
    norm: Norm,
    options: &PolishOptions,
) -> (f64, Owned) {
    let mut owned = assign(surface, spheres, None);
    let mut best = (f64::INFINITY, spheres.to_vec(), owned.clone());
    for round in 0..=options.rounds {
        let exposed = exposed(surface, spheres, movable, options.ball_points, norm.knee);
        let cost = cost(surface, &owned, &exposed, norm);
        if cost < best.0 {
            best = (cost, spheres.to_vec(), owned.clone());
        }
        if round == options.rounds {
            break;
        }
        let mine = shares(&owned, spheres.len());
        let moved = parallel::map(movable, |k| {
            step(surface, &spheres[k], &mine[k], &exposed[k], norm)
        });
        spheres[..movable].copy_from_slice(&moved);
        owned = assign(surface, spheres, Some(&owned));
    }
    spheres.copy_from_slice(&best.1);
    (best.0, best.2)
}

/// Distance to the nearest sphere's surface and that sphere, per sample.
pub(crate) type Owned = Vec<(f64, u32)>;

/// Returns the distance to and index of the nearest sphere, per sample.
pub(crate) fn assign(surface: &Surface<'_>, spheres: &[Sphere], before: Option<&Owned>) -> Owned {
    let index = NearestSphere::new(spheres);
    parallel::map(surface.samples.len(), |s| {
        index.nearest(&surface.samples[s].point, before.map(|owned| owned[s].1))
    })
}

/// Returns the samples of each sphere.
pub(crate) fn shares(owned: &[(f64, u32)], spheres: usize) -> Vec<Vec<u32>> {
    let mut mine = vec![Vec::new(); spheres];
    for (sample, (_, k)) in owned.iter().enumerate() {
        mine[*k as usize].push(sample as u32);
    }
    mine
}

/// Returns the root mean square of the error, metres.
pub(crate) fn rms_of(surface: &Surface<'_>, owned: &[(f64, u32)]) -> f64 {
    let (mut sum, mut weight) = (0.0, 0.0);
    for ((gap, _), w) in owned.iter().zip(surface.importance) {
        sum += w * gap * gap;
        weight += w;
    }
    (sum / weight).sqrt().max(1e-9)
}

fn cost(surface: &Surface<'_>, owned: &Owned, exposed: &[Vec<Exposed>], norm: Norm) -> f64 {
    let own: f64 = owned
        .iter()
        .zip(0..)
        .map(|((gap, _), s)| surface.cost(norm, s, *gap))
        .sum();
    let out: f64 = exposed
        .iter()
        .flatten()
        .map(|e| e.weight * norm.of(e.off))
        .sum();
    own + out
}

/// A point of a sphere's surface that no other sphere covers.
struct Exposed {
    /// Signed distance to the mesh, metres.
    off: f64,
    /// Its gradient.
    gradient: Vec3,
    /// Unit direction from the sphere's centre.
    out: Vec3,
    weight: f64,
}

fn exposed(
    surface: &Surface<'_>,
    spheres: &[Sphere],
    movable: usize,
    points: usize,
    deepest: f64,
) -> Vec<Vec<Exposed>> {
    let index = NearestSphere::new(spheres);
    let area = surface.distance.mesh().area() / surface.samples.len() as f64;
    parallel::map(movable, |k| {
        let sphere = &spheres[k];
        let share = 4.0 * std::f64::consts::PI * sphere.radius * sphere.radius / points as f64;
        ball_points(sphere, points)
            .filter(|p| !index.covered(p, k as u32))
            .map(|p| (p, surface.distance.nearest(&p)))
            // Deeper points line a cavity inside, which no tool can touch.
            .filter(|(_, near)| near.signed > -deepest)
            .map(|(p, near)| {
                let off = near.signed;
                let gradient = if off.abs() > 1e-12 {
                    (p - near.point) / off
                } else {
                    surface.distance.face_normal(near.triangle)
                };
                Exposed {
                    off,
                    gradient,
                    out: (p - sphere.centre) / sphere.radius,
                    weight: EXPOSED * (share / area).min(10.0),
                }
            })
            .collect()
    })
}

/// Makes one damped Gauss-Newton step of one sphere, halved until the cost falls.
fn step(
    surface: &Surface<'_>,
    sphere: &Sphere,
    mine: &[u32],
    exposed: &[Exposed],
    norm: Norm,
) -> Sphere {
    if mine.is_empty() {
        return *sphere;
    }
    let (mut hessian, mut gradient) = (Matrix4::zeros(), Vector4::zeros());
    let mut add = |row: Vector4<f64>, error: f64, w: f64, norm: Norm| {
        let w = w * norm.weight(error);
        hessian += row * row.transpose() * w;
        gradient += row * (w * error);
    };
    for &s in mine {
        let between = surface.samples[s as usize].point - sphere.centre;
        let apart = between.norm();
        if apart < 1e-12 {
            continue;
        }
        let u = between / apart;
        add(
            Vector4::new(-u.x, -u.y, -u.z, -1.0),
            apart - sphere.radius,
            surface.importance[s as usize],
            norm.stricter(surface.strictness[s as usize]),
        );
    }
    for e in exposed {
        let g = e.gradient;
        add(
            Vector4::new(g.x, g.y, g.z, g.dot(&e.out)),
            e.off,
            e.weight,
            norm,
        );
    }
    let damping = 1e-3 * hessian.trace();
    hessian += Matrix4::identity() * damping;
    let Some(factor) = hessian.cholesky() else {
        return *sphere;
    };
    let mut step = -factor.solve(&gradient);
    let length = step.norm();
    if length > LONGEST * sphere.radius {
        step *= LONGEST * sphere.radius / length;
    }
    let value = |candidate: &Sphere| -> f64 {
        let own: f64 = mine
            .iter()
            .map(|&s| {
                let apart = (surface.samples[s as usize].point - candidate.centre).norm();
                surface.cost(norm, s, apart - candidate.radius)
            })
            .sum();
        let (dc, dr) = (
            candidate.centre - sphere.centre,
            candidate.radius - sphere.radius,
        );
        let out: f64 = exposed
            .iter()
            .map(|e| {
                let off = e.off + e.gradient.dot(&(dc + e.out * dr));
                e.weight * norm.of(off)
            })
            .sum();
        own + out
    };
    let now = value(sphere);
    for _ in 0..4 {
        let candidate = Sphere {
            centre: sphere.centre + step.xyz(),
            radius: sphere.radius + step.w,
        };
        if candidate.radius > surface.smallest
            && value(&candidate) < now
            && surface.distance.signed(&candidate.centre) < 0.0
        {
            return candidate;
        }
        step *= 0.5;
    }
    *sphere
}
