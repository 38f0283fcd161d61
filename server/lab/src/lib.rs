//! The laboratory: speed against error of ticks and trees, tissue models fitted to finite elements and judged by them, and
//! the commands on trees, scenes and patients. No station needs it: `sulcus-server` has it behind the feature `lab`.
//!
//! Begin at [`commands`]: each subcommand measures with `report` or `tissue` and shows with `page` or `picture`.

#![cfg_attr(not(test), warn(clippy::print_stdout, clippy::print_stderr))]

pub mod commands;

mod page;
mod picture;
mod report;
mod tissue;

pub use picture::{mouth_picture, mouth_sides};
