//! Scene compilation, offline: meshes to sphere trees, scene files, parametric parts.
//!
//! [`compile::compile_file`] compiles a scene file ([`mod@file`]) to a [`sulcus_core::Scene`].
//!
//! - [`mesh`] loads meshes, repairs faults that have one right repair, and refuses all that is not a solid
//!   ([`mesh::solid::read_solid`]).
//! - [`anatomy`] and [`instruments`] make meshes from dimensions.
//! - [`tree`] makes sphere trees from true distances; [`mod@error`] measures their errors.
//! - [`organ`] makes the skeleton or the finite elements of an organ.
//! - [`mod@cache`] keeps trees and scenes on disk.
//!
//! Results are functions of their input alone. They do not depend on clock, randomness or number of threads.

pub mod anatomy;
pub mod cache;
pub mod compile;
pub mod error;
pub mod file;
mod hand_written;
pub mod instruments;
pub mod mesh;
pub mod organ;
mod parallel;
mod random;
pub mod tree;

pub use cache::default_cache_dir;
pub use compile::built_in::{BuiltIn, NotBuiltIn, compile_built_in, compile_default};
pub use compile::{BuildError, BuildOptions, Compiled, compile_file, compile_text};
pub use mesh::solid::{Solid, SolidError, read_solid};
pub use parallel::limit_threads;
