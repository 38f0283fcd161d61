//! Offline: meshes to sphere trees, scene files, the parametric parts.
//!
//! [`compile::compile_file`] turns a scene file ([`mod@file`]) into a [`sulcus_core::Scene`]. [`mesh`] loads and mends what has
//! one right answer and says so, and refuses what is not a solid ([`mesh::solid::read_solid`] is the three in one);
//! [`anatomy`] and [`instruments`] make meshes from a handful of numbers. [`tree`] makes sphere trees from true distances,
//! [`mod@error`] measures them. [`organ`] lays a skeleton under a tree. Results are functions of their input alone: no clock,
//! no randomness but fixed seeds, no dependence on the number of threads.

pub mod anatomy;
pub mod cache;
pub mod compile;
pub mod error;
pub mod file;
pub mod instruments;
pub mod mesh;
pub mod organ;
mod parallel;
mod random;
pub mod tree;

pub use cache::default_cache_dir;
pub use compile::built_in::{BuiltIn, NotBuiltIn, compile_built_in};
pub use compile::{
    BuildError, BuildOptions, Compiled, compile_default, compile_file, compile_text,
};
pub use mesh::solid::{Solid, SolidError, read_solid};
