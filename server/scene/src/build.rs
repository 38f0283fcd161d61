//! From a closed mesh to a sphere tree, top down.
//!
//! A node owns a share of the surface samples. Its children share them out by `cluster`,
//! each child is one ball fitted to its share by `fit`. Distances are true distances to
//! the mesh. The result is a function of mesh and options alone: seeds are fixed per node, and
//! threads only ever compute whole nodes.

use serde::{Deserialize, Serialize};
use sulcus_core::{Node, Sphere, SphereTree, TreeError, Vec3};

use crate::cluster::{Feature, split};
use crate::distance::MeshDistance;
use crate::fit::fit;
use crate::medial::inscribed_centre;
use crate::polish::{PolishOptions, Surface, polish};
use crate::mesh::TriMesh;
use crate::random::Random;
use crate::{parallel, sample};

/// Changes whenever the same input gives another tree; part of the cache key.
pub const BUILDER_VERSION: u32 = 1;

/// Ways of sharing out that are tried for each node.
const TRIES: usize = 4;
/// Times that samples then move to the ball that they fit best.
const ROUNDS: usize = 3;

/// How a tree is built.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TreeOptions {
    /// Finest level, 1 to 6. Level L holds at most 8^L spheres.
    pub levels: u8,
    /// Samples spread over the surface. At least ten for each sphere of the finest level.
    pub samples: usize,
    /// Weight of place against inscribed-ball centre when samples are shared out, 0 to 1. 0.4 for
    /// bulky things and discs, near 0 for rods.
    pub alpha: f64,
    /// A node that fits its samples better than this is not split, metres.
    pub good_enough: f64,
}

impl Default for TreeOptions {
    fn default() -> Self {
        Self {
            levels: 4,
            samples: 60_000,
            alpha: 0.4,
            good_enough: 1e-6,
        }
    }
}

/// Options with which no tree can be built.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum TreeBuildError {
    /// An option is out of range.
    #[error("{field} is {found}, expected {expected}")]
    Option {
        /// Which option.
        field: &'static str,
        /// Its value.
        found: f64,
        /// What it must be.
        expected: &'static str,
    },
    /// The fitted spheres do not form a tree. A defect of the builder.
    #[error("the fitted spheres are not a tree: {0}")]
    Tree(#[from] TreeError),
}

struct Share {
    members: Vec<u32>,
    sphere: Sphere,
    /// Children in the next level.
    first_child: u32,
    children: u8,
}

/// Weights of place against inscribed-ball centre that are tried when samples are shared out: rods are
/// cut along their axis by the centres, discs and bulky things by both.
const ALPHAS: [f64; 4] = [0.4, 0.02, 0.2, 0.7];

struct Builder<'a> {
    surface: Surface<'a>,
    /// Inscribed-ball centre of each sample.
    centres: &'a [Vec3],
    options: &'a TreeOptions,
}

/// Builds the tree of a mesh that passed [`crate::check::check`]. `progress` gets a stage and how
/// much of the whole is done, 0 to 1.
///
/// # Errors
/// If an option is out of range.
pub fn build_tree(
    mesh: &TriMesh,
    options: &TreeOptions,
    progress: &dyn Fn(&str, f64),
) -> Result<SphereTree, TreeBuildError> {
    options.validate()?;
    let distance = MeshDistance::new(mesh.clone());
    let samples = sample::surface(&distance, options.samples, 0.0);
    let (low, high) = mesh.bounds();
    let size = (high - low).norm();
    progress("inscribed balls", 0.02);
    let centres: Vec<Vec3> = parallel::map(samples.len(), |s| {
        inscribed_centre(&distance, &samples[s], 0.5 * size)
    });
    let importance = vec![1.0; samples.len()];
    let builder = Builder {
        surface: Surface {
            distance: &distance,
            samples: &samples,
            importance: &importance,
            smallest: 1e-6 * size,
        },
        centres: &centres,
        options,
    };
    let mut density = importance.clone();
    let adapt: usize = std::env::var("ADAPT").ok().and_then(|v| v.parse().ok()).unwrap_or(1);
    for _ in 0..adapt {
        let levels = builder.levels(&density, options.levels.min(3), progress);
        builder.adapt(&levels, &mut density);
    }
    let levels = builder.levels(&density, options.levels, progress);
    progress("spheres", 1.0);
    tree(&levels)
}

impl Builder<'_> {
    fn fitted(
        &self,
        members: &[u32],
        start: Option<Sphere>,
        random: &mut Random,
    ) -> (f64, Sphere) {
        fit(
            self.surface.distance,
            self.surface.samples,
            self.centres,
            members,
            start,
            self.surface.smallest,
            random,
        )
    }

    fn levels(&self, density: &[f64], depth: u8, progress: &dyn Fn(&str, f64)) -> Vec<Vec<Share>> {
        let all: Vec<u32> = (0..self.surface.samples.len() as u32).collect();
        let sphere = self.fitted(&all, None, &mut Random::new(0)).1;
        let mut levels = vec![vec![Share {
            members: all,
            sphere,
            first_child: 0,
            children: 0,
        }]];
        for level in 1..=depth {
            progress(
                "spheres",
                0.3 + 0.7 * f64::from(level - 1) / f64::from(self.options.levels),
            );
            let parents = &levels[usize::from(level) - 1];
            let families = parallel::map(parents.len(), |index| {
                self.family(&parents[index], level, index, density)
            });
            let mut children = Vec::new();
            for (parent, family) in levels[usize::from(level) - 1].iter_mut().zip(families) {
                parent.first_child = children.len() as u32;
                parent.children = family.len() as u8;
                children.extend(family.into_iter().map(|(members, sphere)| Share {
                    members,
                    sphere,
                    first_child: 0,
                    children: 0,
                }));
            }
            if children.is_empty() {
                break;
            }
            levels.push(children);
            self.polish(&mut levels);
        }
        levels
    }

    /// Moves the finest level as a whole and shares its samples out anew.
    fn polish(&self, levels: &mut [Vec<Share>]) {
        let Some((finest, above)) = levels.split_last_mut() else {
            return;
        };
        let movable = finest.len();
        let mut spheres: Vec<Sphere> = finest.iter().map(|share| share.sphere).collect();
        spheres.extend(
            above
                .iter()
                .flatten()
                .filter(|share| share.children == 0)
                .map(|share| share.sphere),
        );
        let rounds: usize = std::env::var("ROUNDS").ok().and_then(|v| v.parse().ok()).unwrap_or(12);
        let options = PolishOptions {
            rounds,
            ball_points: 96,
        };
        let owner = polish(&self.surface, &mut spheres, movable, &options);
        for share in finest.iter_mut() {
            share.members.clear();
        }
        for (sample, k) in owner.iter().enumerate() {
            if let Some(share) = finest.get_mut(*k as usize) {
                share.members.push(sample as u32);
            }
        }
        for (share, sphere) in finest.iter_mut().zip(&spheres) {
            share.sphere = *sphere;
        }
    }

    /// Children of a node, with the samples that they own.
    fn family(
        &self,
        parent: &Share,
        level: u8,
        index: usize,
        density: &[f64],
    ) -> Vec<(Vec<u32>, Sphere)> {
        let samples = self.surface.samples;
        if parent.members.len() < 16
            || worst(&parent.members, &parent.sphere, samples) < self.options.good_enough
        {
            return Vec::new();
        }
        let mut random = Random::new((u64::from(level) << 32) | index as u64);
        let weights: Vec<f64> = parent.members.iter().map(|&m| density[m as usize]).collect();
        // The best of a few ways to share out.
        let mut best = (f64::INFINITY, Vec::new());
        // Below level 3 the shape is fine enough for fewer tries to do.
        let rounds = if level > 3 { 1 } else { ROUNDS };
        let tries = if level > 3 { 2 } else { TRIES };
        for alpha in &ALPHAS[..tries] {
            let features: Vec<Feature> = parent
                .members
                .iter()
                .map(|&m| {
                    let (p, c) = (
                        samples[m as usize].point * *alpha,
                        self.centres[m as usize] * (1.0 - alpha),
                    );
                    [p.x, p.y, p.z, c.x, c.y, c.z]
                })
                .collect();
            let split = split(&features, &weights, 8, &mut random);
            let mut parts: Vec<_> = split
                .into_iter()
                .map(|part| {
                    let members: Vec<u32> = part.iter().map(|&k| parent.members[k as usize]).collect();
                    (members, None)
                })
                .collect();
            for round in 0..=rounds {
                let mut cost = 0.0;
                let mut family: Vec<(Vec<u32>, Sphere)> = Vec::with_capacity(parts.len());
                for (part, start) in parts {
                    let (own, sphere) = self.fitted(&part, start, &mut random);
                    cost += own * part.iter().map(|&m| density[m as usize]).sum::<f64>();
                    family.push((part, sphere));
                }
                parts = if round < rounds {
                    reshared(&family, samples)
                } else {
                    Vec::new()
                };
                if cost < best.0 {
                    best = (cost, family);
                }
            }
        }
        best.1
    }

    /// Where spheres of the finest level fit badly, samples shall count for more when they are shared
    /// out, so that all fit alike. The error of a sphere grows with the area it stands for.
    fn adapt(&self, levels: &[Vec<Share>], density: &mut [f64]) {
        let gamma: f64 = std::env::var("GAMMA").ok().and_then(|v| v.parse().ok()).unwrap_or(0.7);
        let Some(finest) = levels.last() else { return };
        let samples = self.surface.samples;
        let mut wanted = vec![0.0; finest.len()];
        for (wanted, share) in wanted.iter_mut().zip(finest) {
            let mut sum = 0.0;
            for &m in &share.members {
                let off = (samples[m as usize].point - share.sphere.centre).norm() - share.sphere.radius;
                sum += (off * off) * (off * off);
            }
            let n = share.members.len().max(1) as f64;
            *wanted = libm::pow(sum / n, 0.25) / n;
        }
        let mut sorted = wanted.clone();
        sorted.sort_by(f64::total_cmp);
        let middle = sorted[sorted.len() / 2];
        for (wanted, share) in wanted.iter().zip(finest) {
            let factor = (wanted / middle).powf(gamma).clamp(0.1, 10.0);
            for &m in &share.members {
                density[m as usize] = factor;
            }
        }
    }
}

/// Gives each sample to the ball of the family whose surface is nearest.
fn reshared(
    family: &[(Vec<u32>, Sphere)],
    samples: &[sample::Sample],
) -> Vec<(Vec<u32>, Option<Sphere>)> {
    let mut parts: Vec<_> = family
        .iter()
        .map(|(_, sphere)| (Vec::new(), Some(*sphere)))
        .collect();
    for &member in family.iter().flat_map(|(members, _)| members) {
        let point = samples[member as usize].point;
        let mut best = (f64::INFINITY, 0);
        for (k, (_, sphere)) in family.iter().enumerate() {
            let off = ((point - sphere.centre).norm() - sphere.radius).abs();
            if off < best.0 {
                best = (off, k);
            }
        }
        parts[best.1].0.push(member);
    }
    parts.retain(|part| !part.0.is_empty());
    parts
}

/// Largest distance of a sample from the ball's surface, metres.
fn worst(members: &[u32], sphere: &Sphere, samples: &[sample::Sample]) -> f64 {
    members.iter().fold(0.0, |worst, &m| {
        let off = ((samples[m as usize].point - sphere.centre).norm() - sphere.radius).abs();
        if off > worst { off } else { worst }
    })
}

fn tree(levels: &[Vec<Share>]) -> Result<SphereTree, TreeBuildError> {
    let mut nodes = Vec::with_capacity(levels.iter().map(Vec::len).sum());
    for (level, shares) in levels.iter().enumerate() {
        let next_level = (nodes.len() + shares.len()) as u32;
        nodes.extend(shares.iter().map(|share| Node {
            centre: share.sphere.centre,
            contact_radius: share.sphere.radius,
            bound_radius: share.sphere.radius,
            first_child: if share.children > 0 {
                next_level + share.first_child
            } else {
                0
            },
            children: share.children,
            level: level as u8,
        }));
    }
    Ok(SphereTree::with_bounds(nodes)?)
}

impl TreeOptions {
    fn validate(&self) -> Result<(), TreeBuildError> {
        let checks = [
            (
                "levels",
                f64::from(self.levels),
                (1..=6).contains(&self.levels),
                "1 to 6",
            ),
            (
                "samples",
                self.samples as f64,
                (500..=2_000_000).contains(&self.samples),
                "500 to 2000000",
            ),
            (
                "alpha",
                self.alpha,
                (0.0..=1.0).contains(&self.alpha),
                "0 to 1",
            ),
            (
                "good_enough",
                self.good_enough,
                (0.0..=1e-3).contains(&self.good_enough),
                "0 to 1e-3 m",
            ),
        ];
        match checks.into_iter().find(|check| !check.2) {
            Some((field, found, _, expected)) => Err(TreeBuildError::Option {
                field,
                found,
                expected,
            }),
            None => Ok(()),
        }
    }
}
