//! Sphere trees: fitted to a mesh level by level, tightened, blended.

pub mod blend;
pub mod build;
pub mod carry;
mod cluster;
pub mod filled;
mod fit;
mod level;
pub mod medial;
pub(crate) mod nearest_sphere;
mod polish;
pub(crate) mod rays;
mod relocate;
mod samples;
mod tighten;
mod volume;
pub mod zone;
