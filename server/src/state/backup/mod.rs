//! Backup of a state folder: one archive with every file and a list of their hashes.
//!
//! The archive is a tar file. Its last entry, `backup.json`, has the format, and length and BLAKE3 of every file. An
//! archive that was cut off or changed is refused before a folder is made from it. Recordings are not part of the
//! archive: they are signed, never change, and are copied by other programs.

mod list;
mod restore;
mod write;

use std::path::PathBuf;

use sulcus_program::PathText;

use super::error::StateError;

pub use restore::restore;
pub use write::write;

/// Name of the list in the archive.
const LIST: &str = "backup.json";
/// Format of the archive.
const FORMAT: u32 = 1;

/// Content of a backup.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Content {
    /// Number of files.
    pub files: usize,
    /// Sum of their lengths, bytes.
    pub bytes: u64,
}

/// Reason why a backup cannot be made or restored.
#[derive(Debug, thiserror::Error)]
pub enum BackupError {
    /// The state folder or one of its files cannot be used.
    #[error(transparent)]
    State(#[from] StateError),
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
    /// The archive would be part of itself.
    #[error("{} lies in the state folder, expected a file outside of it", path.shown())]
    Inside {
        /// Archive.
        path: PathBuf,
    },
    /// A file of the folder is of a kind that no backup has.
    #[error("{} is {found}, expected a file or a folder", path.shown())]
    Kind {
        /// File.
        path: PathBuf,
        /// Kind found.
        found: &'static str,
    },
    /// The folder changed during each attempt.
    #[error(
        "the state folder changed during {attempts} attempts: try again when nobody edits classes or cases"
    )]
    Busy {
        /// Number of attempts.
        attempts: u32,
    },
    /// The target has files already.
    #[error(
        "the state folder {} is not empty: restore into a new folder with --state, or move this one away", path.shown()
    )]
    NotEmpty {
        /// Folder.
        path: PathBuf,
    },
    /// A newer release made the backup.
    #[error(
        "the backup has format {found}, this program reads format 1 to {FORMAT}: install release {program}, which made it"
    )]
    Newer {
        /// Format found.
        found: u32,
        /// Release that made the backup.
        program: String,
    },
    /// The archive is damaged or no backup.
    #[error("{} is no whole backup: {why}", path.shown())]
    Damaged {
        /// Archive.
        path: PathBuf,
        /// Reason, with the value found and the value expected.
        why: String,
    },
}

impl BackupError {
    fn io(action: &'static str, path: &std::path::Path) -> impl Fn(std::io::Error) -> Self + use<> {
        let path = path.to_owned();
        move |source| Self::Io {
            action,
            path: path.clone(),
            source,
        }
    }
}

#[cfg(test)]
mod tests;
