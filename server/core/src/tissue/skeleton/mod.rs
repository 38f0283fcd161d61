//! Skeleton of springs under a skin of spheres: the paper's large deformation (sections 3.1 and 4) in a stable form.
//!
//! Some nodes of the sphere tree are masses on springs. All other spheres follow them by smooth skin weights. The
//! displacements `u` of the free nodes obey, for each axis separately unless a spring couples the axes,
//!
//! `M u'' + B u' + K(u) u = W' f`,
//!
//! with the loads `f` on the spheres and the skin weights `W`. The same weights move a sphere and distribute its load,
//! so no work is lost or created between skin and skeleton. A step is implicit Euler. The compliance in the
//! optimisation is `W A^-1 W'` with `A = M/dt2 + B/dt + K`. Both levels of detail use the same equations.
//!
//! Differences from the paper:
//! - The sign of Eq. 1 is corrected.
//! - The step is implicit. Explicit Euler needs about 0.3 kg a node for the paper's stiffness.
//! - Loads are the multipliers of the optimisation, not a penalty.
//! - A sphere of the skin depends on four nodes instead of its ancestor, so that there are no seams.

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
