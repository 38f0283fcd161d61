//! Check of the folder of the recordings.

use std::fs::OpenOptions;
use std::io::{self, Write};
use std::path::Path;

use super::check::{Check, part, shorten, shown};

const NAME: &str = "disk";
/// Bytes of one hour with two hands.
const HOUR: u64 = 1_200_000_000;
/// Names of the probe file that are tried. An existing file is never touched.
const NAMES: u32 = 16;

/// Writes and removes a probe file in the folder, and compares the free space. For a missing folder both are done in
/// the next folder above that exists: a run creates the missing ones, this check creates none.
pub fn check(recordings: &Path) -> Check {
    let wrong = |folder: &Path, reason: &str| {
        Check::wrong(
            NAME,
            format!(
                "no file can be written in {}: {}. Get the right to write, or choose another folder with --recordings.",
                shown(folder),
                part(reason)
            ),
        )
    };
    let folder = match existing(recordings) {
        Ok(folder) => folder,
        Err(error) => return wrong(recordings, &error.to_string()),
    };
    match probe(folder) {
        Ok(()) => judge(recordings, folder, free(folder)),
        Err(error) => wrong(folder, &error.to_string()),
    }
}

/// The folder itself, or the next one above that exists.
fn existing(recordings: &Path) -> io::Result<&Path> {
    for folder in recordings.ancestors() {
        // The last part of a relative path is empty: the present folder.
        let folder = if folder.as_os_str().is_empty() {
            Path::new(".")
        } else {
            folder
        };
        match std::fs::metadata(folder) {
            Ok(data) if data.is_dir() => return Ok(folder),
            Ok(_) => return Err(io::ErrorKind::NotADirectory.into()),
            Err(error) if error.kind() == io::ErrorKind::NotFound => {}
            Err(error) => return Err(error),
        }
    }
    Err(io::ErrorKind::NotFound.into())
}

/// Creates, writes and removes a file of a new name.
fn probe(folder: &Path) -> io::Result<()> {
    let mut result = Err(io::ErrorKind::AlreadyExists.into());
    for number in 0..NAMES {
        let path = folder.join(format!(".sulcus-probe-{}-{number}", std::process::id()));
        match OpenOptions::new().write(true).create_new(true).open(&path) {
            Ok(mut file) => {
                let written = file.write_all(&[0; 4096]).and_then(|()| file.sync_all());
                drop(file);
                return written.and(std::fs::remove_file(&path));
            }
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => result = Err(error),
            Err(error) => return Err(error),
        }
    }
    result
}

/// Free space for this user, bytes; `None` if the system does not tell it.
#[cfg(unix)]
fn free(folder: &Path) -> Option<u64> {
    let state = rustix::fs::statvfs(folder).ok()?;
    Some(state.f_bavail.saturating_mul(state.f_frsize))
}

#[cfg(not(unix))]
fn free(_: &Path) -> Option<u64> {
    None
}

/// Compares the free space with one hour. `folder` exists; it is `recordings` or a folder above.
fn judge(recordings: &Path, folder: &Path, free: Option<u64>) -> Check {
    let place = shown(folder);
    let later = if folder == recordings {
        String::new()
    } else {
        let name = shorten(&recordings.to_string_lossy(), 50);
        format!(" The folder {name} does not exist yet: the first recording creates it.")
    };
    let Some(free) = free else {
        return Check::fine(
            NAME,
            format!(
                "files can be written in {place}; free space is not checked on this system.{later}"
            ),
        );
    };
    let gigabytes = free as f64 / 1e9;
    if free < HOUR {
        return Check::wrong(
            NAME,
            format!(
                "{place} has {gigabytes:.1} GB of free space; one hour of two hands needs 1.2 GB. Delete or move old \
                 recordings, or choose another folder with --recordings."
            ),
        );
    }
    let hours = free / HOUR;
    Check::fine(
        NAME,
        format!(
            "{place} can be written and has {gigabytes:.1} GB of free space, enough for {hours} h of two hands.{later}"
        ),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_folder_is_probed_and_left_as_it_was() {
        let folder = tempfile::tempdir().expect("temporary folder");
        let result = check(folder.path());
        assert!(
            result.message.contains("GB of free space") || result.message.contains("not checked")
        );
        assert_eq!(
            std::fs::read_dir(folder.path()).expect("a folder").count(),
            0
        );
    }

    #[test]
    fn a_missing_folder_is_not_created_and_the_folder_above_is_probed() {
        let folder = tempfile::tempdir().expect("temporary folder");
        let missing = folder.path().join("a/b");
        assert_eq!(existing(&missing).expect("the folder above"), folder.path());
        let result = check(&missing);
        assert!(
            result.message.contains("GB of free space") || result.message.contains("not checked"),
            "{result:?}"
        );
        assert_eq!(
            std::fs::read_dir(folder.path()).expect("a folder").count(),
            0
        );
        let result = judge(&missing, folder.path(), Some(HOUR));
        assert!(
            result.ok && result.message.contains("does not exist yet"),
            "{result:?}"
        );
        assert_eq!(
            existing(Path::new("no-such-folder-of-sulcus")).expect("present folder"),
            Path::new(".")
        );
    }

    #[test]
    fn a_file_is_no_folder() {
        let folder = tempfile::tempdir().expect("temporary folder");
        let file = folder.path().join("recordings");
        std::fs::write(&file, "").expect("written");
        for path in [file.clone(), file.join("below")] {
            let result = check(&path);
            assert!(
                !result.ok && result.message.contains("--recordings"),
                "{result:?}"
            );
        }
    }

    #[test]
    fn existing_files_are_never_touched() {
        let folder = tempfile::tempdir().expect("temporary folder");
        for number in 0..NAMES {
            let name = format!(".sulcus-probe-{}-{number}", std::process::id());
            std::fs::write(folder.path().join(name), "mine").expect("written");
        }
        assert!(!check(folder.path()).ok);
        for entry in std::fs::read_dir(folder.path()).expect("a folder") {
            assert_eq!(
                std::fs::read(entry.expect("an entry").path()).expect("a file"),
                b"mine"
            );
        }
    }

    #[test]
    fn space_for_less_than_one_hour_is_wrong() {
        let path = Path::new("/recordings");
        assert!(!judge(path, path, Some(HOUR - 1)).ok);
        let fine = judge(path, path, Some(3 * HOUR + 5));
        assert!(
            fine.ok && fine.message.contains("3.6 GB") && fine.message.contains("3 h"),
            "{fine:?}"
        );
        assert!(judge(path, path, None).ok);
        let long = "d/".repeat(400);
        for (free, ending) in [
            (Some(0), "--recordings."),
            (Some(u64::MAX), "creates it."),
            (None, "creates it."),
        ] {
            let result = judge(Path::new(&long), Path::new(&long[..600]), free);
            assert!(
                result.message.chars().count() <= 300 && result.message.ends_with(ending),
                "{result:?}"
            );
        }
    }
}
