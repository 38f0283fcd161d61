//! Reasons why a recording is not complete.

use std::path::PathBuf;

use sulcus_program::{PathText, disk};

/// Reason why a recording is not complete.
#[derive(Debug, thiserror::Error)]
pub enum RecordError {
    /// The file exists. A recording is never overwritten.
    #[error("`{}` exists already: a recording is never overwritten, name another file", .0.shown())]
    Exists(PathBuf),
    /// A field of the header is invalid: field, value found, value expected.
    #[error("recording's header: {0}")]
    Header(String),
    /// The file could not be made.
    #[error("cannot make recording `{}`: {source}{}", path.shown(), disk::advice(source))]
    Create {
        /// Path of the file.
        path: PathBuf,
        /// Error of the system.
        source: std::io::Error,
    },
    /// Writing failed for the first time. The flushed part is whole, and nothing more is written.
    #[error("recording stopped after {rows} rows: {what}; the rows before can be read")]
    Stopped {
        /// Rows given to the writer so far.
        rows: u64,
        /// Error of the writer.
        what: String,
    },
    /// A row or snapshot is out of order.
    #[error("tick {found} was given after tick {last}: rows must come in order")]
    Order {
        /// Tick given.
        found: u64,
        /// Tick before it.
        last: u64,
    },
    /// The first row precedes the first snapshot, the state on which the row acts.
    #[error("the first row came before the first snapshot: such a recording cannot be replayed")]
    NoSnapshot,
}
