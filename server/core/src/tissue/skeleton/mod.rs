//! A skeleton of springs under a skin of spheres: the paper's large deformation (sections 3.1 and 4), made
//! stable.
//!
//! Some nodes of the sphere tree are masses on springs; all other spheres follow them by smooth skin
//! weights. With the displacements `u` of the free nodes, for each axis on its own unless a spring couples them,
//!
//! `M u'' + B u' + K(u) u = W' f`,
//!
//! `f` the loads on the spheres and `W` the skin weights: where a sphere goes, and what its load does, are the
//! same weights, so no work is lost or made between skin and skeleton. A step is implicit Euler; its
//! compliance, which the optimisation sees, is `W A^-1 W'` with `A = M/dt2 + B/dt + K`. Both levels of detail
//! work alike.
//!
//! Differences to the paper: Eq. 1's sign is mended; the step is implicit (explicit Euler needs about 0.3 kg a
//! node for its stiffness); loads are the optimisation's multipliers, not a penalty; a sphere of the skin
//! hangs on four nodes instead of its ancestor, so that there are no seams.

mod data;
mod entry;
mod factor;
mod lattice;
mod ready;
#[cfg(test)]
mod tests;

pub use data::{
    CARRIERS, MAX_SKELETON_NODES, Skeleton, SkeletonLevel, SkeletonParams, Skin, Spring, StretchLaw,
};
pub(in crate::tissue) use ready::ready;
