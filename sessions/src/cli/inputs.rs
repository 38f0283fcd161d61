//! Recordings named by arguments: files and folders.

use std::path::{Path, PathBuf};

use sulcus_program::PathText;

use super::print::at;
use crate::record::read::Recording;

/// Files named by `arguments`, in their order. A folder stands for all recordings in it, without subfolders, sorted by
/// name. A folder without recordings stays in the list, and [`open`] refuses it.
pub fn recordings(arguments: &[PathBuf]) -> Vec<PathBuf> {
    let mut files = Vec::new();
    for argument in arguments {
        let found = if argument.is_dir() {
            within(argument)
        } else {
            Vec::new()
        };
        if found.is_empty() {
            files.push(argument.clone());
        }
        files.extend(found);
    }
    files
}

/// Recordings in a folder, sorted by name. Hidden files are ignored, because a Mac leaves `._NAME.mcap` beside every
/// copy.
fn within(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let mut found: Vec<PathBuf> = entries
        .filter(|entry| !entry.file_name().as_encoded_bytes().starts_with(b"."))
        .map(|entry| entry.path())
        .filter(|path| {
            let ending = path.extension();
            ending.is_some_and(|ending| ending.eq_ignore_ascii_case("mcap")) && path.is_file()
        })
        .collect();
    found.sort();
    found
}

/// Opens a recording.
///
/// # Errors
/// The file is no recording, or a folder: a text with the file's name.
pub fn open(path: &Path) -> anyhow::Result<Recording> {
    if path.is_dir() {
        // For a folder without permission the error is that of the system.
        std::fs::read_dir(path).map_err(|error| at(path, &error))?;
        anyhow::bail!(
            "{}: no recording in this folder, expected files whose names end in .mcap",
            path.shown()
        );
    }
    Recording::open(path).map_err(|error| at(path, &error))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_folder_stands_for_its_recordings_sorted() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = |name: &str| folder.path().join(name);
        for name in ["b.mcap", "a.mcap", "C.MCAP", "._a.mcap", "a.html", "mcap"] {
            std::fs::write(path(name), "").expect("written");
        }
        for name in ["d.mcap", "empty"] {
            std::fs::create_dir(path(name)).expect("made");
        }
        let arguments = [
            path("b.mcap"),
            folder.path().to_owned(),
            path("empty"),
            path("none"),
        ];
        let expected = ["b.mcap", "C.MCAP", "a.mcap", "b.mcap", "empty", "none"];
        assert_eq!(recordings(&arguments), expected.map(path));
        let told = open(&path("empty")).expect_err("refused").to_string();
        assert!(
            told.contains("empty: no recording in this folder"),
            "{told}"
        );
    }
}
