//! Support for the tests of every crate: resources that a machine may lack, and the table of long proofs.
//!
//! # Resources
//! A test that needs more than a Rust toolchain calls [`Resource::or_skip`] or [`Resource::path_or_skip`]. Without the
//! resource the test prints `SKIPPED` on the terminal and passes. If `SULCUS_REQUIRE` names the resource, the test
//! fails.
//!
//! # Long proofs
//! A proof of minutes is a row of the table [`long::LONG`] and begins with [`long::selected`]. `SULCUS_LONG=all` runs
//! all.

pub mod long;
mod resource;

pub use resource::Resource;

use std::path::{Path, PathBuf};

/// Path of a file or folder of the data beside the checkout: real meshes and finite-element references. `None`: the
/// data is missing, and the test is skipped.
///
/// # Panics
/// The data is missing and required, as in [`Resource::or_skip`].
pub fn data(name: &str) -> Option<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data");
    Resource::Data.path_or_skip(&folder.join(name))
}

/// Name of the running test. The test harness names each thread by its test.
fn test_name() -> String {
    let thread = std::thread::current();
    thread.name().unwrap_or("a test").to_owned()
}
