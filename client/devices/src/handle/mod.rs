//! Handle adapter: which instrument is fixed to a device, and where its tip is.
//!
//! The frame of a handle has its origin at the centre of the gimbal and turns with the handle. The person puts the tip
//! into a dimple and turns the handle: [`Guide`] collects the poses, [`pivot`] computes the tip, [`Handle`] stores it,
//! and [`Handle::gimbal_from_tool`] places a tool of a scene in the handle.

mod file;
mod guide;
mod pivot;

pub use file::{Handle, HandleError, Side};
pub use guide::{Guide, Hint};
pub use pivot::{LEAST_POSES, MOST_RESIDUAL_MM, Pivot, PivotError, pivot};

#[cfg(test)]
mod tests;
