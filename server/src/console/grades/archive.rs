//! Archive with everything that the server has of a learner.

use std::fs::File;
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};

use sulcus_sessions::grade::revision::beside;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipWriter};

use super::store::Store;

/// Text for the person who receives the archive.
const READ_ME: &str = "\
Sessions of one learner of the Sulcus simulator.

NAME.mcap             recording: input of every tick, forces, events, signed by the station
NAME.mcap.grade.json  scores of persons and the program's proposal, if a person gave a score
NAME.json             grade by the program: metrics, sites, moments
NAME.html             printable sheet of the grade

`sulcus-sessions info`, `replay`, `grade` and `export` read the recordings; `export` makes tables of them.
The learner appears by an opaque id alone. Names are in the key table of the school.
";

/// Writes the archive of sessions, each with its recordings, to a new file at `path`.
///
/// # Errors
/// A file cannot be read or written.
pub(super) fn write(
    path: &Path,
    store: &Store,
    sessions: &[(String, Vec<PathBuf>)],
) -> io::Result<()> {
    let mut zip = ZipWriter::new(File::create_new(path)?);
    // Recordings are compressed already, and may exceed four gibibytes.
    let stored = SimpleFileOptions::default()
        .compression_method(CompressionMethod::Stored)
        .large_file(true)
        .unix_permissions(0o600);
    let failed = io::Error::other;
    zip.start_file("README.txt", stored).map_err(failed)?;
    zip.write_all(READ_ME.as_bytes())?;
    for (id, recordings) in sessions {
        for (name, text) in store.files(id) {
            zip.start_file(name, stored).map_err(failed)?;
            zip.write_all(&text)?;
        }
        for recording in recordings {
            for file in [recording.clone(), beside(recording)] {
                if !file.is_file() {
                    continue;
                }
                let name = file.file_name().unwrap_or_default().to_string_lossy();
                zip.start_file(name, stored).map_err(failed)?;
                io::copy(&mut File::open(&file)?, &mut zip)?;
            }
        }
    }
    zip.finish().map_err(failed)?.sync_all()
}

#[cfg(test)]
mod tests {
    use std::io::Read as _;

    use serde_json::json;

    use super::super::child::Made;
    use super::*;

    #[test]
    fn the_archive_has_recordings_scores_grades_and_sheets() {
        let place = tempfile::tempdir().expect("a folder");
        let store = Store::open(place.path()).expect("opens");
        let made = Made {
            object: json!({ "score": 61.5 }),
            page: "<html>".into(),
        };
        store.keep("x", 5, &made).expect("keeps");
        let recording = place.path().join("x.mcap");
        std::fs::write(&recording, b"whole").expect("writes");
        std::fs::write(beside(&recording), b"{}").expect("writes");
        let path = place.path().join("all.zip");
        write(&path, &store, &[("x".into(), vec![recording])]).expect("an archive");
        let mut zip = zip::ZipArchive::new(File::open(&path).expect("opens")).expect("a zip");
        let names: Vec<String> = zip
            .file_names()
            .map(|name| name.expect("a name").into_owned())
            .collect();
        assert_eq!(
            names,
            [
                "README.txt",
                "x.json",
                "x.html",
                "x.mcap",
                "x.mcap.grade.json"
            ]
        );
        let mut bytes = Vec::new();
        let mut file = zip.by_name("x.mcap").expect("a recording");
        file.read_to_end(&mut bytes).expect("reads");
        assert_eq!(bytes, b"whole");
    }
}
