//! Why a recording stopped or was never made.

use std::path::PathBuf;

use sulcus_program::{PathText, disk};

/// Why a recording is not complete.
#[derive(Debug, thiserror::Error)]
pub enum RecordError {
    /// A recording is never overwritten.
    #[error("`{}` exists already: a recording is never overwritten, name another file", .0.shown())]
    Exists(PathBuf),
    /// The file could not be made.
    #[error("cannot make recording `{}`: {source}{}", path.shown(), disk::advice(source))]
    Create {
        /// Which file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// The first failure to write. What was flushed before is whole; nothing more is written.
    #[error("recording stopped after {rows} rows: {what}; what was written before can be read")]
    Stopped {
        /// Rows given to the writer so far.
        rows: u64,
        /// What went wrong.
        what: String,
    },
    /// Rows must come in the order of their ticks, after the first snapshot.
    #[error("tick {found} was given after tick {last}: rows must come in order")]
    Order {
        /// Tick given.
        found: u64,
        /// Tick before it.
        last: u64,
    },
    /// A recording begins with the state that its first row acts on.
    #[error("the first row came before the first snapshot: nothing could be replayed")]
    NoSnapshot,
}
