//! The subcommands of `sulcus-server`, one file each.

pub mod patient;
pub mod report;
pub mod scene;
pub mod serve;
pub mod tissue;
pub mod tree;
