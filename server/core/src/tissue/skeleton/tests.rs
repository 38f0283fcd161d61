//! Tests of a skeleton's mechanics, each against an independent computation.

mod dynamics;
mod levels;
mod refusals;
mod statics;

use super::{CARRIERS, Skeleton, SkeletonLevel, SkeletonParams, Skin, Spring, StretchLaw, ready};
use crate::MAX_TOOLS;
use crate::TICK_S;
use crate::math::{Vec3, norm};
use crate::tissue::{Hands, Site, SiteLoad, Tissue};
use crate::tree::{Sphere, SphereTree};

/// Spacing of the block's nodes, metres.
const SPACING: f64 = 6e-3;

/// Returns the points of a block, its lowest layer at z = 0.
fn block(n: [usize; 3]) -> Vec<Vec3> {
    let mut points = Vec::new();
    for k in 0..n[2] {
        for j in 0..n[1] {
            for i in 0..n[0] {
                // The lattice is slightly irregular, so that no two distances are equal.
                let wave = 3e-4 * libm::sin((7 * i + 13 * j + 5 * k) as f64);
                points.push(Vec3::new(i as f64, j as f64 + 0.05 * wave, k as f64) * SPACING);
            }
        }
    }
    points
}

/// Returns the centres of spheres between the nodes, which the skin carries.
fn skin_spheres(n: [usize; 3]) -> Vec<Vec3> {
    let size = Vec3::new(n[0] as f64 - 1.0, n[1] as f64 - 1.0, n[2] as f64 - 1.0) * SPACING;
    (0..25)
        .map(|k| {
            let t = f64::from(k);
            let share = Vec3::new(
                0.5 + 0.5 * libm::sin(2.3 * t),
                0.5 + 0.5 * libm::cos(1.1 * t),
                0.6 + 0.4 * libm::sin(0.7 * t + 1.0),
            );
            share.component_mul(&size)
        })
        .collect()
}

fn skin(point: &Vec3, places: &[Vec3]) -> Skin {
    let mut near: Vec<(f64, usize)> = places
        .iter()
        .enumerate()
        .map(|(k, p)| (norm(&(p - point)), k))
        .collect();
    near.sort_by(|a, b| a.0.total_cmp(&b.0));
    let reach = near.get(CARRIERS).map_or(1.0, |fifth| fifth.0);
    let mut skin = Skin {
        nodes: [near[0].1 as u16; CARRIERS],
        weights: [0.0; CARRIERS],
    };
    for (slot, (d, k)) in near.iter().take(CARRIERS).enumerate() {
        skin.nodes[slot] = *k as u16;
        skin.weights[slot] = (1.0 - d / reach) * (1.0 - d / reach);
    }
    let sum: f64 = skin.weights.iter().sum();
    skin.weights = skin.weights.map(|w| w / sum);
    skin
}

/// Returns a level on the spheres at `places`. Springs join nodes closer than `reach` (metres); the lowest layer is
/// fixed.
fn level(tree: &SphereTree, places: &[Vec3], reach: f64, params: SkeletonParams) -> SkeletonLevel {
    let id = |p: &Vec3| {
        tree.nodes()
            .iter()
            .position(|node| node.children == 0 && node.centre == *p)
            .expect("a leaf") as u32
    };
    let mut springs = Vec::new();
    for a in 0..places.len() {
        for b in 0..a {
            let length = norm(&(places[a] - places[b]));
            if length < reach {
                let soft = 1.0 / (1.0 + (a % 5) as f64);
                springs.push(Spring {
                    a: a as u16,
                    b: b as u16,
                    stiffness: [20.0 * soft, 15.0 * soft, 12.0 + soft],
                    coupling: [0.0; 3],
                });
            }
        }
    }
    SkeletonLevel {
        nodes: places.iter().map(id).collect(),
        fixed: places.iter().map(|p| p.z < 0.5 * SPACING).collect(),
        springs,
        params,
        skin: tree
            .nodes()
            .iter()
            .map(|node| skin(&node.centre, places))
            .collect(),
    }
}

const SOFT: SkeletonParams = SkeletonParams {
    mass: 1.3e-3,
    damping: 0.3,
    law: StretchLaw {
        limit: 3.0,
        half: 0.4,
    },
};

/// Returns a block of 4 x 3 x 3 nodes with 25 spheres of skin.
fn soft_block(params: SkeletonParams) -> (SphereTree, Skeleton) {
    let n = [4, 3, 3];
    let places = block(n);
    let tree = tree_of(places.iter().copied().chain(skin_spheres(n)));
    let coarse = level(&tree, &places, 1.5 * SPACING, params);
    (tree, Skeleton { coarse, fine: None })
}

/// Returns the block of [`soft_block`] with a finer skeleton on nodes and skin spheres together.
fn two_levels(params: SkeletonParams) -> (SphereTree, Skeleton) {
    let (tree, mut model) = soft_block(params);
    let n = [4, 3, 3];
    let places: Vec<Vec3> = block(n).into_iter().chain(skin_spheres(n)).collect();
    model.fine = Some(level(&tree, &places, 1.5 * SPACING, params));
    (tree, model)
}

fn tree_of(points: impl Iterator<Item = Vec3>) -> SphereTree {
    let spheres: Vec<Sphere> = points
        .map(|centre| Sphere {
            centre,
            radius: 2e-3,
        })
        .collect();
    SphereTree::over_leaves(&spheres).expect("valid")
}

/// Returns the input without hands, at a level of detail.
fn nobody(detail: u8) -> Hands<'static> {
    Hands {
        tools: [None; MAX_TOOLS],
        detail,
    }
}

/// Model, its state, and the configurations of a tick.
struct Bench {
    ready: Box<dyn Tissue>,
    state: Vec<f64>,
    shape: Vec<f64>,
    free: Vec<f64>,
    target: Vec<f64>,
    nodes: usize,
    detail: u8,
    still: bool,
}

impl Bench {
    fn new(tree: &SphereTree, model: &Skeleton) -> Self {
        model.validate(tree).expect("a model that stands");
        let ready = ready(model, tree, TICK_S);
        let len = ready.shape_len();
        Self {
            state: vec![0.0; model.state_len()],
            shape: vec![0.0; len],
            free: vec![0.0; len],
            target: vec![0.0; len],
            nodes: tree.nodes().len(),
            detail: 0,
            still: true,
            ready,
        }
    }

    fn free_step(&mut self) {
        let hands = nobody(self.detail);
        self.still = self
            .ready
            .free_step(&self.state, &hands, &mut self.shape, &mut self.free);
    }

    /// Runs one tick under the load `-lambda_i n_i` (newtons) on each site.
    fn tick(&mut self, sites: &[Site], lambda: &[f64]) {
        self.free_step();
        self.ready
            .apply(sites, lambda, &self.free, &mut self.target);
        let loads: Vec<SiteLoad> = sites
            .iter()
            .zip(lambda)
            .map(|(site, load)| SiteLoad {
                sphere: site.sphere,
                tool: 0,
                force: site.normal * -*load,
            })
            .collect();
        self.ready.commit(
            &self.target,
            Some(&loads),
            &nobody(self.detail),
            &mut self.state,
        );
    }

    /// Returns the centres of all nodes of the tree in the final configuration of the last tick.
    fn centres(&self) -> Vec<Vec3> {
        self.centres_in(&self.target)
    }

    fn centres_in(&self, shape: &[f64]) -> Vec<Vec3> {
        let ids: Vec<u32> = (0..self.nodes as u32).collect();
        let mut out = vec![Vec3::zeros(); self.nodes];
        self.ready.centres(shape, &ids, &mut out);
        out
    }
}

/// Returns sites on spheres spread over the tree, two of them on one sphere.
fn sites(tree: &SphereTree) -> Vec<Site> {
    let leaves: Vec<u32> = tree.shape_at(7).map(|(k, _)| k).collect();
    (0..9)
        .map(|k| {
            let t = k as f64;
            let normal = Vec3::new(libm::sin(t), libm::cos(2.0 * t), 1.5).normalize();
            Site {
                sphere: leaves[(if k == 8 { 7 } else { k } * 6 + 3) % leaves.len()],
                normal,
            }
        })
        .collect()
}

/// Solves `a x = b` by Gaussian elimination with pivots.
fn dense_solve(mut a: Vec<Vec<f64>>, mut b: Vec<f64>) -> Vec<f64> {
    let n = b.len();
    for j in 0..n {
        let pivot = (j..n)
            .max_by(|&p, &q| a[p][j].abs().total_cmp(&a[q][j].abs()))
            .expect("a row");
        a.swap(j, pivot);
        b.swap(j, pivot);
        for i in j + 1..n {
            let l = a[i][j] / a[j][j];
            let (above, below) = a.split_at_mut(i);
            for (x, y) in below[0][j..].iter_mut().zip(&above[j][j..]) {
                *x -= l * y;
            }
            b[i] -= l * b[j];
        }
    }
    for j in (0..n).rev() {
        for k in j + 1..n {
            b[j] -= a[j][k] * b[k];
        }
        b[j] /= a[j][j];
    }
    b
}
