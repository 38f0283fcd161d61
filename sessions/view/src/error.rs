//! Errors of files for the viewer.

use std::path::PathBuf;

use sulcus_program::PathText;

/// Error of Rerun.
pub type Refusal = Box<dyn std::error::Error + Send + Sync>;

/// Reason why a file for the viewer could not be written.
#[derive(Debug, thiserror::Error)]
pub enum ViewError {
    /// The file cannot be written, or Rerun refuses its content.
    #[error("{}: cannot write the file for Rerun: {source}", file.shown())]
    Write {
        /// Path of the file.
        file: PathBuf,
        /// Error of Rerun.
        source: Refusal,
    },
    /// A list or number of a review is invalid.
    #[error("{part}: {field} is {found}, expected {expected}")]
    Fit {
        /// Tool, part of the mouth, or kind of row.
        part: String,
        /// Name of the list or number.
        field: &'static str,
        /// Value found.
        found: usize,
        /// Value expected.
        expected: usize,
    },
    /// A list of a sphere tree's picture has another length.
    #[error("level {level}: {field} has {found} entries, expected {expected}")]
    Shape {
        /// Number of the level.
        level: u8,
        /// Name of the list.
        field: &'static str,
        /// Length found.
        found: usize,
        /// Length expected.
        expected: usize,
    },
}
