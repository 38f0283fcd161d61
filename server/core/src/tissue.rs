//! How a touched thing yields. One interface for every model; a rigid tooth is its simplest case.
//!
//! Per tick a tissue is asked, in this order: [`Tissue::free_step`] (where would it be without
//! contact), then per collision pass [`Tissue::centres`] (where its spheres are now),
//! [`Tissue::add_gram`] (how far each contact row moves for a unit load on each other row) and
//! [`Tissue::apply`] (its configuration under the multipliers). The configuration that the tick
//! ends with is committed once by [`Tissue::commit`].
//!
//! All calls are batched over the rows of one object, and compliance is a 3x3 block per sphere
//! pair: `n_i' C_ij n_j`.

use serde::{Deserialize, Serialize};

use crate::math::Vec3;
use crate::tree::SphereTree;

/// One contact row as the tissue sees it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Site {
    /// Node of the object's tree that is touched.
    pub sphere: u32,
    /// Unit normal, from the tissue to the tool, world axes.
    pub normal: Vec3,
}

/// Square, row-major view on the part of the dual matrix that tissue fills.
pub struct Gram<'a> {
    entries: &'a mut [f64],
    stride: usize,
    first: usize,
}

impl<'a> Gram<'a> {
    /// A view on rows and columns from `first` on of a `stride` by `stride` matrix.
    pub fn new(entries: &'a mut [f64], stride: usize, first: usize) -> Self {
        debug_assert!(entries.len() >= stride * stride);
        Self {
            entries,
            stride,
            first,
        }
    }

    /// Adds to entry `(i, j)`, counted from the object's first row, metres per newton.
    #[inline]
    pub fn add(&mut self, i: usize, j: usize, compliance: f64) {
        self.entries[(self.first + i) * self.stride + self.first + j] += compliance;
    }
}

/// A tissue model. `state` is what outlives a tick, `shape` a configuration (displacements);
/// their lengths are constant for a scene.
pub trait Tissue {
    /// Numbers of state that outlive a tick.
    fn state_len(&self, rest: &SphereTree) -> usize;
    /// Numbers in a configuration; 0 means that nothing ever moves.
    fn shape_len(&self, rest: &SphereTree) -> usize;
    /// Writes the configuration that the last tick ended with.
    fn shape(&self, rest: &SphereTree, state: &[f64], shape: &mut [f64]);
    /// Writes the configuration `u0` at the end of this tick if nothing touched it.
    fn free_step(&self, rest: &SphereTree, state: &[f64], free: &mut [f64]);
    /// Centres of the nodes `ids` in configuration `shape`, world axes, metres.
    fn centres(&self, rest: &SphereTree, shape: &[f64], ids: &[u32], out: &mut [Vec3]);
    /// Adds `n_i' C_ij n_j` for all pairs of `sites`, metres per newton; symmetric, positive
    /// semi-definite.
    fn add_gram(&self, rest: &SphereTree, sites: &[Site], gram: &mut Gram<'_>);
    /// Writes the configuration under the load `-lambda_i n_i` (newtons) on each site:
    /// `shape = free - sum_j C_ij n_j lambda_j`.
    fn apply(
        &self,
        rest: &SphereTree,
        sites: &[Site],
        lambda: &[f64],
        free: &[f64],
        shape: &mut [f64],
    );
    /// Largest motion of any sphere between two configurations, metres: what the trust region
    /// must allow for.
    fn motion(&self, rest: &SphereTree, from: &[f64], to: &[f64]) -> f64;
    /// Takes the configuration that the tick ended with into the state.
    fn commit(&self, rest: &SphereTree, shape: &[f64], state: &mut [f64]);
}

/// The models that a scene can name.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum TissueModel {
    /// A tooth, a jaw, an instrument on a stand: does not yield.
    Rigid,
    /// Every sphere on its own anisotropic spring: proves the plumbing in this crate's tests.
    #[cfg(test)]
    Winkler(tests::Winkler),
}

impl TissueModel {
    /// The model behind the name.
    #[inline]
    pub fn model(&self) -> &dyn Tissue {
        match self {
            TissueModel::Rigid => &Rigid,
            #[cfg(test)]
            TissueModel::Winkler(model) => model,
        }
    }

    /// Whether nothing of it ever moves, so that a tick need not ask.
    #[inline]
    pub fn is_rigid(&self) -> bool {
        matches!(self, TissueModel::Rigid)
    }
}

/// Does not yield: no state, no compliance.
#[derive(Clone, Copy, Debug)]
pub struct Rigid;

impl Tissue for Rigid {
    fn state_len(&self, _: &SphereTree) -> usize {
        0
    }
    fn shape_len(&self, _: &SphereTree) -> usize {
        0
    }
    fn shape(&self, _: &SphereTree, _: &[f64], _: &mut [f64]) {}
    fn free_step(&self, _: &SphereTree, _: &[f64], _: &mut [f64]) {}
    fn centres(&self, rest: &SphereTree, _: &[f64], ids: &[u32], out: &mut [Vec3]) {
        for (id, centre) in ids.iter().zip(out) {
            *centre = rest.nodes()[*id as usize].centre;
        }
    }
    fn add_gram(&self, _: &SphereTree, _: &[Site], _: &mut Gram<'_>) {}
    fn apply(&self, _: &SphereTree, _: &[Site], _: &[f64], _: &[f64], _: &mut [f64]) {}
    fn motion(&self, _: &SphereTree, _: &[f64], _: &[f64]) -> f64 {
        0.0
    }
    fn commit(&self, _: &SphereTree, _: &[f64], _: &mut [f64]) {}
}

/// Brings a yielding object's nodes to configuration `shape`: centres from the model, bounds from
/// the children up (the paper's Eq. 17, always from the rest radii, so that bounds shrink again).
/// `ids` lists all nodes in order; `centres` has room for all.
pub(crate) fn refit(
    model: &dyn Tissue,
    rest: &SphereTree,
    shape: &[f64],
    ids: &[u32],
    centres: &mut [Vec3],
    nodes: &mut [crate::tree::Node],
) {
    let n = nodes.len();
    model.centres(rest, shape, &ids[..n], &mut centres[..n]);
    for (node, centre) in nodes.iter_mut().zip(centres) {
        node.centre = *centre;
    }
    crate::tree::refit_bounds(nodes);
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::math::Mat3;

    /// Every sphere on its own spring with a 3x3 compliance; springs back within a tick.
    #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
    pub struct Winkler {
        /// Compliance, m/N, symmetric positive definite.
        pub compliance: Mat3,
    }

    impl Tissue for Winkler {
        fn state_len(&self, rest: &SphereTree) -> usize {
            3 * rest.nodes().len()
        }
        fn shape_len(&self, rest: &SphereTree) -> usize {
            3 * rest.nodes().len()
        }
        fn shape(&self, _: &SphereTree, state: &[f64], shape: &mut [f64]) {
            shape.copy_from_slice(state);
        }
        fn free_step(&self, _: &SphereTree, _: &[f64], free: &mut [f64]) {
            free.fill(0.0);
        }
        fn centres(&self, rest: &SphereTree, shape: &[f64], ids: &[u32], out: &mut [Vec3]) {
            for (id, centre) in ids.iter().zip(out) {
                let at = 3 * *id as usize;
                *centre = rest.nodes()[*id as usize].centre
                    + Vec3::new(shape[at], shape[at + 1], shape[at + 2]);
            }
        }
        fn add_gram(&self, _: &SphereTree, sites: &[Site], gram: &mut Gram<'_>) {
            for (i, a) in sites.iter().enumerate() {
                for (j, b) in sites.iter().enumerate() {
                    if a.sphere == b.sphere {
                        gram.add(i, j, a.normal.dot(&(self.compliance * b.normal)));
                    }
                }
            }
        }
        fn apply(
            &self,
            _: &SphereTree,
            sites: &[Site],
            lambda: &[f64],
            free: &[f64],
            shape: &mut [f64],
        ) {
            shape.copy_from_slice(free);
            for (site, load) in sites.iter().zip(lambda) {
                let moved = self.compliance * site.normal * *load;
                for axis in 0..3 {
                    shape[3 * site.sphere as usize + axis] -= moved[axis];
                }
            }
        }
        fn motion(&self, _: &SphereTree, from: &[f64], to: &[f64]) -> f64 {
            from.chunks_exact(3)
                .zip(to.chunks_exact(3))
                .fold(0.0, |most, (a, b)| {
                    crate::math::fmax(
                        most,
                        crate::math::norm(&Vec3::new(b[0] - a[0], b[1] - a[1], b[2] - a[2])),
                    )
                })
        }
        fn commit(&self, _: &SphereTree, shape: &[f64], state: &mut [f64]) {
            state.copy_from_slice(shape);
        }
    }
}
