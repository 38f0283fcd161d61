//! Norms: recordings of experts, whose values stand beside those of every other session of the exercise.

use std::fs::DirBuilder;
use std::os::unix::fs::DirBuilderExt as _;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::kind;
use crate::state::{Lock, StateError, read_private, write_private};

/// File of the norms in the folder of grades.
const FILE: &str = "norms.json";
/// Version of the layout.
const VERSION: u32 = 1;
/// Largest file that is read, bytes.
const MOST: u64 = 16 << 20;

/// Norm: recording of an expert.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Norm {
    /// Id of the session.
    pub id: String,
    /// Opaque id of the person who chose it.
    pub by: String,
    /// Time, seconds since 1970.
    pub at_unix_s: u64,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Kept {
    version: u32,
    norms: Vec<Norm>,
}

/// Norms of a folder of grades.
#[derive(Clone, Debug)]
pub(crate) struct Norms {
    folder: PathBuf,
}

impl Norms {
    /// Norms of the folder `grades` of a state folder.
    pub fn of(grades: &Path) -> Self {
        Self {
            folder: grades.to_owned(),
        }
    }

    /// Norms, in the order of their choice.
    ///
    /// # Errors
    /// The file cannot be read, or is no such file.
    pub fn list(&self) -> Result<Vec<Norm>, StateError> {
        let path = self.folder.join(FILE);
        let Some(text) = read_private(&path, MOST)? else {
            return Ok(Vec::new());
        };
        let kept: Kept = serde_json::from_slice(&text).map_err(|error| kind(&path, &error))?;
        Ok(kept.norms)
    }

    /// Changes the norms. An unchanged list is not written.
    ///
    /// # Errors
    /// The file cannot be read or written.
    pub fn change<R>(&self, how: impl FnOnce(&mut Vec<Norm>) -> R) -> Result<R, StateError> {
        DirBuilder::new()
            .recursive(true)
            .mode(0o700)
            .create(&self.folder)
            .map_err(StateError::io("create", &self.folder))?;
        let _lock = Lock::wait(&self.folder.join("norms.lock"))?;
        let before = self.list()?;
        let mut norms = before.clone();
        let result = how(&mut norms);
        if norms == before {
            return Ok(result);
        }
        let path = self.folder.join(FILE);
        let kept = Kept {
            version: VERSION,
            norms,
        };
        let text = serde_json::to_vec_pretty(&kept).map_err(|error| kind(&path, &error))?;
        write_private(&path, &text)?;
        Ok(result)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_damaged_list_is_an_error_and_nothing_is_lost() {
        let place = tempfile::tempdir().expect("a folder");
        let norms = Norms::of(&place.path().join("grades"));
        assert_eq!(norms.list().expect("no file"), []);
        let norm = Norm {
            id: "x".into(),
            by: "t-1".into(),
            at_unix_s: 1,
        };
        norms.change(|all| all.push(norm.clone())).expect("writes");
        assert_eq!(norms.list().expect("reads"), [norm]);
        write_private(&place.path().join("grades").join(FILE), b"[]").expect("writes");
        norms.list().expect_err("another layout");
        norms.change(Vec::clear).expect_err("nothing is lost");
    }
}
