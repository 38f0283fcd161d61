//! Offline: meshes to sphere trees, scene files, the parametric parts.
//!
//! [`compile::compile_file`] turns a scene file into a [`sulcus_core::Scene`]: [`load`] and
//! [`parametric`] give meshes, [`check`] refuses what is not a solid, [`build`] makes sphere trees
//! from true distances ([`distance`]), [`error`] measures them. Results are functions of their
//! input alone: no clock, no randomness but fixed seeds, no dependence on the number of threads.

pub mod blend;
pub mod build;
pub mod cache;
pub mod check;
mod cluster;
pub mod compile;
pub mod distance;
pub mod error;
pub mod file;
mod fit;
pub mod load;
pub mod medial;
pub mod mesh;
mod parallel;
pub mod parametric;
mod parts;
mod random;
pub mod sample;
pub mod shapes;
mod validate;

pub use cache::default_cache_dir;
pub use compile::{
    BuildError, BuildOptions, Compiled, compile_default, compile_file, default_scene,
};
