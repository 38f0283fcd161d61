//! Reasons why a recording cannot be replayed.

use crate::record::gap::Gap;
use crate::record::read::ReadError;

/// Reason why a recording cannot be replayed.
#[derive(Debug, thiserror::Error)]
pub enum ReplayError {
    /// The recording cannot be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// The state of the starting snapshot is invalid for the scene.
    #[error("starting snapshot of the recording cannot be used: {0}")]
    Snapshot(String),
    /// A comparison cannot cross a gap.
    #[error(
        "recording has a gap ({0}): compare a part of it before or behind the gap, by --from and --to"
    )]
    Gap(Gap),
    /// The requested part is not in the session.
    #[error("{field} is {found}, expected {expected}")]
    Span {
        /// `from` or `to`.
        field: &'static str,
        /// Value found, seconds.
        found: f64,
        /// Values expected.
        expected: String,
    },
}
