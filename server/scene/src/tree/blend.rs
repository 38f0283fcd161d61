//! Calibration of a sphere tree for contact with its blended surface ([`sulcus_core::blend`]): a blend length for
//! each level, an inset for each sphere.
//!
//! A union of spheres with zero mean error crosses the mesh: its bumps are outside, its valleys inside. A smooth
//! surface without bias must pass through the bumps. Blended spheres are therefore smaller than hard ones, by the
//! inset.
//!
//! The choice of lengths follows this theory of a lattice of pitch `s` whose spheres are more curved than the surface
//! by `K`.
//!
//! - The bumps are `K s^2 / 8` high.
//! - The exponential blend weighs the spheres like a Gaussian of variance `kappa / K` along the surface.
//! - The remaining bumps fall as `exp(-2 pi^2 kappa / (K s^2))`: a few per cent at `kappa` of twice their height.
//!
//! The insets are found from the mesh. They minimise the sum of squared blended gaps of a probing sphere rolled over
//! the mesh.
//!
//! The method is Gauss-Newton, each step by conjugate gradients on the sparse normal equations.

use serde::Serialize;
use sulcus_core::blend::compatibility;
use sulcus_core::{Blending, SphereTree, TreeError, Vec3};

use crate::mesh::distance::MeshDistance;
use crate::mesh::sample;
use crate::parallel;

/// Options of a calibration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BlendOptions {
    /// Blend length per mean absolute error of the hard spheres, 1 to 30. Default 4: the bump height of a regular
    /// lattice, whose mean absolute error is a quarter of it.
    ///
    /// A larger length is smoother. Then cores lie deeper below the surface, rows have more spheres, and corners are
    /// rounder.
    pub blend_per_error: f64,
    /// Radius of the sphere that probes the surface, metres. Default 2.5e-4, a periodontal probe's tip.
    pub probe_radius: f64,
    /// Probed places for each sphere of a level. Default 30.
    pub samples_per_sphere: usize,
    /// Coarsest level that is blended. Default 2: the levels above it serve culling only.
    pub coarsest: u8,
    /// Finest level that is blended. Default 4: spheres of level 5 stand out by a micrometre, which is imperceptible,
    /// and cost less if they are hard.
    pub finest: u8,
}

impl Default for BlendOptions {
    fn default() -> Self {
        Self {
            blend_per_error: 4.0,
            probe_radius: 2.5e-4,
            samples_per_sphere: 30,
            coarsest: 2,
            finest: 4,
        }
    }
}

/// Gauss-Newton steps.
const ROUNDS: usize = 8;
/// Conjugate-gradient steps in each.
const STEPS: usize = 30;
/// Weight of the change of the insets against the sum of squares, for each probed place.
const DAMPING: f64 = 3e-3;
/// Search radius around a probed place, in blend lengths. Insets reach 3, and a sphere more than 8 beyond has no
/// weight.
const AROUND: f64 = 11.0;
/// Largest inset of a sphere as a share of its radius.
const MOST_OF_RADIUS: f64 = 0.8;
/// Least number of probed places of a level.
const FEWEST_SAMPLES: usize = 4000;

/// A probed place of the surface, with the spheres near it.
struct Place {
    /// Target gap of a probing sphere there, metres: 0 if the normal leads straight out.
    target: f64,
    near: Vec<Near>,
}

#[derive(Clone, Copy)]
struct Near {
    sphere: u32,
    /// Distance from the probing sphere's centre, metres.
    distance: f64,
    /// Direction towards it.
    normal: Vec3,
}

/// Returns `tree` with blend lengths and insets for the mesh in `distance`, in the same frame. The result is a
/// function of the input alone.
///
/// # Errors
/// [`TreeError`] if an option is not a number.
pub fn calibrate(
    tree: &SphereTree,
    distance: &MeshDistance,
    options: &BlendOptions,
) -> Result<SphereTree, TreeError> {
    let mut blending = Blending {
        lengths: vec![0.0; usize::from(tree.depth()) + 1],
        insets: vec![0.0; tree.nodes().len()],
    };
    for level in options.coarsest..=tree.depth().min(options.finest) {
        let ids: Vec<u32> = tree.shape_at(level).map(|(id, _)| id).collect();
        let count = (options.samples_per_sphere * ids.len()).max(FEWEST_SAMPLES);
        let samples = sample::surface(distance, count, 0.25);
        let errors = parallel::map(samples.len(), |s| {
            hard_gap(tree, level, &samples[s].point).abs()
        });
        let blend =
            options.blend_per_error * errors.iter().sum::<f64>() / errors.len().max(1) as f64;
        blending.lengths[usize::from(level)] = blend;
        if blend < sulcus_core::tree::MIN_BLEND {
            blending.lengths[usize::from(level)] = 0.0;
            continue;
        }
        let places = places(tree, level, blend, &samples, distance, options.probe_radius);
        let mut insets: Vec<f64> = vec![0.0; tree.nodes().len()];
        let mut own = vec![false; tree.nodes().len()];
        for &id in &ids {
            let node = &tree.nodes()[id as usize];
            own[id as usize] = node.level == level;
            // A leaf from above keeps its inset, reduced like its blend length.
            let above = blending.lengths[usize::from(node.level)];
            if node.level < level && above > 0.0 {
                insets[id as usize] = blending.insets[id as usize] * (blend / above).min(1.0);
            }
        }
        fit(
            tree,
            blend,
            options.probe_radius,
            &places,
            &own,
            &mut insets,
        );
        for (id, _) in own.iter().enumerate().filter(|(_, own)| **own) {
            blending.insets[id] = insets[id];
        }
    }
    // A tree without blended levels is a plain one, as it is when it comes from the cache.
    if blending.lengths.iter().all(|length| *length == 0.0) {
        return Ok(tree.clone());
    }
    tree.clone().with_blending(blending)
}

/// Returns the distance from the union of the hard spheres of a level.
fn hard_gap(tree: &SphereTree, level: u8, point: &Vec3) -> f64 {
    let nodes = tree.nodes();
    let mut least = f64::INFINITY;
    let mut stack = vec![0_u32];
    while let Some(id) = stack.pop() {
        let node = &nodes[id as usize];
        let from = (point - node.centre).norm();
        if node.is_shape_at(level) {
            least = least.min(from - node.contact_radius);
        } else if from - node.bound_radius < least {
            stack.extend(node.first_child..node.first_child + u32::from(node.children));
        }
    }
    least
}

/// Returns the spheres of a level whose surface is within `within` of `point`, by index.
fn near(tree: &SphereTree, level: u8, point: &Vec3, within: f64) -> Vec<Near> {
    let nodes = tree.nodes();
    let mut found = Vec::new();
    let mut stack = vec![0_u32];
    while let Some(id) = stack.pop() {
        let node = &nodes[id as usize];
        let between = point - node.centre;
        let from = between.norm();
        if node.is_shape_at(level) {
            if from - node.contact_radius < within {
                found.push(Near {
                    sphere: id,
                    distance: from,
                    normal: between / from.max(1e-12),
                });
            }
        } else if from - node.bound_radius < within {
            stack.extend(node.first_child..node.first_child + u32::from(node.children));
        }
    }
    found.sort_unstable_by_key(|near| near.sphere);
    found
}

fn places(
    tree: &SphereTree,
    level: u8,
    blend: f64,
    samples: &[sample::Sample],
    distance: &MeshDistance,
    radius: f64,
) -> Vec<Place> {
    parallel::map(samples.len(), |s| {
        let at = samples[s].point + samples[s].normal * radius;
        Place {
            target: distance.signed(&at) - radius,
            near: near(tree, level, &at, radius + AROUND * blend),
        }
    })
    .into_iter()
    // In a cleft narrower than itself the probing sphere has no place.
    .filter(|place| !place.near.is_empty() && place.target > -0.1 * radius - 1e-9)
    .collect()
}

/// Returns the blended gap of a probing sphere from its nearest sphere, and the weight of each of `near`.
fn blended(
    tree: &SphereTree,
    blend: f64,
    radius: f64,
    near: &[Near],
    inset: impl Fn(u32) -> f64,
    seed: Option<usize>,
) -> (f64, Vec<f64>) {
    let gap = |n: &Near| {
        n.distance - (tree.nodes()[n.sphere as usize].contact_radius - inset(n.sphere)) - radius
    };
    let gaps: Vec<f64> = near.iter().map(gap).collect();
    let nearest = (0..near.len())
        .min_by(|&a, &b| gaps[a].total_cmp(&gaps[b]))
        .unwrap_or(0);
    let seed = seed.unwrap_or(nearest);
    let mut weights: Vec<f64> = near
        .iter()
        .zip(&gaps)
        .map(|(n, gap)| {
            let cosine = n.normal.dot(&near[seed].normal);
            compatibility(
                cosine,
                n.distance.min(near[seed].distance),
                gap - gaps[seed],
                blend,
            ) * libm::exp((gaps[nearest] - gap) / blend)
        })
        .collect();
    let sum: f64 = weights.iter().sum();
    weights.iter_mut().for_each(|w| *w /= sum);
    (gaps[nearest] - blend * libm::log(sum), weights)
}

/// Returns the insets that bring the blended gap at every place closest to its target.
fn fit(
    tree: &SphereTree,
    blend: f64,
    radius: f64,
    places: &[Place],
    own: &[bool],
    insets: &mut [f64],
) {
    for _ in 0..ROUNDS {
        let seen: Vec<(f64, Vec<(u32, f64)>)> = parallel::map(places.len(), |p| {
            let place = &places[p];
            let inset = |id: u32| insets[id as usize];
            let (gap, weights) = blended(tree, blend, radius, &place.near, inset, None);
            let kept = place
                .near
                .iter()
                .zip(weights)
                .filter(|(n, w)| *w > 1e-5 && own[n.sphere as usize])
                .map(|(n, w)| (n.sphere, w))
                .collect();
            (place.target - gap, kept)
        });
        // Number of places per sphere of the level; the damping must not depend on it.
        let spheres = own.iter().filter(|own| **own).count().max(1);
        let damping = DAMPING * places.len() as f64 / spheres as f64;
        let times = |x: &[f64]| {
            let mut y: Vec<f64> = x.iter().map(|x| damping * x).collect();
            for (_, weights) in &seen {
                let along: f64 = weights.iter().map(|&(id, w)| w * x[id as usize]).sum();
                for &(id, w) in weights {
                    y[id as usize] += w * along;
                }
            }
            y
        };
        let mut right = vec![0.0; insets.len()];
        for (missing, weights) in &seen {
            for &(id, w) in weights {
                right[id as usize] += w * missing;
            }
        }
        let step = conjugate_gradients(times, right);
        for (id, (inset, step)) in insets.iter_mut().zip(&step).enumerate() {
            if own[id] {
                let most = MOST_OF_RADIUS * tree.nodes()[id].contact_radius;
                *inset = (*inset + step).clamp(0.0, most);
            }
        }
    }
}

/// Solves `times(x) = right` for a symmetric positive definite `times`, starting at 0.
fn conjugate_gradients(times: impl Fn(&[f64]) -> Vec<f64>, right: Vec<f64>) -> Vec<f64> {
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let mut x = vec![0.0; right.len()];
    let mut residual = right;
    let mut direction = residual.clone();
    let mut squared = dot(&residual, &residual);
    let enough = squared * 1e-16;
    for _ in 0..STEPS {
        if squared <= enough || squared == 0.0 {
            break;
        }
        let image = times(&direction);
        let share = squared / dot(&direction, &image);
        for k in 0..x.len() {
            x[k] += share * direction[k];
            residual[k] -= share * image[k];
        }
        let next = dot(&residual, &residual);
        for (d, r) in direction.iter_mut().zip(&residual) {
            *d = r + next / squared * *d;
        }
        squared = next;
    }
    x
}

/// Error of a level's blended surface, millimetres.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct BlendError {
    /// The level.
    pub level: u8,
    /// Blend length.
    pub blend: f64,
    /// Mean inset.
    pub inset: f64,
    /// Bias: mean of the blended gap of a probing sphere that touches the mesh.
    pub bias: f64,
    /// Mean absolute blended gap.
    pub mean: f64,
    /// Root mean square.
    pub rms: f64,
    /// 95th percentile of its absolute value.
    pub p95: f64,
    /// Its largest absolute value.
    pub max: f64,
}

/// Measures the blended surface of one level against the mesh in `distance`.
///
/// A sphere of `radius` (metres) is rolled over the outside, at places that the calibration did not use.
pub fn blend_error(
    tree: &SphereTree,
    level: u8,
    distance: &MeshDistance,
    radius: f64,
) -> BlendError {
    const PLACES: usize = 20_000;
    let blend = tree.blend_at(level);
    let samples = sample::surface(distance, PLACES, 0.6);
    let inset = |id: u32| tree.nodes()[id as usize].contact_radius - tree.core_radius(id, level);
    let insets: Vec<f64> = tree.shape_at(level).map(|(id, _)| inset(id)).collect();
    // Hard spheres within a few of their errors.
    let around = if blend > 0.0 { blend } else { 1e-4 };
    let places = places(tree, level, around, &samples, distance, radius);
    let gaps = parallel::map(places.len(), |p| {
        let near = &places[p].near;
        let gap = if blend > 0.0 {
            (0..near.len())
                .map(|seed| blended(tree, blend, radius, near, inset, Some(seed)).0)
                .fold(f64::INFINITY, f64::min)
        } else {
            let gaps = near
                .iter()
                .map(|n| n.distance - tree.nodes()[n.sphere as usize].contact_radius - radius);
            gaps.fold(f64::INFINITY, f64::min)
        };
        (gap - places[p].target) * 1e3
    });
    let n = gaps.len().max(1) as f64;
    let mut sizes: Vec<f64> = gaps.iter().map(|gap| gap.abs()).collect();
    sizes.sort_by(f64::total_cmp);
    let at = |share: usize| {
        sizes
            .get(sizes.len().saturating_sub(1) * share / 100)
            .copied()
            .unwrap_or(0.0)
    };
    BlendError {
        level,
        blend: blend * 1e3,
        inset: 1e3 * insets.iter().sum::<f64>() / insets.len().max(1) as f64,
        bias: gaps.iter().sum::<f64>() / n,
        mean: sizes.iter().sum::<f64>() / n,
        rms: (gaps.iter().map(|gap| gap * gap).sum::<f64>() / n).sqrt(),
        p95: at(95),
        max: at(100),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::shapes::{cuboid, ellipsoid};
    use crate::tree::build::{TreeOptions, build_tree};

    fn levels_of(mesh: crate::mesh::TriMesh) -> (SphereTree, SphereTree, MeshDistance) {
        let options = TreeOptions {
            levels: 3,
            samples: 8000,
            ..TreeOptions::default()
        };
        let hard = build_tree(&mesh, &options, &|_, _| ()).expect("tree");
        let distance = MeshDistance::new(mesh);
        let options = BlendOptions {
            samples_per_sphere: 20,
            ..BlendOptions::default()
        };
        let blended = calibrate(&hard, &distance, &options).expect("a tree stays a tree");
        (hard, blended, distance)
    }

    #[test]
    fn a_calibrated_surface_is_without_bias_and_nearer_to_the_mesh() {
        let (hard, blended, distance) = levels_of(ellipsoid(Vec3::new(8e-3, 5e-3, 3e-3), 4));
        assert_eq!(
            hard.nodes(),
            blended.nodes(),
            "the spheres stay where they are"
        );
        for level in [2, 3] {
            let before = blend_error(&hard, level, &distance, 2.5e-4);
            let after = blend_error(&blended, level, &distance, 2.5e-4);
            println!("{before:?}\n{after:?}");
            assert!(blended.blend_at(level) > 0.0);
            assert!(after.bias.abs() < 0.1 * before.mean, "{before:?} {after:?}");
            assert!(after.mean < 0.8 * before.mean, "{before:?} {after:?}");
        }
        // Levels above serve culling only.
        assert_eq!(blended.blend_at(1), 0.0);
        assert_eq!(blended.blending().insets[0], 0.0);
    }

    #[test]
    fn sharp_edges_stay_within_the_error_of_the_hard_spheres() {
        let (hard, blended, distance) = levels_of(cuboid(Vec3::new(6e-3, 4e-3, 3e-3)));
        let before = blend_error(&hard, 3, &distance, 2.5e-4);
        let after = blend_error(&blended, 3, &distance, 2.5e-4);
        println!("{before:?}\n{after:?}");
        assert!(after.rms <= 1.2 * before.rms, "{before:?} {after:?}");
    }

    #[test]
    fn the_same_tree_twice_is_calibrated_to_the_same_bits() {
        let mesh = ellipsoid(Vec3::new(8e-3, 5e-3, 3e-3), 3);
        assert_eq!(levels_of(mesh.clone()).1, levels_of(mesh).1);
    }
}
