//! Builder of sphere trees from a closed mesh, top down.
//!
//! A node owns a share of the surface samples. `cluster` distributes them to its children, `fit` fits one ball to
//! each share, and `level` then fits the whole level across families.
//!
//! For an object that deforms as a whole, `volume` makes the two coarsest levels.
//!
//! Distances are true distances to the mesh. The result is a function of mesh and options alone: seeds are fixed for
//! each node, and threads compute whole nodes only.
//!
//! This module and `filled` depend on each other: `filled` uses the options and errors, and the builder checks its
//! tree with `filled`.

use serde::{Deserialize, Serialize};
use sulcus_core::{Node, Sphere, SphereTree, TreeError, Vec3};

use crate::mesh::TriMesh;
use crate::mesh::distance::MeshDistance;
use crate::mesh::edges::Length;
use crate::mesh::sample::Sample;
use crate::parallel;
use crate::random::Random;
use crate::tree::blend::{BlendOptions, calibrate};
use crate::tree::cluster::{Feature, split};
use crate::tree::filled::check_filled;
use crate::tree::fit::fit;
use crate::tree::level::{Effort, Level, finish_level, fit_level};
use crate::tree::nearest_sphere::NearestSphere;
use crate::tree::polish::{assign, shares};
use crate::tree::samples::{Samples, weighted_samples};
use crate::tree::tighten::tighten;
use crate::tree::volume;

/// Version of the builder. It must change if the same input gives another tree.
///
/// The version is part of the key of the trees in `family.bin`. File names of the cache also contain a hash of the
/// builder's sources.
pub const BUILDER_VERSION: u32 = 7;

/// Weights of place against inscribed-ball centre that are compared in the distribution of samples.
///
/// Centres cut rods along their axis; both cut discs and compact shapes.
const ALPHAS: [f64; 4] = [0.4, 0.02, 0.2, 0.7];
/// Rounds in which samples move to the ball of the best fit.
const ROUNDS: usize = 3;
/// Samples for each sphere of a level, level by level.
const SAMPLES_PER_SPHERE: [usize; 7] = [500, 500, 200, 100, 30, 12, 10];
/// Density of the search for errors between the samples, relative to the samples.
const DENSER: usize = 8;
/// Least error of a missed place between samples, as a share of the largest error at the samples.
const MISSED: f64 = 0.9;
/// Cost of a sample without a sphere, in squares of the smallest radius. Its root is a hundredth of the size.
const UNFIT: f64 = 1e8;
/// Least number of samples of a level.
const FEWEST_SAMPLES: usize = 6000;
/// Least number of samples of a node that is split.
const LEAST_SAMPLES: usize = 8;

/// Options of the builder.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TreeOptions {
    /// Finest level, 1 to 6. Level L has at most 8^L spheres.
    pub levels: u8,
    /// Largest number of surface samples of any level, without sharp edges. Coarse levels need fewer.
    ///
    /// By default level 6 has hardly two for each sphere; only few of its spheres are made.
    pub samples: usize,
    /// Error below which a node is not split, metres.
    pub good_enough: f64,
    /// Whether levels 1 and 2 divide the volume instead of following the surface.
    ///
    /// Objects that deform as a whole need it: their skeleton needs inner nodes and a bottom layer.
    pub volumetric: bool,
    /// Whether the tree is calibrated for contact with its blended surface, for rigid objects.
    pub blended: bool,
}

impl Default for TreeOptions {
    fn default() -> Self {
        Self {
            levels: 4,
            samples: 400_000,
            good_enough: 1e-6,
            volumetric: false,
            blended: false,
        }
    }
}

/// Reason why a tree cannot be built.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum TreeBuildError {
    /// An option is out of range.
    #[error("{field} is {found}, expected {expected}")]
    Option {
        /// Name of the option.
        field: &'static str,
        /// Its value.
        found: f64,
        /// Value expected.
        expected: &'static str,
    },
    /// The solid is so thin relative to its size that rounding hides its inside.
    #[error(
        "found no place inside the solid for a sphere, expected one that is thicker than a millionth of its size"
    )]
    TooThin,
    /// The spheres fill another volume than the surface encloses.
    #[error(
        "the spheres of level {level} fill {} mm3 where the mesh encloses {} mm3, expected {less_percent:.0} % less to {more_percent:.0} % more: the surface folds onto or crosses itself, or so few spheres cannot follow it (more levels can)",
        Length(*tree_mm3), Length(*mesh_mm3)
    )]
    Volume {
        /// Volume of the union of the spheres of the finest level, cubic millimetres.
        tree_mm3: f64,
        /// Signed volume of the mesh, cubic millimetres.
        mesh_mm3: f64,
        /// The finest level.
        level: u8,
        /// Tolerance below the mesh's volume, percent.
        less_percent: f64,
        /// Tolerance above it.
        more_percent: f64,
    },
    /// The fitted spheres do not form a tree: a defect of the builder.
    #[error("the fitted spheres do not form a tree: {0}")]
    Tree(#[from] TreeError),
}

struct Share {
    sphere: Sphere,
    /// Children in the next level.
    first_child: u32,
    children: u8,
    /// Whether it lies inside and never has children.
    inner: bool,
}

impl Share {
    fn leaf(sphere: Sphere) -> Self {
        Self {
            sphere,
            first_child: 0,
            children: 0,
            inner: false,
        }
    }
}

/// Builds the tree of a mesh that passed [`crate::mesh::check::check`]. `progress` receives a stage and the share
/// that is done, 0 to 1.
///
/// # Errors
/// [`TreeBuildError`] if an option is out of range, or the volume of the tree differs from the mesh's by more than
/// [`crate::tree::filled::tolerance`].
pub fn build_tree(
    mesh: &TriMesh,
    options: &TreeOptions,
    progress: &dyn Fn(&str, f64),
) -> Result<SphereTree, TreeBuildError> {
    build_weighted(mesh, options, &|_| 1.0, progress)
}

/// Builds the tree of a mesh with more spheres where `importance` is higher. It receives a surface point in metres; 1
/// is ordinary.
///
/// # Errors
/// Errors of [`build_tree`].
pub fn build_weighted(
    mesh: &TriMesh,
    options: &TreeOptions,
    importance: &(dyn Fn(&Vec3) -> f64 + Sync),
    progress: &dyn Fn(&str, f64),
) -> Result<SphereTree, TreeBuildError> {
    options.validate()?;
    let distance = MeshDistance::new(mesh.clone());
    let unfit = mesh
        .vertices
        .iter()
        .map(importance)
        .find(|x| !(1e-9..=1e9).contains(x));
    if let Some(found) = unfit {
        return Err(TreeBuildError::Option {
            field: "importance",
            found,
            expected: "1e-9 to 1e9",
        });
    }
    let builder = Builder {
        distance: &distance,
        importance,
        options,
    };
    let levels = builder.levels(progress)?;
    let tree = tree(&levels)?;
    let middles = (0..mesh.triangles.len()).map(|t| mesh.corners(t).iter().sum::<Vec3>() / 3.0);
    let weighted = mesh
        .vertices
        .iter()
        .copied()
        .chain(middles)
        .any(|place| importance(&place) != 1.0);
    check_filled(&tree, mesh, options, weighted)?;
    if !options.blended {
        progress("spheres", 1.0);
        return Ok(tree);
    }
    progress("blending", 0.95);
    let tree = calibrate(&tree, &distance, &BlendOptions::default())?;
    progress("blending", 1.0);
    Ok(tree)
}

struct Builder<'a> {
    distance: &'a MeshDistance,
    importance: &'a (dyn Fn(&Vec3) -> f64 + Sync),
    options: &'a TreeOptions,
}

impl Builder<'_> {
    /// Returns the number of surface samples of a level.
    fn count(&self, level: u8) -> usize {
        let wanted = SAMPLES_PER_SPHERE[usize::from(level)] * 8_usize.pow(u32::from(level));
        wanted.max(FEWEST_SAMPLES).min(self.options.samples)
    }

    fn samples(&self, level: u8) -> Samples {
        Samples::of(self.distance, self.count(level), self.importance)
    }

    fn levels(&self, progress: &dyn Fn(&str, f64)) -> Result<Vec<Vec<Share>>, TreeBuildError> {
        let samples = self.samples(1);
        let all: Vec<u32> = (0..samples.samples.len() as u32).collect();
        let (cost, sphere) = self.fitted(&samples, &all, None, &mut Random::new(0));
        if !cost.is_finite() {
            return Err(TreeBuildError::TooThin);
        }
        let mut levels = vec![vec![Share::leaf(sphere)]];
        if self.options.volumetric && self.options.levels >= 2 {
            volumetric(self.distance, &samples.samples, &mut levels);
        }
        // The work grows about fivefold from one level to the next.
        let done = |level: u8| libm::pow(5.0, f64::from(level) - f64::from(self.options.levels));
        while levels.len() <= usize::from(self.options.levels) {
            let level = levels.len() as u8;
            progress(&format!("level {level}"), 0.95 * done(level - 1));
            if !self.add_level(&mut levels, self.samples(level)) {
                break;
            }
        }
        Ok(levels)
    }

    /// Splits the nodes of the finest level, fits the children as a whole and appends them. Returns false if every
    /// node is already good enough.
    fn add_level(&self, levels: &mut Vec<Vec<Share>>, mut samples: Samples) -> bool {
        let depth = levels.len() as u8;
        let surface = samples.surface(self.distance);
        let Some((parents, above)) = levels.split_last_mut() else {
            return false;
        };
        let childless = above.iter().flatten().filter(|share| share.children == 0);
        // Inner nodes of a volumetric level belong to the shape below, but have no children.
        let shape: Vec<Sphere> = parents
            .iter()
            .chain(childless)
            .map(|share| share.sphere)
            .collect();
        let owned = match depth {
            1 => vec![(0.0, 0); surface.samples.len()],
            _ => assign(&surface, &shape, None),
        };
        let mine = shares(&owned, shape.len());
        let families = parallel::map(parents.len(), |k| {
            if parents[k].inner {
                Vec::new()
            } else {
                self.family(&samples, &parents[k].sphere, &mine[k], depth, k)
            }
        });
        let mut fitted = Level {
            spheres: Vec::new(),
            families: Vec::new(),
            parents: parents.len(),
        };
        let mut childless: Vec<Sphere> = shape[parents.len()..].to_vec();
        for (k, family) in families.into_iter().enumerate() {
            if family.is_empty() {
                childless.push(shape[k]);
            }
            fitted.families.extend(family.iter().map(|_| k as u32));
            fitted.spheres.extend(family);
        }
        if fitted.spheres.is_empty() {
            return false;
        }
        fitted.spheres.extend(childless);
        let (effort, seed) = (Effort::of(depth), u64::from(depth) << 40);
        fit_level(&surface, &samples.inscribed, &mut fitted, &effort, seed);
        let mut owned = finish_level(&surface, &samples.inscribed, &mut fitted, &effort, seed);
        for _ in 0..effort.exchanges {
            let more = self.missed(depth, &samples, &owned, &fitted.spheres);
            samples.append(more);
            let surface = samples.surface(self.distance);
            owned = finish_level(&surface, &samples.inscribed, &mut fitted, &effort, seed);
        }
        tighten(
            self.distance,
            self.importance,
            &mut samples,
            &mut fitted,
            &effort,
            seed,
        );
        let mut children: Vec<(u32, Share)> = fitted
            .families
            .iter()
            .zip(&fitted.spheres)
            .map(|(family, sphere)| (*family, Share::leaf(*sphere)))
            .collect();
        children.sort_by_key(|(family, _)| *family);
        for (k, (family, _)) in children.iter().enumerate() {
            let parent = &mut parents[*family as usize];
            if parent.children == 0 {
                parent.first_child = k as u32;
            }
            parent.children += 1;
        }
        levels.push(children.into_iter().map(|(_, share)| share).collect());
        true
    }

    /// Returns places between the samples with an error nearly as large as the largest.
    ///
    /// A fit to samples has its largest errors between them: the exchange of Remez, on a surface.
    fn missed(
        &self,
        level: u8,
        samples: &Samples,
        owned: &[(f64, u32)],
        spheres: &[Sphere],
    ) -> Samples {
        let felt = |error: f64, weight: f64| error.abs() * libm::pow(weight, 1.0 / 16.0);
        let largest = owned
            .iter()
            .zip(&samples.weights)
            .fold(0.0, |most, ((gap, _), weight)| {
                felt(*gap, *weight).max(most)
            });
        let index = NearestSphere::new(spheres);
        let (dense, weights) =
            weighted_samples(self.distance, DENSER * self.count(level), self.importance);
        let gaps = parallel::map(dense.len(), |k| index.nearest(&dense[k].point, None).0);
        let mut worst: Vec<usize> = (0..dense.len())
            .filter(|&k| felt(gaps[k], weights[k]) > MISSED * largest)
            .collect();
        worst.sort_by(|&a, &b| gaps[b].abs().total_cmp(&gaps[a].abs()).then(a.cmp(&b)));
        worst.truncate(samples.samples.len() / 4);
        let picked: Vec<Sample> = worst.iter().map(|&k| dense[k]).collect();
        let weights = worst.iter().map(|&k| weights[k]).collect();
        Samples::with(self.distance, picked, weights)
    }

    fn fitted(
        &self,
        samples: &Samples,
        members: &[u32],
        start: Option<Sphere>,
        random: &mut Random,
    ) -> (f64, Sphere) {
        fit(
            self.distance,
            &samples.samples,
            &samples.inscribed,
            members,
            start,
            samples.smallest,
            random,
        )
    }

    /// Returns the first guess of a node's children; none if the node is good enough.
    fn family(
        &self,
        all: &Samples,
        sphere: &Sphere,
        members: &[u32],
        level: u8,
        index: usize,
    ) -> Vec<Sphere> {
        let samples = &all.samples;
        let by_volume = self.options.volumetric && level <= 3;
        if members.len() < LEAST_SAMPLES
            || (!by_volume && worst(members, sphere, samples) < self.options.good_enough)
        {
            return Vec::new();
        }
        let mut random = Random::new((u64::from(level) << 32) | index as u64);
        let weights: Vec<f64> = members.iter().map(|&m| all.weights[m as usize]).collect();
        // The best of several distributions. Below level 3 the shape is so fine that fewer suffice.
        let (tries, rounds) = if level > 3 { (2, 1) } else { (4, ROUNDS) };
        let mut best = (f64::INFINITY, Vec::new());
        for alpha in &ALPHAS[..tries] {
            let features: Vec<Feature> = members
                .iter()
                .map(|&m| {
                    let p = samples[m as usize].point * *alpha;
                    let c = all.inscribed[m as usize] * (1.0 - alpha);
                    [p.x, p.y, p.z, c.x, c.y, c.z]
                })
                .collect();
            let mut parts: Vec<(Vec<u32>, Option<Sphere>)> =
                split(&features, &weights, 8, &mut random)
                    .into_iter()
                    .map(|part| (part.iter().map(|&k| members[k as usize]).collect(), None))
                    .collect();
            for round in 0..=rounds {
                let mut cost = 0.0;
                let mut family: Vec<(Vec<u32>, Sphere)> = Vec::with_capacity(parts.len());
                for (part, start) in parts {
                    let (own, sphere) = self.fitted(all, &part, start, &mut random);
                    if !own.is_finite() {
                        // No centre lies inside the solid: its samples go to the other parts.
                        cost += UNFIT * all.smallest * all.smallest * part.len() as f64;
                        continue;
                    }
                    let weight: f64 = part.iter().map(|&m| all.weights[m as usize]).sum();
                    cost += own * weight;
                    family.push((part, sphere));
                }
                parts = if round < rounds {
                    reshared(&family, samples)
                } else {
                    Vec::new()
                };
                if cost < best.0 {
                    best = (cost, family.into_iter().map(|(_, sphere)| sphere).collect());
                }
            }
        }
        best.1
    }
}

/// Makes levels 1 and 2 by volume, if the solid is thick enough.
fn volumetric(distance: &MeshDistance, samples: &[Sample], levels: &mut Vec<Vec<Share>>) {
    let families = volume::cells(distance, samples);
    if families.is_empty() {
        return;
    }
    let (mut first, mut second) = (Vec::new(), Vec::new());
    levels[0][0].children = families.len() as u8;
    for family in families {
        first.push(Share {
            first_child: second.len() as u32,
            children: family.cells.len() as u8,
            ..Share::leaf(family.sphere)
        });
        second.extend(family.cells.into_iter().map(|cell| Share {
            inner: cell.inner,
            ..Share::leaf(cell.sphere)
        }));
    }
    levels.push(first);
    levels.push(second);
}

/// Gives each sample to the ball of the family with the nearest surface.
fn reshared(family: &[(Vec<u32>, Sphere)], samples: &[Sample]) -> Vec<(Vec<u32>, Option<Sphere>)> {
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

/// Returns the largest distance of a sample from the ball's surface, metres.
fn worst(members: &[u32], sphere: &Sphere, samples: &[Sample]) -> f64 {
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
                "levels of a volumetric tree",
                f64::from(self.levels),
                !self.volumetric || self.levels >= 2,
                "2 to 6",
            ),
            (
                "samples",
                self.samples as f64,
                (500..=2_000_000).contains(&self.samples),
                "500 to 2000000",
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
