//! Writing of a backup, also while a server uses the folder.

use std::collections::BTreeMap;
use std::fs::{File, Metadata, OpenOptions};
use std::io::{self, BufWriter, Read};
use std::os::unix::fs::{FileTypeExt as _, MetadataExt as _, OpenOptionsExt as _};
use std::path::{Path, PathBuf};

use super::list::{List, Listed};
use super::{BackupError, Content, FORMAT, LIST};
use crate::state::StateFolder;
use crate::state::date::now_s;

/// Number of attempts at a folder that changes.
const ATTEMPTS: u32 = 5;

/// State of a file that a change alters: inode, length, time of the last change in seconds and nanoseconds.
type Stamp = (u64, u64, i64, i64);

fn stamp(of: &Metadata) -> Stamp {
    (of.ino(), of.len(), of.mtime(), of.mtime_nsec())
}

/// Writes every file of a state folder to the new file `to`, which only the owner can read. Files are taken one after
/// the other; the backup is made again if one of them changed in between.
///
/// # Errors
/// A file cannot be read or is of another kind, `to` exists or cannot be written, or the folder changes all the time.
/// No part of an archive is left then.
pub fn write(folder: &StateFolder, to: &Path) -> Result<Content, BackupError> {
    let real = |path: &Path| path.canonicalize().map_err(BackupError::io("read", path));
    let place = match to.parent() {
        Some(place) if !place.as_os_str().is_empty() => place,
        _ => Path::new("."),
    };
    if real(place)?.starts_with(real(folder.path())?) {
        return Err(BackupError::Inside { path: to.into() });
    }
    let failed = BackupError::io("write", to);
    let opened = OpenOptions::new()
        .write(true)
        .create_new(true)
        .mode(0o600)
        .open(to);
    let mut file = opened.map_err(&failed)?;
    let written = fill(folder, &mut file, &failed).and_then(|content| {
        file.sync_all().map_err(&failed)?;
        Ok(content)
    });
    if written.is_err() {
        let _ = std::fs::remove_file(to);
    }
    written
}

fn fill(
    folder: &StateFolder,
    file: &mut File,
    failed: &dyn Fn(io::Error) -> BackupError,
) -> Result<Content, BackupError> {
    for _ in 0..ATTEMPTS {
        file.set_len(0).map_err(failed)?;
        io::Seek::rewind(file).map_err(failed)?;
        let before = listed(folder.path())?;
        let mut archive = tar::Builder::new(BufWriter::new(&mut *file));
        let mut list = List {
            format: FORMAT,
            program: env!("CARGO_PKG_VERSION").into(),
            made_unix_s: now_s(),
            files: BTreeMap::new(),
        };
        let mut is_same = true;
        for (name, (path, _)) in &before {
            match File::open(path) {
                Ok(file) => {
                    let listed = add(&mut archive, name, file).map_err(failed)?;
                    list.files.insert(name.clone(), listed);
                }
                // A file that was removed or replaced in the meantime.
                Err(error) if error.kind() == io::ErrorKind::NotFound => is_same = false,
                Err(error) => return Err(BackupError::io("read", path)(error)),
            }
        }
        let text = serde_json::to_vec_pretty(&list).map_err(|error| failed(error.into()))?;
        let mut header = header(text.len() as u64, list.made_unix_s);
        let ended = archive
            .append_data(&mut header, LIST, text.as_slice())
            .and_then(|()| archive.into_inner())
            .and_then(|buffer| buffer.into_inner().map_err(io::IntoInnerError::into_error));
        ended.map_err(failed)?;
        if is_same && before == listed(folder.path())? {
            let bytes = list.files.values().map(|file| file.bytes).sum();
            return Ok(Content {
                files: list.files.len(),
                bytes,
            });
        }
    }
    Err(BackupError::Busy { attempts: ATTEMPTS })
}

fn header(bytes: u64, mtime: u64) -> tar::Header {
    let mut header = tar::Header::new_gnu();
    header.set_size(bytes);
    header.set_mode(0o600);
    header.set_mtime(mtime);
    header
}

/// Adds a file, up to its length at the begin. The stamps tell a change.
fn add(archive: &mut tar::Builder<impl io::Write>, name: &str, file: File) -> io::Result<Listed> {
    let found = file.metadata()?;
    let mut header = header(found.len(), u64::try_from(found.mtime()).unwrap_or(0));
    let mut hashed = Hashed {
        from: file.take(found.len()),
        hasher: blake3::Hasher::new(),
    };
    archive.append_data(&mut header, name, &mut hashed)?;
    Ok(Listed {
        bytes: found.len(),
        blake3: hashed.hasher.finalize().to_hex().to_string(),
    })
}

/// Reader that hashes its bytes.
struct Hashed<R> {
    from: R,
    hasher: blake3::Hasher,
}

impl<R: Read> Read for Hashed<R> {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        let count = self.from.read(bytes)?;
        self.hasher.update(&bytes[..count]);
        Ok(count)
    }
}

/// Paths and stamps of all files of a folder, by their names in the archive.
fn listed(folder: &Path) -> Result<BTreeMap<String, (PathBuf, Stamp)>, BackupError> {
    let mut all = BTreeMap::new();
    let mut open = vec![(String::new(), folder.to_owned())];
    while let Some((prefix, folder)) = open.pop() {
        let failed = BackupError::io("read", &folder);
        for entry in std::fs::read_dir(&folder).map_err(&failed)? {
            let entry = entry.map_err(&failed)?;
            let (path, kind) = (entry.path(), entry.file_type().map_err(&failed)?);
            let name = entry
                .file_name()
                .into_string()
                .map_err(|_| BackupError::Kind {
                    path: path.clone(),
                    found: "a name that is no text",
                })?;
            let full = format!("{prefix}{name}");
            // A lock is empty; a name with a point is a file that is being written.
            let is_passing = name.ends_with(".lock") || name.starts_with('.');
            if kind.is_dir() {
                open.push((format!("{full}/"), path));
            } else if kind.is_file() && !is_passing {
                // A file that was removed in the meantime is missing in this list.
                if let Ok(found) = entry.metadata() {
                    all.insert(full, (path, stamp(&found)));
                }
            } else if !(kind.is_file() || kind.is_socket()) {
                let found = "a link or a device";
                return Err(BackupError::Kind { path, found });
            }
        }
    }
    Ok(all)
}
