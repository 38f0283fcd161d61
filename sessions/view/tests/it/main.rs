//! Files for the Rerun viewer, read back.

#[path = "../../../tests/it/common/mod.rs"]
mod common;
mod live;
mod review;
mod rows;
mod session;
mod tree;
