//! Grades that were made, kept in the state folder.
//!
//! | file | content |
//! |---|---|
//! | `grades/ID.json` | grade as `sulcus-sessions grade --json` prints it, with the length of the recording |
//! | `grades/ID.html` | printable sheet |
//! | `grades/norms.json` | recordings that are norms, with the person who chose each: [`Norms`] |
//! | `grades/ID.expired.json` | facts of a session whose recording was removed: [`expired`] |
//! | `grades/work` | output of the grading that runs |
//!
//! Scores of persons stand beside the recording, in the file that `sulcus-sessions grade --revise` writes.

use std::fs::DirBuilder;
use std::os::unix::fs::DirBuilderExt as _;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::child::Made;
use crate::recordings::norms::Norms;
use crate::recordings::{GRADES, expired};
use crate::state::{StateError, read_private, remove_private, write_private};

/// Version of the layout.
const VERSION: u32 = 1;
/// Largest file that is read, bytes. A grade has some 50 kB.
const MOST: u64 = 16 << 20;

/// Folder of grades.
#[derive(Clone, Debug)]
pub(super) struct Store {
    folder: PathBuf,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Kept {
    version: u32,
    /// Length of the recording, bytes.
    bytes: u64,
    grade: Value,
}

impl Store {
    /// Opens the folder `grades` of a state folder, or makes it.
    ///
    /// # Errors
    /// The folder cannot be made.
    pub fn open(state: &Path) -> Result<Self, StateError> {
        let folder = state.join(GRADES);
        DirBuilder::new()
            .recursive(true)
            .mode(0o700)
            .create(&folder)
            .map_err(StateError::io("create", &folder))?;
        Ok(Self { folder })
    }

    fn json(&self, id: &str) -> PathBuf {
        self.folder.join(format!("{id}.json"))
    }

    fn html(&self, id: &str) -> PathBuf {
        self.folder.join(format!("{id}.html"))
    }

    /// Empty folder for the output of a grading.
    ///
    /// # Errors
    /// The folder cannot be made.
    pub fn work(&self) -> Result<PathBuf, StateError> {
        let work = self.folder.join("work");
        // A folder of a grading that was cut off.
        let _ = std::fs::remove_dir_all(&work);
        DirBuilder::new()
            .mode(0o700)
            .create(&work)
            .map_err(StateError::io("create", &work))?;
        Ok(work)
    }

    /// Grade of a recording of `bytes` bytes; `None` without one, or for a recording that has changed since.
    ///
    /// # Errors
    /// The file cannot be read, or is no such file.
    pub fn grade(&self, id: &str, bytes: u64) -> Result<Option<Value>, StateError> {
        let path = self.json(id);
        let Some(text) = read_private(&path, MOST)? else {
            return Ok(None);
        };
        let kept: Kept = parsed(&path, &text)?;
        Ok((kept.bytes == bytes && kept.version == VERSION).then_some(kept.grade))
    }

    /// Keeps a grade and its sheet.
    ///
    /// # Errors
    /// A file cannot be written.
    pub fn keep(&self, id: &str, bytes: u64, made: &Made) -> Result<(), StateError> {
        write_private(&self.html(id), made.page.as_bytes())?;
        let kept = Kept {
            version: VERSION,
            bytes,
            grade: made.object.clone(),
        };
        let path = self.json(id);
        let text = serde_json::to_vec(&kept).map_err(|error| kind(&path, &error))?;
        write_private(&path, &text)
    }

    /// Sheet of a grade.
    pub fn sheet(&self, id: &str) -> Option<String> {
        let text = read_private(&self.html(id), MOST).ok()??;
        String::from_utf8(text).ok().filter(|text| !text.is_empty())
    }

    /// Names and contents of the files of a session, for an archive.
    pub fn files(&self, id: &str) -> Vec<(String, Vec<u8>)> {
        let files = [self.json(id), self.html(id)].into_iter();
        let read = files.filter_map(|file| {
            let name = file.file_name()?.to_str()?.to_owned();
            Some((name, read_private(&file, MOST).ok()??))
        });
        read.collect()
    }

    /// Folder of the grades, for files that are made for a moment.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Norms among the sessions.
    pub fn norms(&self) -> Norms {
        Norms::of(&self.folder)
    }

    /// Removes a grade, its sheet, its norm and the facts of a removed recording. Returns the number of removed files.
    ///
    /// # Errors
    /// A file cannot be removed.
    pub fn remove(&self, id: &str) -> Result<usize, StateError> {
        let facts = expired::path(&self.folder, id);
        let files = [self.json(id), self.html(id), facts];
        let there = files.iter().filter(|file| file.exists()).count();
        for file in files {
            remove_private(&file)?;
        }
        self.norms()
            .change(|norms| norms.retain(|norm| norm.id != id))?;
        Ok(there)
    }
}

fn parsed<T: serde::de::DeserializeOwned>(path: &Path, text: &[u8]) -> Result<T, StateError> {
    serde_json::from_slice(text).map_err(|error| kind(path, &error))
}

fn kind(path: &Path, error: &serde_json::Error) -> StateError {
    StateError::Kind {
        path: path.to_owned(),
        found: error.to_string(),
        expected: "a file that the console wrote".into(),
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;
    use crate::recordings::norms::Norm;

    #[test]
    fn a_grade_is_kept_with_its_recording_and_removed_whole() {
        let place = tempfile::tempdir().expect("a folder");
        let store = Store::open(place.path()).expect("opens");
        assert_eq!(store.grade("x", 7).expect("reads"), None);
        let made = Made {
            object: json!({ "score": 61.5 }),
            page: "<html>".into(),
        };
        store.keep("x", 7, &made).expect("keeps");
        assert_eq!(store.grade("x", 7).expect("reads"), Some(made.object));
        assert_eq!(store.grade("x", 8).expect("reads"), None, "another file");
        assert_eq!(store.sheet("x").as_deref(), Some("<html>"));
        let norm = |id: &str| Norm {
            id: id.into(),
            by: "t04".into(),
            at_unix_s: 1,
        };
        store
            .norms()
            .change(|norms| norms.extend([norm("x"), norm("y")]))
            .expect("writes");
        assert_eq!(store.remove("x").expect("removes"), 2);
        assert_eq!(store.norms().list().expect("reads"), [norm("y")]);
        assert_eq!(store.sheet("x"), None);
        assert_eq!(store.remove("x").expect("nothing left"), 0);
    }

    #[test]
    fn a_damaged_file_is_an_error_that_names_it() {
        let place = tempfile::tempdir().expect("a folder");
        let store = Store::open(place.path()).expect("opens");
        write_private(&store.json("x"), b"{").expect("writes");
        let told = store.grade("x", 1).expect_err("damaged").to_string();
        assert!(told.contains("x.json"), "{told}");
    }
}
