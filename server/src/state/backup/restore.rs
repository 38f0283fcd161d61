//! Restoring of a backup into a new state folder.

use std::collections::BTreeMap;
use std::fs::{DirBuilder, File, OpenOptions};
use std::io::{self, BufReader, ErrorKind, Read, Write as _};
use std::os::unix::fs::{DirBuilderExt as _, OpenOptionsExt as _};
use std::path::{Component, Path, PathBuf};

use super::list::{List, Listed, NoList};
use super::{BackupError, Content, LIST};

/// Longest list, bytes: a hundred thousand files.
const LIST_BYTES: u64 = 32 << 20;
/// Largest number of files. Chosen above every folder of a school.
const MOST_FILES: usize = 100_000;

/// Makes the state folder `to` from the backup `from`. The folder appears as a whole, after every hash was right.
///
/// # Errors
/// `to` has files, the archive is damaged, of a newer format or no backup, or the disk is full. Nothing is left then.
pub fn restore(from: &Path, to: &Path) -> Result<Content, BackupError> {
    match std::fs::read_dir(to).map(|mut entries| entries.next()) {
        Ok(None) => {}
        Ok(Some(_)) => return Err(BackupError::NotEmpty { path: to.into() }),
        Err(error) if error.kind() == ErrorKind::NotFound => {}
        Err(error) => return Err(BackupError::io("read", to)(error)),
    }
    let archive = File::open(from).map_err(BackupError::io("read", from))?;
    let failed = BackupError::io("write", to);
    let place = match to.parent() {
        Some(place) if !place.as_os_str().is_empty() => place.to_owned(),
        _ => PathBuf::from("."),
    };
    let mut made = DirBuilder::new();
    made.recursive(true).mode(0o700);
    made.create(&place).map_err(&failed)?;
    let name = to.file_name().unwrap_or_default().to_string_lossy();
    let fresh = place.join(format!(".{name}.restored-{}", std::process::id()));
    made.create(&fresh).map_err(&failed)?;
    let restored = unpacked(archive, from, &fresh, &failed).and_then(|content| {
        match std::fs::remove_dir(to) {
            Err(error) if error.kind() == ErrorKind::NotFound => {}
            removed => removed.map_err(&failed)?,
        }
        std::fs::rename(&fresh, to).map_err(&failed)?;
        let synced = File::open(&place).and_then(|place| place.sync_all());
        synced.map_err(&failed)?;
        Ok(content)
    });
    if restored.is_err() {
        let _ = std::fs::remove_dir_all(&fresh);
    }
    restored
}

fn unpacked(
    archive: File,
    from: &Path,
    to: &Path,
    failed: &dyn Fn(io::Error) -> BackupError,
) -> Result<Content, BackupError> {
    let damaged = |why: String| BackupError::Damaged {
        path: from.to_owned(),
        why,
    };
    let mut archive = tar::Archive::new(BufReader::new(archive));
    let entries = archive
        .entries()
        .map_err(|error| damaged(error.to_string()))?;
    let mut found: BTreeMap<String, Listed> = BTreeMap::new();
    let mut list = None;
    for entry in entries {
        let mut entry = entry.map_err(|error| damaged(error.to_string()))?;
        let name = String::from_utf8_lossy(&entry.path_bytes()).into_owned();
        let shown: String = name.escape_debug().take(100).collect();
        if list.is_some() {
            return Err(damaged(format!("`{shown}` stands behind its list")));
        }
        if entry.header().entry_type() != tar::EntryType::Regular {
            return Err(damaged(format!("`{shown}` is no file")));
        }
        if name == LIST {
            let mut text = Vec::new();
            let read = (&mut entry).take(LIST_BYTES).read_to_end(&mut text);
            read.map_err(|error| damaged(error.to_string()))?;
            list = Some(List::parse(&text).map_err(|no| match no {
                NoList::Newer(found, program) => BackupError::Newer { found, program },
                NoList::Wrong(why) => damaged(why),
            })?);
            continue;
        }
        let is_plain = |part: Component<'_>| matches!(part, Component::Normal(_));
        let parts = Path::new(&name).components();
        if name.is_empty() || !parts.clone().all(is_plain) || name.ends_with('/') {
            return Err(damaged(format!("`{shown}` is no path in a folder")));
        }
        if found.contains_key(&name) || found.len() == MOST_FILES {
            return Err(damaged(format!(
                "`{shown}` is there twice, or there are too many files"
            )));
        }
        let path = to.join(&name);
        if let Some(folder) = path.parent() {
            let mut made = DirBuilder::new();
            made.recursive(true)
                .mode(0o700)
                .create(folder)
                .map_err(failed)?;
        }
        let opened = OpenOptions::new()
            .write(true)
            .create_new(true)
            .mode(0o600)
            .open(&path);
        let mut file = opened.map_err(failed)?;
        let mut hasher = blake3::Hasher::new();
        let (mut bytes, mut length) = (vec![0; 1 << 16], 0);
        loop {
            let count = entry
                .read(&mut bytes)
                .map_err(|error| damaged(error.to_string()))?;
            if count == 0 {
                break;
            }
            hasher.update(&bytes[..count]);
            length += count as u64;
            file.write_all(&bytes[..count]).map_err(failed)?;
        }
        file.sync_all().map_err(failed)?;
        let blake3 = hasher.finalize().to_hex().to_string();
        found.insert(
            name,
            Listed {
                bytes: length,
                blake3,
            },
        );
    }
    let list = list.ok_or_else(|| damaged(format!("`{LIST}` is missing: the file was cut off")))?;
    let names = list.files.keys().chain(found.keys());
    if let Some(name) = { names }.find(|name| list.files.get(*name) != found.get(*name)) {
        let shown = name.escape_debug();
        return Err(damaged(format!("`{shown}` differs from its list")));
    }
    Ok(Content {
        files: found.len(),
        bytes: found.values().map(|file| file.bytes).sum(),
    })
}
