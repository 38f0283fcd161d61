//! Facts of sessions whose recordings were removed at the end of their time: `grades/ID.expired.json`.
//!
//! The grade, the sheet and the scores of persons stay. The facts let the pages of results show them further on.

#[cfg(feature = "console")]
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::index::Entry;
use super::kind;
#[cfg(feature = "console")]
use crate::state::read_private;
use crate::state::{StateError, write_private};

/// Ending of the files.
const ENDING: &str = ".expired.json";
/// Version of the layout.
const VERSION: u32 = 1;
/// Largest file that is read, bytes.
#[cfg(feature = "console")]
const MOST: u64 = 64 << 10;

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Kept {
    version: u32,
    /// Time of the removal, seconds since 1970.
    removed_unix_s: u64,
    entry: Entry,
}

/// Path of the facts of a session.
pub(crate) fn path(grades: &Path, id: &str) -> PathBuf {
    grades.join(format!("{id}{ENDING}"))
}

/// Keeps the facts of a session whose recording is about to be removed.
///
/// # Errors
/// The file cannot be written.
pub(crate) fn keep(grades: &Path, entry: &Entry, now_s: u64) -> Result<(), StateError> {
    let path = path(grades, &entry.id);
    let kept = Kept {
        version: VERSION,
        removed_unix_s: now_s,
        entry: entry.clone(),
    };
    let text = serde_json::to_vec(&kept).map_err(|error| kind(&path, &error))?;
    write_private(&path, &text)
}

/// Facts of a folder, each read once.
#[cfg(feature = "console")]
#[derive(Debug, Default)]
pub(crate) struct Expired {
    known: BTreeMap<String, Option<Entry>>,
}

#[cfg(feature = "console")]
impl Expired {
    /// Sessions without a recording. An unreadable file is left out, with a message in the log.
    pub fn scan(&mut self, grades: &Path) -> Vec<Entry> {
        let files = std::fs::read_dir(grades).into_iter().flatten().flatten();
        let names = files.filter_map(|file| {
            let name = file.file_name().into_string().ok()?;
            name.ends_with(ENDING).then_some(name)
        });
        let names: Vec<String> = names.collect();
        self.known.retain(|name, _| names.contains(name));
        for name in names {
            self.known
                .entry(name)
                .or_insert_with_key(|name| read(&grades.join(name)));
        }
        self.known.values().flatten().cloned().collect()
    }
}

#[cfg(feature = "console")]
fn read(path: &Path) -> Option<Entry> {
    let read = read_private(path, MOST).and_then(|text| {
        let kept = text.map(|text| serde_json::from_slice::<Kept>(&text));
        kept.transpose().map_err(|error| kind(path, &error))
    });
    match read {
        Ok(kept) => Some(kept.filter(|kept| kept.version == VERSION)?.entry),
        Err(error) => {
            tracing::error!("recordings: {error}");
            None
        }
    }
}
