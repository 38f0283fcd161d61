//! Folder of recordings: facts of the files, norms, and the end of the time for which a class keeps them.

pub(crate) mod expired;
pub(crate) mod expiry;
pub(crate) mod index;
pub(crate) mod norms;

use std::path::Path;

use crate::state::StateError;

/// Folder of grades in the state folder.
pub(crate) const GRADES: &str = "grades";

/// Error of a file that is not of this program.
fn kind(path: &Path, error: &serde_json::Error) -> StateError {
    StateError::Kind {
        path: path.to_owned(),
        found: error.to_string(),
        expected: "a file that the console wrote".into(),
    }
}
