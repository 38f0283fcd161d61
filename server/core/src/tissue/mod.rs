//! How a touched thing yields. One interface for every model; a rigid tooth is its simplest case.
//!
//! A scene holds a model's *data* ([`TissueModel`]); a workspace holds the model made ready for work
//! ([`Tissue`]): tables computed once when the scene loads, and scratch. What outlives a tick is numbers in
//! [`crate::State`]; all of them zero is the rest.
//!
//! A tissue whose state is all zero and that nobody touches is not asked at all, unless it [`Tissue::goes_by_hands`]. Otherwise
//! it is asked per tick, in this order: [`Tissue::free_step`] (where is it, and where would it be
//! without contact), then per collision pass [`Tissue::centres`] (where its spheres are now),
//! [`Tissue::add_gram`] (how far each contact row moves for a unit load on each other row) and
//! [`Tissue::apply`] (its configuration under the multipliers). The configuration that the tick
//! ends with is committed once by [`Tissue::commit`].
//!
//! All calls are batched over the rows of one object, and compliance is a 3x3 block per sphere
//! pair: `n_i' C_ij n_j`.

pub mod gingiva;
pub mod printed;
pub mod skeleton;
pub mod surface;

use std::fmt::Debug;

use serde::{Deserialize, Serialize};

use crate::MAX_TOOLS;
use crate::math::{Pose, Vec3, Wrench, fmax};
use crate::output::PocketReading;
use crate::scene::tool::Tool;
use crate::tree::{Sphere, SphereTree};
use printed::{PrintedGingiva, PrintedSkeleton, ReadyGingiva, ReadySkeleton};

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

/// What a tissue may know of the hands in a tick. The default models need none of it: contact is the
/// optimisation's. The method as printed computes its loads from it, and a pocket reads its depth.
#[derive(Clone, Copy, Debug)]
pub struct Hands<'a> {
    /// Per slot; `None` where no hand holds a tool.
    pub tools: [Option<Hand<'a>>; MAX_TOOLS],
    /// Level of detail asked for by the input ([`crate::TickInput::detail`]).
    pub detail: u8,
}

/// One hand in a tick.
#[derive(Clone, Copy, Debug)]
pub struct Hand<'a> {
    /// What it holds.
    pub tool: &'a Tool,
    /// Haptic pose of this tick, after sanitising: `world_from_tool`.
    pub haptic: Pose,
    /// Graphic pose: of the last tick in [`Tissue::free_step`], of this one in [`Tissue::commit`].
    pub graphic: Pose,
    /// Loads by this tool on each object of the scene, about the world's origin: of the last tick in
    /// [`Tissue::free_step`], of this one in [`Tissue::commit`].
    pub loads: &'a [Wrench],
}

/// A load of the tick's answer on one sphere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SiteLoad {
    /// Node of the object's tree that is loaded.
    pub sphere: u32,
    /// Tool that loads it.
    pub tool: u8,
    /// Force on the tissue, newtons, world axes.
    pub force: Vec3,
}

/// A tissue model made ready for one object. `state` is what outlives a tick, `shape` a configuration
/// (displacements from rest); their lengths are constant for a scene. Methods that take `&mut self` may
/// keep scratch and tables; nothing kept may show in an answer.
pub trait Tissue: Debug + Send {
    /// Numbers in a configuration.
    fn shape_len(&self) -> usize;
    /// Writes the configuration that the last tick ended with to `shape`, and to `free` the configuration
    /// `u0` at the end of this tick if nothing touched it. Returns whether both are exactly the rest, so that
    /// nothing needs to be done while no tool is near.
    fn free_step(
        &mut self,
        state: &[f64],
        hands: &Hands<'_>,
        shape: &mut [f64],
        free: &mut [f64],
    ) -> bool;
    /// Centres of the nodes `ids` in configuration `shape`, world axes, metres.
    fn centres(&self, shape: &[f64], ids: &[u32], out: &mut [Vec3]);
    /// Adds `n_i' C_ij n_j` for all pairs of `sites`, metres per newton; symmetric, positive
    /// semi-definite.
    fn add_gram(&mut self, sites: &[Site], gram: &mut Gram<'_>);
    /// Writes the configuration under the load `-lambda_i n_i` (newtons) on each site:
    /// `shape = free - sum_j C_ij n_j lambda_j`.
    fn apply(&mut self, sites: &[Site], lambda: &[f64], free: &[f64], shape: &mut [f64]);
    /// Largest motion of any sphere between two configurations, metres: what the trust region
    /// must allow for.
    fn motion(&self, from: &[f64], to: &[f64]) -> f64;
    /// Takes the configuration that the tick ended with, and the loads that led there, into the state. No loads where the
    /// solver had no usable answer: what is remembered of loads stays as it was.
    fn commit(
        &mut self,
        shape: &[f64],
        loads: Option<&[SiteLoad]>,
        hands: &Hands<'_>,
        state: &mut [f64],
    );
    /// Whether [`Tissue::free_step`] may answer anything but the rest while the state is zero, for what the hands do.
    fn goes_by_hands(&self) -> bool {
        false
    }
    /// Ball, world axes, outside of which no tip reads anything; none where nothing is ever read.
    fn pocket(&self) -> Option<Sphere> {
        None
    }
    /// What the tool in `slot` reads here at the end of a tick, if this is a pocket and the tool's tip is in it, and in
    /// [`Tissue::pocket`]; first the squared distance from its wall, m^2, by which one
    /// of several that claim a tip is chosen. (A
    /// pocket that is at rest and untouched is not committed, but read.)
    fn reading(
        &self,
        slot: usize,
        hands: &Hands<'_>,
        state: &[f64],
    ) -> Option<(f64, PocketReading)> {
        let _ = (slot, hands, state);
        None
    }
}

/// The models that a scene can name.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum TissueModel {
    /// A tooth, a jaw, an instrument on a stand: does not yield.
    Rigid,
    /// An organ that deforms as a whole, a tongue: springs under a skin of spheres.
    Skeleton(Box<skeleton::Skeleton>),
    /// An organ that deforms as a whole, by finite elements condensed to its surface.
    Surface(Box<surface::SurfaceCompliance>),
    /// The collar around a tooth, with its pocket.
    Gingiva(Box<gingiva::Gingiva>),
    /// A tongue exactly by the paper, for comparison.
    PrintedSkeleton(PrintedSkeleton),
    /// A gingiva exactly by the paper, for comparison.
    PrintedGingiva(PrintedGingiva),
    /// Every sphere on its own anisotropic spring: proves the plumbing in this crate's tests.
    #[cfg(test)]
    Winkler(tests::Winkler),
}

/// A field of a tissue model that cannot stand.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{field} is {found}, expected {expected}")]
pub struct TissueError {
    /// Field.
    pub field: &'static str,
    /// Value found.
    pub found: String,
    /// What it must be.
    pub expected: String,
}

/// An error that says so.
fn wrong(
    field: &'static str,
    found: impl ToString,
    expected: impl ToString,
) -> Result<(), TissueError> {
    Err(TissueError {
        field,
        found: found.to_string(),
        expected: expected.to_string(),
    })
}

/// Whether all numbers are zero, of either sign: without a branch for each.
pub(crate) fn all_zero(numbers: &[f64]) -> bool {
    numbers
        .iter()
        .fold(0, |bits, x| bits | (x.to_bits() & !(1 << 63)))
        == 0
}

impl TissueModel {
    /// The model made ready for an object with the tree `rest` touched at `level`, in ticks of `tick_s` seconds; none for what is rigid.
    /// The model must have passed [`TissueModel::validate`].
    pub fn ready(&self, rest: &SphereTree, level: u8, tick_s: f64) -> Option<Box<dyn Tissue>> {
        match self {
            TissueModel::Rigid => None,
            TissueModel::Skeleton(model) => Some(skeleton::ready(model, rest, tick_s)),
            TissueModel::Surface(model) => {
                Some(Box::new(surface::Ready::new(model, rest, level, tick_s)))
            }
            TissueModel::Gingiva(model) => Some(Box::new(gingiva::Ready::new(model, rest, tick_s))),
            TissueModel::PrintedSkeleton(model) => {
                Some(Box::new(ReadySkeleton::new(model, rest, level, tick_s)))
            }
            TissueModel::PrintedGingiva(model) => {
                Some(Box::new(ReadyGingiva::new(model, rest, level)))
            }
            #[cfg(test)]
            TissueModel::Winkler(model) => Some(Box::new(tests::Ready::new(model, rest))),
        }
    }

    /// Numbers of state that outlive a tick.
    pub fn state_len(&self, rest: &SphereTree) -> usize {
        match self {
            TissueModel::Rigid => 0,
            TissueModel::Skeleton(model) => model.state_len(),
            TissueModel::Surface(model) => model.state_len(),
            TissueModel::Gingiva(model) => model.state_len(rest),
            TissueModel::PrintedSkeleton(model) => model.state_len(rest),
            TissueModel::PrintedGingiva(model) => model.state_len(rest),
            #[cfg(test)]
            TissueModel::Winkler(_) => 3 * rest.nodes().len(),
        }
    }

    /// Checks the data against the tree that it belongs to and the length of a tick, seconds.
    ///
    /// # Errors
    /// Names the field, the value found and the value expected.
    pub fn validate(&self, rest: &SphereTree, tick_s: f64) -> Result<(), TissueError> {
        match self {
            TissueModel::Rigid => Ok(()),
            TissueModel::Skeleton(model) => model.validate(rest),
            TissueModel::Surface(model) => model.validate(rest, tick_s),
            TissueModel::Gingiva(model) => model.validate(rest),
            TissueModel::PrintedSkeleton(model) => model.validate(rest, tick_s),
            TissueModel::PrintedGingiva(model) => model.validate(rest),
            #[cfg(test)]
            TissueModel::Winkler(_) => Ok(()),
        }
    }

    /// Whether nothing of it ever moves, so that a tick need not ask.
    #[inline]
    pub fn is_rigid(&self) -> bool {
        matches!(self, TissueModel::Rigid)
    }
}

/// Largest difference of two lists of displacements (x, y, z of each node in turn), metres.
pub(crate) fn largest_difference(from: &[f64], to: &[f64]) -> f64 {
    let squared = |a: &[f64; 3], b: &[f64; 3]| {
        let (x, y, z) = (b[0] - a[0], b[1] - a[1], b[2] - a[2]);
        x * x + y * y + z * z
    };
    let (from, to) = (from.as_chunks::<3>().0, to.as_chunks::<3>().0);
    let ((from, from_rest), (to, to_rest)) = (from.as_chunks::<4>(), to.as_chunks::<4>());
    // Four at a time, so that none waits for the one before.
    let mut most = [0.0; 4];
    for (a, b) in from.iter().zip(to) {
        for k in 0..4 {
            most[k] = fmax(most[k], squared(&a[k], &b[k]));
        }
    }
    for (a, b) in from_rest.iter().zip(to_rest) {
        most[0] = fmax(most[0], squared(a, b));
    }
    fmax(fmax(most[0], most[1]), fmax(most[2], most[3])).sqrt()
}

/// Brings a yielding object's nodes to configuration `shape`: centres from the model, bounds from
/// the children up (the paper's Eq. 17, always from the rest radii, so that bounds shrink again).
/// `ids` lists all nodes in order; `centres` has room for all.
pub(crate) fn refit(
    model: &dyn Tissue,
    shape: &[f64],
    ids: &[u32],
    centres: &mut [Vec3],
    nodes: &mut [crate::tree::Node],
) {
    let n = nodes.len();
    model.centres(shape, &ids[..n], &mut centres[..n]);
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

    #[derive(Debug)]
    pub struct Ready {
        compliance: Mat3,
        rest: Vec<Vec3>,
    }

    impl Ready {
        pub fn new(model: &Winkler, rest: &SphereTree) -> Self {
            Self {
                compliance: model.compliance,
                rest: rest.nodes().iter().map(|node| node.centre).collect(),
            }
        }
    }

    impl Tissue for Ready {
        fn shape_len(&self) -> usize {
            3 * self.rest.len()
        }
        fn free_step(
            &mut self,
            state: &[f64],
            _: &Hands<'_>,
            shape: &mut [f64],
            free: &mut [f64],
        ) -> bool {
            shape.copy_from_slice(state);
            free.fill(0.0);
            state.iter().all(|x| *x == 0.0)
        }
        fn centres(&self, shape: &[f64], ids: &[u32], out: &mut [Vec3]) {
            for (id, centre) in ids.iter().zip(out) {
                let at = 3 * *id as usize;
                *centre =
                    self.rest[*id as usize] + Vec3::new(shape[at], shape[at + 1], shape[at + 2]);
            }
        }
        fn add_gram(&mut self, sites: &[Site], gram: &mut Gram<'_>) {
            for (i, a) in sites.iter().enumerate() {
                for (j, b) in sites.iter().enumerate() {
                    if a.sphere == b.sphere {
                        gram.add(i, j, a.normal.dot(&(self.compliance * b.normal)));
                    }
                }
            }
        }
        fn apply(&mut self, sites: &[Site], lambda: &[f64], free: &[f64], shape: &mut [f64]) {
            shape.copy_from_slice(free);
            for (site, load) in sites.iter().zip(lambda) {
                let moved = self.compliance * site.normal * *load;
                for axis in 0..3 {
                    shape[3 * site.sphere as usize + axis] -= moved[axis];
                }
            }
        }
        fn motion(&self, from: &[f64], to: &[f64]) -> f64 {
            super::largest_difference(from, to)
        }
        fn commit(
            &mut self,
            shape: &[f64],
            _: Option<&[SiteLoad]>,
            _: &Hands<'_>,
            state: &mut [f64],
        ) {
            state.copy_from_slice(shape);
        }
    }
}
