//! Files for the Rerun viewer, read back.

#[path = "../../../tests/it/common/mod.rs"]
mod common;
mod review;
mod rows;
mod session;
mod tree;
