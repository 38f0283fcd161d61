//! Display mesh carried by the spheres of a tree.
//!
//! A vertex moves by a weighted sum of the displacements of nearby spheres, `u_v = sum_i w_vi u_i`. The weights are
//! those of moving least squares with a linear basis (Lancaster and Salkauskas 1981,
//! doi:10.1090/S0025-5718-1981-0616367-1). A linear function is fitted to the nearby displacements at each vertex. The
//! fit's own weights fall to zero, with slope and curvature, beyond the nearest few dozen spheres. Consequences:
//! - The weights sum to 1, and any motion linear in the position (shift, turn, stretch, shear) is followed exactly.
//! - The weights change smoothly from vertex to vertex, without facets at the limits of spheres.
//!
//! Forces use the same weights, `f_i = sum_v w_vi f_v`: work, force and torque are conserved.
//!
//! The carriers of an organ with a surface compliance are its moving masters, not its spheres. The spheres then serve
//! contact only. A sphere that forms both the moving back and the held underside would carry the underside along.
//!
//! Spheres near one plane or line leave the slope undetermined for a vertex beside them. There the weights change
//! smoothly to the plain weighted mean.

use nalgebra::{Matrix4, Vector4};

use crate::math::{Vec3, fclamp, fmax, norm};
use crate::scene::Object;
use crate::tissue::TissueModel;
use crate::tree::SphereTree;

/// Rank, by distance from a vertex, of the spheres whose mean distance determines the range of the spheres that carry
/// the vertex; see [`reach`].
const CARRIERS: usize = 48;
/// Ratio of the range of the spheres that carry a vertex to the mean distance of the spheres with ranks about
/// [`CARRIERS`].
const REACH: f64 = 1.3;
/// Sum of the weights' magnitudes of a vertex up to which the linear fit is used alone. The sum is 1 for a mean; more
/// means an extrapolation.
const TRUSTED: f64 = 8.0;
/// Sum of the weights' magnitudes of a vertex from which only the weighted mean is used.
const DISTRUSTED: f64 = 16.0;
/// Ridge on the slope terms of the normalised normal equations. Decides only slopes that the data leave undetermined.
const RIDGE: f64 = 1e-14;

/// Carriers of each vertex of a mesh, with their weights: nodes of a tree, or masters of a surface compliance.
///
/// [`crate::Workspace::carriers_moved`] returns the displacements of the carriers.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DisplaySkin {
    /// Index in `entries` of each vertex's first entry, followed by the number of all entries.
    first: Vec<u32>,
    /// Carriers and weights, vertex by vertex: node of the tree or index of the master, and dimensionless weight.
    entries: Vec<(u32, f64)>,
}

impl DisplaySkin {
    /// Creates the skin of `vertices` over spheres at `centres` (node of the tree and rest position), all in one frame,
    /// metres. Without spheres the vertices have no carriers.
    pub fn new(centres: &[(u32, Vec3)], vertices: &[Vec3]) -> Self {
        let mut skin = Self {
            first: vec![0],
            entries: Vec::new(),
        };
        let mut near: Vec<(f64, usize)> = Vec::with_capacity(centres.len());
        let mut offsets = Vec::new();
        for vertex in vertices {
            near.clear();
            let away = |(k, (_, at)): (usize, &(u32, Vec3))| (norm(&(at - vertex)), k);
            near.extend(centres.iter().enumerate().map(away));
            near.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            let reach = reach(&near);
            near.retain(|(d, _)| *d < reach);
            near.sort_unstable_by_key(|(_, k)| *k);
            offsets.clear();
            offsets.extend(near.iter().map(|(_, k)| (centres[*k].1 - vertex) / reach));
            let carried = near.iter().zip(weights(&offsets));
            skin.entries
                .extend(carried.map(|((_, k), w)| (centres[*k].0, w)));
            skin.first.push(skin.entries.len() as u32);
        }
        skin
    }

    /// Creates the skin of an object's display mesh.
    pub fn of(object: &Object) -> Self {
        let vertices: Vec<Vec3> = object
            .mesh
            .vertices
            .iter()
            .map(|v| Vec3::from(v.map(f64::from)))
            .collect();
        Self::of_tissue(&object.tree, object.level, &object.tissue, &vertices)
    }

    /// Creates the skin of `vertices` (metres, in the frame of the tree), over the masters of a tissue with a surface
    /// compliance. Any other tissue uses the spheres of `level`.
    pub fn of_tissue(
        tree: &SphereTree,
        level: u8,
        tissue: &TissueModel,
        vertices: &[Vec3],
    ) -> Self {
        let TissueModel::Surface(model) = tissue else {
            let centres = tree.shape_at(level).map(|(id, node)| (id, node.centre));
            return Self::new(&centres.collect::<Vec<_>>(), vertices);
        };
        let moving = model.masters.moving();
        let mut skin = Self {
            first: vec![0],
            entries: Vec::new(),
        };
        for vertex in vertices {
            let weights = model.masters.weights(vertex);
            let carried = weights.iter().filter(|(master, _)| *master < moving);
            skin.entries
                .extend(carried.map(|(master, w)| (*master as u32, *w)));
            skin.first.push(skin.entries.len() as u32);
        }
        skin
    }

    /// Returns the number of vertices of the mesh.
    pub fn vertices(&self) -> usize {
        self.first.len().saturating_sub(1)
    }

    /// Returns the carriers of vertex `v` (node of the tree or index of the master), with their dimensionless weights.
    #[inline]
    pub fn carriers(&self, v: usize) -> &[(u32, f64)] {
        &self.entries[self.first[v] as usize..self.first[v + 1] as usize]
    }

    /// Writes the displacement of each vertex, metres, for the displacements `moved` of the carriers (by index,
    /// metres).
    pub fn displacements(&self, moved: &[Vec3], out: &mut [Vec3]) {
        for (v, out) in out.iter_mut().enumerate().take(self.vertices()) {
            let of = |sum: Vec3, (node, w): &(u32, f64)| sum + moved[*node as usize] * *w;
            *out = self.carriers(v).iter().fold(Vec3::zeros(), of);
        }
    }

    /// Adds the loads on the carriers by `forces` on the vertices to `loads`. `forces` are by vertex, `loads` by
    /// carrier, both in newtons and the same axes.
    pub fn loads(&self, forces: &[Vec3], loads: &mut [Vec3]) {
        for (v, force) in forces.iter().enumerate().take(self.vertices()) {
            for (node, w) in self.carriers(v) {
                loads[*node as usize] += force * *w;
            }
        }
    }
}

/// Returns the range about a vertex within which spheres carry the vertex, metres. `near` has the distances of all
/// spheres, metres, ascending.
///
/// The range is a mean over ranks, so that an exchange of two neighbours causes hardly a kink.
fn reach(near: &[(f64, usize)]) -> f64 {
    let (mut sum, mut total) = (0.0, 0.0);
    let last = near.len().saturating_sub(1);
    for rank in 0..2 * CARRIERS {
        // Parabola over the ranks. Missing ranks count as the last one, at a growing distance.
        let share = (rank + 1) as f64 / (CARRIERS as f64 + 0.5) - 1.0;
        let weight = fmax(1.0 - share * share, 0.0);
        let beyond = 1.0 + rank.saturating_sub(last) as f64 / CARRIERS as f64;
        sum += weight * beyond * near.get(rank.min(last)).map_or(1.0, |(d, _)| *d);
        total += weight;
    }
    // Lower limit: coincident positions must not cause a division by zero.
    fmax(REACH * sum / total, 1e-9)
}

/// Returns the dimensionless weights of neighbours at `offsets` from the vertex, in units of the range. Their sum is 1;
/// single weights can be negative.
fn weights(offsets: &[Vec3]) -> Vec<f64> {
    // Wendland's function, smooth to the second derivative (1995, doi:10.1007/BF02123482).
    let kernel = |offset: &Vec3| {
        let rest = fclamp(1.0 - norm(offset), 0.0, 1.0);
        rest * rest * rest * rest * (4.0 * norm(offset) + 1.0)
    };
    let kernels: Vec<f64> = offsets.iter().map(kernel).collect();
    let total: f64 = kernels.iter().sum();
    if total <= 0.0 {
        // All neighbours are at the limit of the range: plain mean.
        return vec![1.0 / offsets.len() as f64; offsets.len()];
    }
    let basis = |offset: &Vec3| Vector4::new(1.0, offset.x, offset.y, offset.z);
    let mut normal = Matrix4::from_diagonal(&Vector4::new(0.0, RIDGE, RIDGE, RIDGE));
    for (offset, w) in offsets.iter().zip(&kernels) {
        let p = basis(offset);
        normal += p * p.transpose() * (w / total);
    }
    let line = normal
        .cholesky()
        .map(|factor| factor.solve(&Vector4::new(1.0, 0.0, 0.0, 0.0)));
    let fitted: Vec<f64> = offsets
        .iter()
        .zip(&kernels)
        .map(|(offset, w)| line.map_or(0.0, |line| line.dot(&basis(offset)) * w / total))
        .collect();
    // Rounding and the ridge leave the sum slightly off 1.
    let sum: f64 = fitted.iter().sum();
    let size: f64 = fitted.iter().map(|w| w.abs()).sum();
    let trust = fclamp((DISTRUSTED - size) / (DISTRUSTED - TRUSTED), 0.0, 1.0);
    let trust = if sum > 0.5 {
        trust * trust * (3.0 - 2.0 * trust)
    } else {
        0.0
    };
    let mix = |(fitted, w): (&f64, &f64)| {
        let fitted = if trust > 0.0 { fitted / sum } else { 0.0 };
        trust * fitted + (1.0 - trust) * w / total
    };
    fitted.iter().zip(&kernels).map(mix).collect()
}

#[cfg(test)]
mod tests;
