//! Shared by the tests of every crate: resources that a machine may lack, and the list of long proofs.
//!
//! # Resources
//! A test that needs more than a Rust toolchain asks [`Resource::or_skip`] or [`Resource::path_or_skip`]. Without the
//! resource the test prints `SKIPPED` on the terminal and passes; a resource named in `SULCUS_REQUIRE` makes the test fail.
//!
//! # Long proofs
//! A proof of minutes stands in the table [`long::LONG`] and begins with [`long::selected`]. `SULCUS_LONG=all` runs all of them.

pub mod long;
mod resource;

pub use resource::Resource;

use std::path::{Path, PathBuf};

/// A file or folder of the data beside the checkout: real meshes and finite-element references.
///
/// # Panics
/// As [`Resource::or_skip`].
pub fn data(name: &str) -> Option<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data");
    Resource::Data.path_or_skip(&folder.join(name))
}

/// Name of the running test: the test harness names each thread by its test.
fn test_name() -> String {
    let thread = std::thread::current();
    thread.name().unwrap_or("a test").to_owned()
}
