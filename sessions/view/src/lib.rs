//! Everything that names rerun; nothing else does.
//!
//! [`write_tree`] writes a sphere tree and its errors as a file for the Rerun viewer. Here will also
//! be the live view of a session that is running and the review of a recorded one. Rerun takes
//! minutes to compile, so whoever uses this crate does so behind a feature.

mod tree;

pub use tree::{LevelPicture, TreePicture, write_tree};

use std::path::PathBuf;

/// What Rerun said.
pub type Refusal = Box<dyn std::error::Error + Send + Sync>;

/// Why a file for the viewer could not be written.
#[derive(Debug, thiserror::Error)]
pub enum ViewError {
    /// The file cannot be written, or Rerun refuses what goes into it.
    #[error("{}: cannot write the file for Rerun: {source}", file.display())]
    Write {
        /// The file.
        file: PathBuf,
        /// What Rerun said.
        source: Refusal,
    },
    /// What should be shown does not fit together.
    #[error("level {level}: {field} has {found} entries, expected {expected}")]
    Shape {
        /// The level.
        level: u8,
        /// Which list.
        field: &'static str,
        /// Its length.
        found: usize,
        /// The length that fits.
        expected: usize,
    },
}
