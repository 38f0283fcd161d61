//! Files of one session: a recording, and the recordings that it continues.

use std::path::{Path, PathBuf};

use crate::grade::parts;
use crate::record::predecessor::Predecessor;
use crate::record::read::Recording;

/// Files of a session.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct SessionFiles {
    /// Last recording. Scores of people are kept beside it.
    pub last: PathBuf,
    /// Recordings before it, in the order of the session.
    pub before: Vec<PathBuf>,
}

/// Sessions of the files, in the order of their last recordings. A recording that names another of the files is put
/// behind it. A file that cannot be read is a session of its own, which the grade refuses.
pub(super) fn sessions(files: &[PathBuf]) -> Vec<SessionFiles> {
    let alone = |file: &PathBuf| SessionFiles {
        last: file.clone(),
        before: Vec::new(),
    };
    let named = |file: &Path| Recording::header_of(file).ok()?.predecessor;
    let named: Vec<Option<Predecessor>> = files.iter().map(|file| named(file)).collect();
    if files.len() < 2 || named.iter().all(Option::is_none) {
        return files.iter().map(alone).collect();
    }
    let hash = |file: &PathBuf| Predecessor::of(file).map_or([0; 32], |of| of.blake3);
    let items: Vec<_> = files
        .iter()
        .zip(named)
        .map(|(file, named)| (hash(file), named.map(|named| named.blake3)))
        .collect();
    let group = |group: Vec<usize>| {
        let (last, before) = group.split_last()?;
        Some(SessionFiles {
            last: files[*last].clone(),
            before: before.iter().map(|k| files[*k].clone()).collect(),
        })
    };
    parts::sessions(&items)
        .into_iter()
        .filter_map(group)
        .collect()
}
