//! The triangle mesh that people see, carried by the spheres of a tree.
//!
//! A vertex moves by a weighted sum of the displacements of the spheres about it, `u_v = sum_i w_vi u_i`. The weights are
//! those of moving least squares with a linear basis (Lancaster and Salkauskas 1981,
//! doi:10.1090/S0025-5718-1981-0616367-1): a line through the nearby displacements, fitted anew at each vertex with
//! weights that fall to zero, slope and curvature too, beyond the nearest few dozen. So
//! - they sum to 1, and any motion that is linear in the place (shift, turn, stretch, shear) is followed exactly,
//! - they change smoothly from vertex to vertex: no facet ends where a sphere does.
//!
//! Forces go the other way by the same weights, `f_i = sum_v w_vi f_v`: no work is lost or made, and force and torque
//! stay what they were.
//!
//! An organ by its surface compliance says more than its spheres do: there the surface itself goes where the masters about it say, and
//! the spheres only touch for it (one that makes a held underside moves with the back that it makes, too). Its carriers are the
//! masters that move.
//!
//! Where the spheres say too little of the slope (all about one plane or line, and the vertex beside it), a line through
//! them would be a guess: there the weights go over, smoothly, to the plain weighted mean.

use nalgebra::{Matrix4, Vector4};

use crate::math::{Vec3, fclamp, fmax, norm};
use crate::scene::Object;
use crate::tissue::TissueModel;
use crate::tree::SphereTree;

/// Rank of the neighbours about whose distance spheres cease to be felt.
const CARRIERS: usize = 48;
/// How much farther they are felt.
const REACH: f64 = 1.3;
/// Sum of the weights' sizes up to which the fitted line is trusted, and from which only the mean is: 1 is a mean of
/// what lies about, more is a line drawn out beyond it.
const TRUSTED: f64 = 8.0;
const DISTRUSTED: f64 = 16.0;
/// Added to the slope's part of the normal equations, of their scale: decides what nothing else does.
const RIDGE: f64 = 1e-14;

/// What carries each vertex of a mesh, and how much of each: nodes of a tree, or the masters of a surface compliance.
/// [`crate::Workspace::carriers_moved`] says where they have gone.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DisplaySkin {
    /// Where each vertex's entries begin; one more for the end.
    first: Vec<u32>,
    /// Node of the tree (or master) and weight.
    entries: Vec<(u32, f64)>,
}

impl DisplaySkin {
    /// The skin of `vertices` over spheres at `centres` (node of the tree and place at rest), all in one frame, metres.
    /// Without any sphere nothing carries them.
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

    /// The skin of an object's display mesh.
    pub fn of(object: &Object) -> Self {
        let vertices: Vec<Vec3> = object
            .mesh
            .vertices
            .iter()
            .map(|v| Vec3::from(v.map(f64::from)))
            .collect();
        Self::of_tissue(&object.tree, object.level, &object.tissue, &vertices)
    }

    /// The skin of `vertices` (metres, the frame of the tree): over the spheres of a `level`, or over the masters where the tissue
    /// has some.
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

    /// Vertices of the mesh.
    pub fn vertices(&self) -> usize {
        self.first.len().saturating_sub(1)
    }

    /// Nodes of the tree (or masters) that carry vertex `v`, with their weights.
    #[inline]
    pub fn carriers(&self, v: usize) -> &[(u32, f64)] {
        &self.entries[self.first[v] as usize..self.first[v + 1] as usize]
    }

    /// Writes how far each vertex goes when the carriers have gone `moved` (by index; metres).
    pub fn displacements(&self, moved: &[Vec3], out: &mut [Vec3]) {
        for (v, out) in out.iter_mut().enumerate().take(self.vertices()) {
            let of = |sum: Vec3, (node, w): &(u32, f64)| sum + moved[*node as usize] * *w;
            *out = self.carriers(v).iter().fold(Vec3::zeros(), of);
        }
    }

    /// Adds to `loads` (by carrier; newtons) what `forces` on the vertices load the carriers with.
    pub fn loads(&self, forces: &[Vec3], loads: &mut [Vec3]) {
        for (v, force) in forces.iter().enumerate().take(self.vertices()) {
            for (node, w) in self.carriers(v) {
                loads[*node as usize] += force * *w;
            }
        }
    }
}

/// How far from a vertex spheres are felt there, metres, from their distances, ascending. A mean over ranks: where two
/// neighbours change places, it has hardly a kink.
fn reach(near: &[(f64, usize)]) -> f64 {
    let (mut sum, mut total) = (0.0, 0.0);
    let last = near.len().saturating_sub(1);
    for rank in 0..2 * CARRIERS {
        // Parabola over the ranks. Those that there are not count as the last, and farther.
        let share = (rank + 1) as f64 / (CARRIERS as f64 + 0.5) - 1.0;
        let weight = fmax(1.0 - share * share, 0.0);
        let beyond = 1.0 + rank.saturating_sub(last) as f64 / CARRIERS as f64;
        sum += weight * beyond * near.get(rank.min(last)).map_or(1.0, |(d, _)| *d);
        total += weight;
    }
    // The same place twice is no reason to divide by nothing.
    fmax(REACH * sum / total, 1e-9)
}

/// Weights of neighbours at `offsets` from the vertex, in units of the reach.
fn weights(offsets: &[Vec3]) -> Vec<f64> {
    // Wendland's function, smooth to the second derivative (1995, doi:10.1007/BF02123482).
    let kernel = |offset: &Vec3| {
        let rest = fclamp(1.0 - norm(offset), 0.0, 1.0);
        rest * rest * rest * rest * (4.0 * norm(offset) + 1.0)
    };
    let kernels: Vec<f64> = offsets.iter().map(kernel).collect();
    let total: f64 = kernels.iter().sum();
    if total <= 0.0 {
        // All but out of reach: the mean.
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
    // Rounding and the ridge leave a little of the sum.
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
