//! Deformable tissue: one interface for every model. A rigid tooth is the simplest case.
//!
//! A scene holds the *data* of a model ([`TissueModel`]). A workspace holds the model prepared for ticks ([`Tissue`]):
//! tables computed once when the scene loads, and scratch. The numbers that outlive a tick are in [`crate::State`]; all
//! zero is the rest.
//!
//! A tissue at rest without a contact nearby is skipped, unless [`Tissue::goes_by_hands`] is true. The calls to any
//! other tissue in a tick are, in this order:
//!
//! - [`Tissue::free_step`], once: present configuration, and configuration at the end of the tick without contact.
//! - [`Tissue::centres`], per substep: present centres of the spheres.
//! - [`Tissue::add_gram`], per substep: displacement of each contact row for a unit load on each other row.
//! - [`Tissue::apply`], per substep: configuration under the multipliers.
//! - [`Tissue::commit`], once: storage of the final configuration in the state.
//!
//! All calls are batched over the rows of one object. Compliance is a 3x3 block per pair of spheres: `n_i' C_ij n_j`.

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

/// Sphere and direction of one contact row on a tissue.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Site {
    /// Node of the object's tree in contact.
    pub sphere: u32,
    /// Unit normal, from the tissue to the tool, world axes.
    pub normal: Vec3,
}

/// View of the rows and columns of one object in the compliance matrix `C` of the tissue, m/N. `C` has a row and a
/// column for each row of the problem and is stored row-major.
pub struct Gram<'a> {
    entries: &'a mut [f64],
    stride: usize,
    first: usize,
}

impl<'a> Gram<'a> {
    /// Returns a view of the rows and columns from `first` on of a `stride` by `stride` matrix, stored row-major.
    pub fn new(entries: &'a mut [f64], stride: usize, first: usize) -> Self {
        debug_assert!(entries.len() >= stride * stride);
        Self {
            entries,
            stride,
            first,
        }
    }

    /// Adds `compliance` (metres per newton) to entry `(i, j)`, counted from the object's first row.
    #[inline]
    pub fn add(&mut self, i: usize, j: usize, compliance: f64) {
        self.entries[(self.first + i) * self.stride + self.first + j] += compliance;
    }
}

/// Hands in a tick, as visible to a tissue. The default models compute no load from the hands: contact belongs to the
/// optimisation. The method as printed computes its loads from them, and a pocket reads its depth from them.
#[derive(Clone, Copy, Debug)]
pub struct Hands<'a> {
    /// Hand at each tool slot; `None` for a slot without a tool in a hand.
    pub tools: [Option<Hand<'a>>; MAX_TOOLS],
    /// Level of detail requested by the input ([`crate::TickInput::detail`]), 0 (the coarsest) to 1.
    pub detail: u8,
}

/// Hand that holds a tool in a tick.
#[derive(Clone, Copy, Debug)]
pub struct Hand<'a> {
    /// Tool in the hand.
    pub tool: &'a Tool,
    /// Haptic pose of this tick, after sanitising: `world_from_tool`.
    pub haptic: Pose,
    /// Graphic pose, `world_from_tool`: at the start of the tick or substep in [`Tissue::free_step`], at the end of the
    /// tick in [`Tissue::commit`].
    pub graphic: Pose,
    /// Loads by this tool on each object of the scene: force and torque about the world's origin. In
    /// [`Tissue::free_step`] at the start of a tick, the loads are of the last tick. In [`Tissue::commit`] the loads
    /// are of this tick.
    pub loads: &'a [Wrench],
}

/// Load on one sphere in the final solution of a tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SiteLoad {
    /// Node of the object's tree under load.
    pub sphere: u32,
    /// Slot of the tool that applies the load.
    pub tool: u8,
    /// Force on the tissue, newtons, world axes.
    pub force: Vec3,
}

/// Work that a tissue model declares, operations of [`crate::work`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Effort {
    /// Work of a tick: [`Tissue::free_step`], [`Tissue::commit`], and the motions and bytes of the state.
    pub step: u64,
    /// Work of [`Tissue::add_gram`] for a pair of rows.
    pub pair: u64,
    /// Work of [`Tissue::apply`] without loads, with the motion of all spheres.
    pub apply: u64,
    /// Work of [`Tissue::apply`] for each loaded site.
    pub load: u64,
}

/// Tissue model prepared for one object. `state` is the part that outlives a tick. `shape` is a configuration, the
/// displacements from rest. Their lengths are constant for a scene. Methods with `&mut self` may keep scratch and
/// tables, but no cached value may affect a result.
pub trait Tissue: Debug + Send {
    /// Returns the count of numbers in a configuration.
    fn shape_len(&self) -> usize;
    /// Writes the final configuration of the last tick to `shape`, and to `free` the configuration `u0` at the end of
    /// this tick without contact. Returns whether both are exactly the rest and the state needs no change. The tissue
    /// can then be skipped while no tool is near.
    fn free_step(
        &mut self,
        state: &[f64],
        hands: &Hands<'_>,
        shape: &mut [f64],
        free: &mut [f64],
    ) -> bool;
    /// Writes the centres of the nodes `ids` in configuration `shape`, world axes, metres.
    fn centres(&self, shape: &[f64], ids: &[u32], out: &mut [Vec3]);
    /// Adds `n_i' C_ij n_j` for all pairs of `sites`, metres per newton. `C_ij` is the displacement of sphere `i` at
    /// the end of the tick for a unit force on sphere `j`. The matrix is symmetric and positive semi-definite.
    fn add_gram(&mut self, sites: &[Site], gram: &mut Gram<'_>);
    /// Writes the configuration under the load `-lambda_i n_i` (newtons) on each site:
    /// `shape = free - sum_j C_ij n_j lambda_j`.
    fn apply(&mut self, sites: &[Site], lambda: &[f64], free: &[f64], shape: &mut [f64]);
    /// Returns the largest motion of any sphere between two configurations, or an upper bound on it, metres. The trust
    /// region must allow for this motion.
    fn motion(&self, from: &[f64], to: &[f64]) -> f64;
    /// Stores the final configuration of the tick, and the loads that led to it, in the state. `loads` is `None` if the
    /// solver had no usable solution. The memory of loads then stays unchanged.
    fn commit(
        &mut self,
        shape: &[f64],
        loads: Option<&[SiteLoad]>,
        hands: &Hands<'_>,
        state: &mut [f64],
    );
    /// Returns the work of the model. A default for models whose work is that of their numbers.
    fn effort(&self) -> Effort {
        let numbers = self.shape_len() as u64;
        Effort {
            step: 8 * numbers,
            pair: 4,
            apply: 4 * numbers,
            load: numbers,
        }
    }
    /// Returns whether the hands can make [`Tissue::free_step`] leave the rest while the state is zero.
    fn goes_by_hands(&self) -> bool {
        false
    }
    /// Returns the ball, world axes, metres, outside of which no tip gives a reading; `None` for a tissue without a
    /// pocket.
    fn pocket(&self) -> Option<Sphere> {
        None
    }
    /// Returns the pocket reading of the tool in `slot` at the end of a tick, if the tool's tip is in this pocket. A
    /// tip outside the ball of [`Tissue::pocket`] has no reading. The first value is the squared distance of the tip
    /// from the pocket's wall, m^2. The distance selects one of several pockets that claim a tip. A pocket at rest
    /// without contact is not committed, but is read.
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

/// Tissue models that a scene can name.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum TissueModel {
    /// Rigid object: a tooth, a jaw, an instrument on a stand.
    Rigid,
    /// Organ that deforms as a whole, such as a tongue: springs under a skin of spheres.
    Skeleton(Box<skeleton::Skeleton>),
    /// Organ that deforms as a whole: finite elements condensed to the surface.
    Surface(Box<surface::SurfaceCompliance>),
    /// Gingiva around a tooth, with its pocket.
    Gingiva(Box<gingiva::Gingiva>),
    /// Tongue exactly as in the paper, for comparison.
    PrintedSkeleton(PrintedSkeleton),
    /// Gingiva exactly as in the paper, for comparison.
    PrintedGingiva(PrintedGingiva),
    /// Every sphere on its own anisotropic spring: a minimal model for the tests of this crate.
    #[cfg(test)]
    Winkler(tests::Winkler),
}

/// Invalid field of a tissue model.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{field} is {found}, expected {expected}")]
pub struct TissueError {
    /// Name of the invalid field, or its content in words, such as `number of masters`.
    pub field: &'static str,
    /// Value found.
    pub found: String,
    /// Value expected.
    pub expected: String,
}

/// Returns the error for an invalid field.
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

/// Returns whether all numbers are zero, of either sign. The loop avoids a branch for each number.
pub(crate) fn all_zero(numbers: &[f64]) -> bool {
    numbers
        .iter()
        .fold(0, |bits, x| bits | (x.to_bits() & !(1 << 63)))
        == 0
}

impl TissueModel {
    /// Prepares the model for an object with the tree `rest`, contact at `level` and ticks of `tick_s` seconds. Returns
    /// `None` for a rigid object. The model must have passed [`TissueModel::validate`].
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

    /// Returns the count of numbers in the state of an object with the tree `rest`; 0 for a rigid object.
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

    /// Checks the data against the object's tree and the length of a tick, `tick_s` seconds.
    ///
    /// # Errors
    /// A field is invalid: the error names the field, the value found and the value expected.
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

    /// Returns whether the object never yields, so that a tick skips it.
    #[inline]
    pub fn is_rigid(&self) -> bool {
        matches!(self, TissueModel::Rigid)
    }
}

/// Returns the largest distance between two positions of a node, from two lists of displacements (x, y, z of each node
/// in turn), metres.
pub(crate) fn largest_difference(from: &[f64], to: &[f64]) -> f64 {
    let squared = |a: &[f64; 3], b: &[f64; 3]| {
        let (x, y, z) = (b[0] - a[0], b[1] - a[1], b[2] - a[2]);
        x * x + y * y + z * z
    };
    let (from, to) = (from.as_chunks::<3>().0, to.as_chunks::<3>().0);
    let ((from, from_rest), (to, to_rest)) = (from.as_chunks::<4>(), to.as_chunks::<4>());
    // Four independent maxima, so that no comparison waits for the one before.
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

/// Updates the nodes of a yielding object to configuration `shape`.
///
/// Centres come from the model, world axes, metres. Bounds come from the children up (the paper's Eq. 17) and always
/// start from the constant contact radii, so that they shrink again. `ids` holds 0, 1, 2 and so on for all nodes.
/// `centres` is scratch for as many.
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

    /// Model with every sphere on its own spring of a 3x3 compliance. A sphere returns to rest within a tick.
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
