//! Offline: meshes to sphere trees, scene files, the parametric parts.
//!
//! [`compile::compile_file`] turns a scene file into a [`sulcus_core::Scene`]: [`load`] and
//! [`parametric`] give meshes, [`repair`] mends what has one right answer and says so, [`check`]
//! refuses what is not a solid ([`solid::read_solid`] is the three in one), [`build`] makes sphere
//! trees from true distances ([`distance`]), [`error`] measures them. Results are functions of their
//! input alone: no clock, no randomness but fixed seeds, no dependence on the number of threads.

pub mod blend;
pub mod build;
pub mod built_in;
pub mod cache;
pub mod carry;
pub mod check;
mod cluster;
pub mod compile;
mod compiled_cache;
pub mod distance;
mod edges;
pub mod error;
pub mod family;
pub mod file;
pub mod filled;
mod fit;
pub mod gingiva;
mod level;
pub mod load;
pub mod medial;
pub mod mesh;
pub mod mouth;
mod nearest_sphere;
pub mod organ;
mod parallel;
pub mod parametric;
mod parts;
pub mod patient;
mod polish;
pub mod polygon;
pub mod printed;
mod random;
mod relocate;
pub mod repair;
pub mod sample;
mod samples;
pub mod shapes;
pub mod size;
pub mod skeleton;
pub mod solid;
mod sounded;
pub mod springs;
pub mod sulcus;
pub mod tetrahedra;
mod tighten;
pub mod turned;
mod validate;
mod volume;
pub mod zone;

pub use built_in::{BuiltIn, NotBuiltIn, compile_built_in};
pub use cache::default_cache_dir;
pub use compile::{
    BuildError, BuildOptions, Compiled, compile_default, compile_file, compile_text,
};
pub use solid::{Solid, SolidError, read_solid};
