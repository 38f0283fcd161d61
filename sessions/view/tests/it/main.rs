//! Files for the Rerun viewer, read back.

mod review;
mod tree;
