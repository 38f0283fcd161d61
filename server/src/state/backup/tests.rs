//! Tests of backups: round trips, damage at any byte, archives by others, folders that change.

use std::collections::BTreeMap;
use std::os::unix::fs::{PermissionsExt as _, symlink};
use std::path::Path;

use proptest::prelude::*;

use super::*;
use crate::state::StateFolder;

fn files(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut all = BTreeMap::new();
    let mut open = vec![folder.to_owned()];
    while let Some(at) = open.pop() {
        for entry in std::fs::read_dir(at).expect("a folder") {
            let path = entry.expect("an entry").path();
            let mode = path.metadata().expect("metadata").permissions().mode() & 0o777;
            if path.is_dir() {
                assert_eq!(mode, 0o700, "{path:?}");
                open.push(path);
            } else {
                assert_eq!(mode, 0o600, "{path:?}");
                let name = path.strip_prefix(folder).expect("inside").to_string_lossy();
                all.insert(name.into_owned(), std::fs::read(&path).expect("a file"));
            }
        }
    }
    all
}

fn state(place: &Path, content: &[(&str, &[u8])]) -> StateFolder {
    let folder = StateFolder::open(Some(&place.join("state"))).expect("a folder");
    for (name, bytes) in content {
        let path = folder.file(name);
        let parent = StateFolder::open(path.parent()).expect("a folder");
        let name = path
            .file_name()
            .expect("a name")
            .to_string_lossy()
            .into_owned();
        crate::state::write_private(&parent.file(&name), bytes).expect("writes");
    }
    folder
}

const CONTENT: [(&str, &[u8]); 4] = [
    ("station.key", b"secret"),
    ("tokens.json", b"{}"),
    ("cases/one.toml", b"label = 1"),
    ("grades/empty.json", b""),
];

#[test]
fn a_restored_folder_has_the_same_files_and_no_lock() {
    let place = tempfile::tempdir().expect("a folder");
    let folder = state(place.path(), &CONTENT);
    std::fs::write(folder.file("classes.lock"), b"").expect("writes");
    let _socket =
        std::os::unix::net::UnixListener::bind(folder.file("control.sock")).expect("binds");
    let to = place.path().join("a.backup");
    let content = write(&folder, &to).expect("a backup");
    assert_eq!((content.files, content.bytes), (4, 17));
    assert_eq!(
        to.metadata().expect("a file").permissions().mode() & 0o777,
        0o600
    );
    for target in ["new/deep", "empty"] {
        let target = place.path().join(target);
        if target.ends_with("empty") {
            std::fs::create_dir(&target).expect("a folder");
        }
        assert_eq!(restore(&to, &target).expect("restored"), content);
        let expected: BTreeMap<String, Vec<u8>> = CONTENT
            .iter()
            .map(|(name, bytes)| ((*name).into(), bytes.to_vec()))
            .collect();
        assert_eq!(files(&target), expected);
        StateFolder::open(Some(&target)).expect("a state folder");
        let again = restore(&to, &target).expect_err("not empty");
        assert!(matches!(again, BackupError::NotEmpty { .. }), "{again}");
    }
    let again = write(&folder, &to).expect_err("never replaced");
    assert!(again.to_string().contains("exists"), "{again}");
    assert!(
        restore(&to, &place.path().join("third")).is_ok(),
        "the first backup is whole"
    );
    let inside = write(&folder, &folder.file("b.backup")).expect_err("inside");
    assert!(matches!(inside, BackupError::Inside { .. }), "{inside}");
}

#[test]
fn a_link_in_the_folder_is_named_and_no_archive_is_left() {
    let place = tempfile::tempdir().expect("a folder");
    let folder = state(place.path(), &CONTENT);
    symlink("/etc/hostname", folder.file("link")).expect("a link");
    let to = place.path().join("a.backup");
    let error = write(&folder, &to).expect_err("a link");
    assert!(error.to_string().contains("link is a link"), "{error}");
    assert!(!to.exists());
}

#[test]
fn a_newer_format_names_its_release() {
    let place = tempfile::tempdir().expect("a folder");
    let to = place.path().join("a.backup");
    let mut archive = tar::Builder::new(std::fs::File::create(&to).expect("a file"));
    let text = br#"{"format":9,"program":"0.7.0","files":[]}"#;
    add(&mut archive, LIST, text);
    archive.finish().expect("written");
    let error = restore(&to, &place.path().join("new")).expect_err("newer");
    let said = error.to_string();
    assert!(
        said.contains("format 9") && said.contains("0.7.0"),
        "{said}"
    );
}

fn add(archive: &mut tar::Builder<std::fs::File>, name: &str, bytes: &[u8]) {
    let mut header = tar::Header::new_gnu();
    header.set_size(bytes.len() as u64);
    header.set_mode(0o644);
    // The setter of a path refuses what a forger writes.
    header.as_old_mut().name[..name.len()].copy_from_slice(name.as_bytes());
    header.set_cksum();
    archive.append(&header, bytes).expect("written");
}

#[test]
fn an_archive_by_a_forger_writes_nothing_outside() {
    let place = tempfile::tempdir().expect("a folder");
    for name in ["../out", "/tmp/sulcus-out", "a/../../out", ".", "a/"] {
        let to = place.path().join("a.backup");
        let mut archive = tar::Builder::new(std::fs::File::create(&to).expect("a file"));
        add(&mut archive, name, b"x");
        archive.finish().expect("written");
        let error = restore(&to, &place.path().join("new")).expect_err(name);
        assert!(
            matches!(error, BackupError::Damaged { .. }),
            "{name}: {error}"
        );
    }
    let mut archive =
        tar::Builder::new(std::fs::File::create(place.path().join("a.backup")).expect("a file"));
    let mut header = tar::Header::new_gnu();
    header.set_entry_type(tar::EntryType::Symlink);
    header.set_size(0);
    archive
        .append_link(&mut header, "link", "/etc")
        .expect("written");
    archive.finish().expect("written");
    let error = restore(&place.path().join("a.backup"), &place.path().join("new"));
    assert!(error.expect_err("a link").to_string().contains("no file"));
    let left: Vec<_> = std::fs::read_dir(place.path()).expect("a folder").collect();
    assert_eq!(left.len(), 1, "{left:?}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]
    #[test]
    fn an_archive_with_a_changed_byte_or_a_missing_end_is_refused_or_the_same(
        at in 0usize..10_000, bit in 0u8..8, cut in any::<bool>(),
    ) {
        let place = tempfile::tempdir().expect("a folder");
        let folder = state(place.path(), &CONTENT);
        let to = place.path().join("a.backup");
        write(&folder, &to).expect("a backup");
        let mut bytes = std::fs::read(&to).expect("reads");
        let at = at % bytes.len();
        if cut {
            bytes.truncate(at);
        } else {
            bytes[at] ^= 1 << bit;
        }
        std::fs::write(&to, &bytes).expect("writes");
        let target = place.path().join("new");
        match restore(&to, &target) {
            // Padding, and facts of an entry that are not used.
            Ok(_) => prop_assert_eq!(files(&target), files(folder.path())),
            Err(error) => {
                let is_told = matches!(error, BackupError::Damaged { .. } | BackupError::Newer { .. });
                prop_assert!(is_told, "{error}");
                prop_assert!(!target.exists());
                prop_assert_eq!(std::fs::read_dir(place.path()).expect("a folder").count(), 2);
            }
        }
    }
}
