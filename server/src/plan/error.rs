//! Errors of plans, of their files and of their changes.

use std::path::{Path, PathBuf};

use sulcus_program::PathText;

use super::change::Fault;
use crate::exact::TomlError;
use crate::state::StateError;

/// Reason why a plan or a file of plans cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum PlanError {
    /// A file cannot be read.
    #[error("{}: cannot read: {source}", path.shown())]
    Read {
        /// File.
        path: PathBuf,
        /// Error of the system.
        source: std::io::Error,
    },
    /// The content of a file is not valid.
    #[error("{}, line {line}: {why}", path.shown())]
    Content {
        /// File.
        path: PathBuf,
        /// Line, from 1.
        line: usize,
        /// Field, value found and value expected.
        why: String,
    },
    /// The parts of a changed plan do not fit each other.
    #[error("plan of station `{station}`: {fault}")]
    Fault {
        /// Name of the station.
        station: String,
        /// Parts that do not fit.
        fault: Fault,
    },
    /// No station has the name.
    #[error("station `{found}` is unknown, expected one of {known}")]
    Unknown {
        /// Name asked for.
        found: String,
        /// Names of the stations, separated by commas.
        known: String,
    },
    /// The session of an exam runs.
    #[error(
        "station `{station}` runs an exam: its plan cannot be changed until the session has ended"
    )]
    ExamRuns {
        /// Name of the station.
        station: String,
    },
    /// The state folder cannot be used.
    /// The plan cannot be compiled or run.
    #[error("plan of station `{station}`: {why}")]
    NotReady {
        /// Name of the station.
        station: String,
        /// Cause.
        why: String,
    },
    /// The state folder cannot be used.
    #[error(transparent)]
    State(#[from] StateError),
}

/// Error of the TOML reader as one line: file, line and reason.
pub(super) fn content(path: &Path, text: &str, error: &TomlError) -> PlanError {
    PlanError::Content {
        path: path.to_owned(),
        line: error.span().map_or(1, |span| line_of(text, span.start)),
        why: error.message().trim().replace('\n', ", "),
    }
}

/// Line of a byte of a text, from 1.
pub(super) fn line_of(text: &str, at: usize) -> usize {
    let before = text.get(..at).unwrap_or(text);
    1 + before.matches('\n').count()
}
