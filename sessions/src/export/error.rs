//! Reasons why an export is not complete, and creation of its files.

use std::path::{Path, PathBuf};

use sulcus_program::{PathText, disk};

use crate::replay::ReplayError;

/// Reason why an export is not complete.
#[derive(Debug, thiserror::Error)]
pub enum ExportError {
    /// The recording cannot be replayed.
    #[error(transparent)]
    Replay(#[from] ReplayError),
    /// A file cannot be written.
    #[error("cannot write `{}`: {source}{}", path.shown(), disk::advice(source))]
    Write {
        /// Path of the file.
        path: PathBuf,
        /// Error of the system.
        source: std::io::Error,
    },
    /// An option is out of range.
    #[error("{field} is {found}, expected {expected}")]
    Option {
        /// Name of the option.
        field: &'static str,
        /// Value found.
        found: String,
        /// Values expected.
        expected: &'static str,
    },
}

impl ExportError {
    pub(super) fn write(path: &Path, source: impl Into<std::io::Error>) -> Self {
        Self::Write {
            path: path.to_owned(),
            source: system(source.into()),
        }
    }
}

/// Error of the system without the error of the table writer around it. Its kind tells a full disk.
fn system(source: std::io::Error) -> std::io::Error {
    match source.downcast::<csv::Error>().map(csv::Error::into_kind) {
        Ok(csv::ErrorKind::Io(source)) => source,
        Ok(other) => std::io::Error::other(format!("{other:?}")),
        Err(source) => source,
    }
}

/// New file. An existing file is never overwritten.
pub(super) fn create(path: &Path) -> Result<std::io::BufWriter<std::fs::File>, ExportError> {
    std::fs::OpenOptions::new()
        .write(true)
        .create_new(true)
        .open(path)
        .map(std::io::BufWriter::new)
        .map_err(|source| ExportError::write(path, source))
}

pub(super) fn create_folder(path: &Path) -> Result<(), ExportError> {
    std::fs::create_dir_all(path).map_err(|source| ExportError::write(path, source))
}
