//! Errors of the state folder and its files.

use std::path::{Path, PathBuf};

use sulcus_program::PathText;

/// Reason why the state folder or one of its files cannot be used. No text of an error contains a secret.
#[derive(Debug, thiserror::Error)]
pub enum StateError {
    /// No folder is known.
    #[error(
        "no state folder: name one with --state, or set SULCUS_STATE_DIR, XDG_STATE_HOME or HOME"
    )]
    NoHome,
    /// A call of the system failed.
    #[error("cannot {action} {}: {source}{}", path.shown(), sulcus_program::disk::advice(source))]
    Io {
        /// Failed action.
        action: &'static str,
        /// File or folder.
        path: PathBuf,
        /// Error of the system.
        source: std::io::Error,
    },
    /// Other users can read a secret, or write into the folder.
    #[error("{} has mode {mode:03o}, expected {expected:03o}: other users could read secrets or replace them; run chmod {expected:03o} on it", path.shown())]
    Exposed {
        /// File or folder.
        path: PathBuf,
        /// Permission bits found.
        mode: u32,
        /// Permission bits expected.
        expected: u32,
    },
    /// Another user owns the file or folder.
    #[error("{} belongs to user {owner}, but this program runs as user {user}: run it as the owner, or choose another folder with --state", path.shown())]
    Foreign {
        /// File or folder.
        path: PathBuf,
        /// Number of its owner.
        owner: u32,
        /// Number of the user of this process.
        user: u32,
    },
    /// The path is no regular file or no folder, or the content is longer than the limit.
    #[error("{} is {found}, expected {expected}", path.shown())]
    Kind {
        /// File or folder.
        path: PathBuf,
        /// Kind or length found.
        found: String,
        /// Kind or length expected.
        expected: String,
    },
    /// The content is not valid.
    #[error("{}: {why}", path.shown())]
    Content {
        /// File.
        path: PathBuf,
        /// Reason, with field, value found and value expected.
        why: String,
    },
    /// Another process holds the lock.
    #[error("{} is locked by another process of sulcus-server: {advice}", path.shown())]
    Busy {
        /// File of the lock.
        path: PathBuf,
        /// Action that helps.
        advice: &'static str,
    },
    /// The system has no random numbers.
    #[error("the system gave no random numbers: {0}")]
    Random(String),
    /// The certificate could not be made.
    #[error("cannot make the server's certificate: {0}")]
    Certificate(String),
}

impl StateError {
    /// Makes the error of a failed call on `path`.
    pub(crate) fn io(action: &'static str, path: &Path) -> impl Fn(std::io::Error) -> Self + use<> {
        let path = path.to_owned();
        move |source| Self::Io {
            action,
            path: path.clone(),
            source,
        }
    }

    /// Error of a content that is not valid.
    pub(crate) fn content(path: &Path, why: impl Into<String>) -> Self {
        Self::Content {
            path: path.to_owned(),
            why: why.into(),
        }
    }
}

/// Fills `bytes` with random numbers of the system.
///
/// # Errors
/// The system has none.
pub(crate) fn random(bytes: &mut [u8]) -> Result<(), StateError> {
    getrandom::fill(bytes).map_err(|error| StateError::Random(error.to_string()))
}
