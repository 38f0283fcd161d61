//! Recordings of a folder: facts of their headers, read once for each file.

use std::collections::{BTreeMap, BTreeSet};
use std::io::{Read as _, Seek as _, SeekFrom};
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};

use serde::{Deserialize, Serialize};
use sulcus_sessions::record::read::Recording;

/// Last bytes of every finished MCAP file.
const MAGIC: [u8; 8] = *b"\x89MCAP0\r\n";
/// Age of an unfinished file from which no program writes it any more.
const TORN: Duration = Duration::from_secs(60);

/// Recording of a folder.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Entry {
    /// Name of the file without its ending.
    pub id: String,
    pub path: PathBuf,
    pub bytes: u64,
    pub station: String,
    pub learner: String,
    pub exercise: String,
    pub mode: String,
    /// BLAKE3 of the compiled scene, hexadecimal.
    pub scene: String,
    pub started_unix_ns: u64,
    /// File that the recording continues.
    pub continues: Option<String>,
}

/// Known files of a folder.
#[derive(Debug, Default)]
pub(crate) struct Index {
    known: BTreeMap<PathBuf, Known>,
}

#[derive(Debug)]
struct Known {
    bytes: u64,
    modified: SystemTime,
    /// None for a file that is no readable recording.
    entry: Option<Entry>,
}

impl Index {
    /// Finished recordings of `folder`, the newest first. `running` are the names of files that stations write.
    pub fn scan(&mut self, folder: &Path, running: &BTreeSet<String>) -> Vec<Entry> {
        let mut found = Vec::new();
        let mut present = BTreeSet::new();
        let files = std::fs::read_dir(folder).into_iter().flatten().flatten();
        for file in files {
            let path = file.path();
            let name = file.file_name().to_string_lossy().into_owned();
            let is_recording = name.ends_with(".mcap") && !name.starts_with('.');
            if !is_recording || running.contains(&name) {
                continue;
            }
            let Ok(data) = file.metadata() else { continue };
            let Ok(modified) = data.modified() else {
                continue;
            };
            present.insert(path.clone());
            let is_known = self
                .known
                .get(&path)
                .is_some_and(|known| known.bytes == data.len() && known.modified == modified);
            if !is_known {
                let age = SystemTime::now().duration_since(modified);
                if !is_finished(&path) && age.unwrap_or_default() < TORN {
                    continue;
                }
                let known = Known {
                    bytes: data.len(),
                    modified,
                    entry: entry(&path, data.len()),
                };
                self.known.insert(path.clone(), known);
            }
            found.extend(self.known.get(&path).and_then(|known| known.entry.clone()));
        }
        self.known.retain(|path, _| present.contains(path));
        found.sort_by(|a, b| (b.started_unix_ns, &b.id).cmp(&(a.started_unix_ns, &a.id)));
        found
    }
}

/// Sessions of the recordings: each with the recordings that it continues, the oldest first. Recordings that another
/// one continues are no sessions of their own.
pub(crate) fn sessions(all: &[Entry]) -> Vec<(Entry, Vec<PathBuf>)> {
    let name = |entry: &Entry| {
        let name = entry.path.file_name().unwrap_or_default();
        name.to_string_lossy().into_owned()
    };
    let by_name: BTreeMap<String, &Entry> = all.iter().map(|entry| (name(entry), entry)).collect();
    let continued: BTreeSet<&str> = all
        .iter()
        .filter_map(|entry| entry.continues.as_deref())
        .collect();
    let last = all
        .iter()
        .filter(|entry| !continued.contains(name(entry).as_str()));
    let with_parts = |entry: &Entry| {
        let mut before = Vec::new();
        let mut next = entry.continues.as_deref();
        // A ring of names, which only a forger makes, ends by the number of files.
        while let Some(part) = next.and_then(|name| by_name.get(name)) {
            if before.len() >= all.len() {
                break;
            }
            before.push(part.path.clone());
            next = part.continues.as_deref();
        }
        before.reverse();
        (entry.clone(), before)
    };
    last.map(with_parts).collect()
}

fn is_finished(path: &Path) -> bool {
    let read = || {
        let mut end = [0; MAGIC.len()];
        let mut file = std::fs::File::open(path)?;
        file.seek(SeekFrom::End(-(MAGIC.len() as i64)))?;
        file.read_exact(&mut end).map(|()| end)
    };
    read().is_ok_and(|end| end == MAGIC)
}

fn entry(path: &Path, bytes: u64) -> Option<Entry> {
    let header = match Recording::header_of(path) {
        Ok(header) => header,
        Err(error) => {
            tracing::warn!("recordings: {error}");
            return None;
        }
    };
    Some(Entry {
        id: path.file_stem()?.to_str()?.to_owned(),
        path: path.to_owned(),
        bytes,
        station: header.station,
        learner: header.learner_id,
        exercise: header.exercise_name,
        mode: header.mode.unwrap_or_default().to_string(),
        scene: blake3::hash(&header.scene).to_hex().to_string(),
        started_unix_ns: header.started_unix_ns,
        continues: header.predecessor.map(|before| before.file),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn named(id: &str, continues: Option<&str>) -> Entry {
        Entry {
            id: id.into(),
            path: format!("r/{id}.mcap").into(),
            bytes: 1,
            station: "a".into(),
            learner: "s-1".into(),
            exercise: "probing".into(),
            mode: "practice".into(),
            scene: "00".into(),
            started_unix_ns: 1,
            continues: continues.map(|name| format!("{name}.mcap")),
        }
    }

    #[test]
    fn a_continued_recording_is_a_part_of_the_session_that_continues_it() {
        let all = [
            named("c", Some("b")),
            named("b", Some("a")),
            named("a", None),
            named("alone", Some("gone")),
        ];
        let found = sessions(&all);
        let told: Vec<(&str, usize)> = found
            .iter()
            .map(|(entry, before)| (entry.id.as_str(), before.len()))
            .collect();
        assert_eq!(told, [("c", 2), ("alone", 0)]);
        assert_eq!(found[0].1, [Path::new("r/a.mcap"), Path::new("r/b.mcap")]);
        // Two files that name each other end nothing and hang nowhere.
        let ring = [named("x", Some("y")), named("y", Some("x"))];
        assert!(sessions(&ring).is_empty());
    }

    #[test]
    fn a_running_file_a_fresh_torn_one_and_foreign_files_are_left_out() {
        let place = tempfile::tempdir().expect("a folder");
        let corpus = concat!(
            env!("CARGO_MANIFEST_DIR"),
            "/../sessions/tests/corpus/crown-judged.mcap"
        );
        let bytes = std::fs::read(corpus).expect("a recording");
        let put = |name: &str, bytes: &[u8]| {
            std::fs::write(place.path().join(name), bytes).expect("writes");
        };
        put("whole.mcap", &bytes);
        put("running.mcap", &bytes);
        put("torn.mcap", &bytes[..bytes.len() - 4]);
        put("noise.mcap", b"noise \x89MCAP0\r\n");
        put("whole.mcap.grade.json", b"{}");
        let running = BTreeSet::from(["running.mcap".to_owned()]);
        let mut index = Index::default();
        let ids = |index: &mut Index, running: &BTreeSet<String>| -> Vec<String> {
            let found = index.scan(place.path(), running);
            found.into_iter().map(|entry| entry.id).collect()
        };
        assert_eq!(ids(&mut index, &running), ["whole"]);
        assert_eq!(ids(&mut index, &BTreeSet::new()).len(), 2);
        std::fs::remove_file(place.path().join("whole.mcap")).expect("removes");
        assert_eq!(ids(&mut index, &BTreeSet::new()), ["running"]);
    }
}
