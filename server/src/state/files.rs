//! Private files: mode 0600 from the first byte, read whole, replaced whole, changed under a lock.

use std::fs::{File, OpenOptions, TryLockError};
use std::io::{ErrorKind, Read as _, Write as _};
use std::os::unix::fs::{FileExt as _, MetadataExt as _, OpenOptionsExt as _};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

use super::error::StateError;

/// Permission bits of every file: the owner alone.
const MODE: u32 = 0o600;

/// Content of a private file of at most `most` bytes; `None` without a file.
///
/// # Errors
/// The file cannot be read, is no regular file, is longer, or can be read by other users.
pub(crate) fn read_private(path: &Path, most: u64) -> Result<Option<Vec<u8>>, StateError> {
    let failed = StateError::io("read", path);
    let mut file = match File::open(path) {
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(None),
        opened => opened.map_err(&failed)?,
    };
    // The open file is judged, so that no other file can take its name in between.
    let found = file.metadata().map_err(&failed)?;
    let kind = |found: String, expected: String| StateError::Kind {
        path: path.to_owned(),
        found,
        expected,
    };
    if !found.is_file() {
        return Err(kind("no regular file".into(), "a regular file".into()));
    }
    let mode = found.mode() & 0o777;
    if mode & 0o077 != 0 {
        return Err(StateError::Exposed {
            path: path.to_owned(),
            mode,
            expected: MODE,
        });
    }
    let mut bytes = Vec::new();
    let read = (&mut file).take(most + 1).read_to_end(&mut bytes);
    read.map_err(&failed)?;
    if bytes.len() as u64 > most {
        return Err(kind(
            format!("{} bytes long", found.len()),
            format!("at most {most} bytes"),
        ));
    }
    Ok(Some(bytes))
}

/// Replaces the file at `path` by `bytes`, or makes it. A crash at any moment leaves the old or the new file.
///
/// # Errors
/// The file cannot be written; the old file is unchanged then.
pub(crate) fn write_private(path: &Path, bytes: &[u8]) -> Result<(), StateError> {
    Staged::write(path, bytes)?.commit()
}

/// New content of a file, on the disk under another name. Only the step that needs no space is left:
/// [`Staged::commit`]. A drop takes the content away.
pub(crate) struct Staged {
    fresh: PathBuf,
    path: PathBuf,
}

impl Staged {
    /// Writes the new content of the file at `path`, which keeps its old content.
    ///
    /// # Errors
    /// The content cannot be written.
    pub fn write(path: &Path, bytes: &[u8]) -> Result<Self, StateError> {
        static COUNT: AtomicU64 = AtomicU64::new(0);
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let count = COUNT.fetch_add(1, Ordering::Relaxed);
        let fresh = path.with_file_name(format!(".{name}.new-{}-{count}", std::process::id()));
        // A former process of the same number may have crashed here.
        let _ = std::fs::remove_file(&fresh);
        let staged = Self {
            fresh,
            path: path.to_owned(),
        };
        fill_new(&staged.fresh, bytes).map_err(StateError::io("write", path))?;
        Ok(staged)
    }

    /// Replaces the file by the new content, or makes it.
    ///
    /// # Errors
    /// The file cannot be replaced; the old file is unchanged then.
    pub fn commit(self) -> Result<(), StateError> {
        let renamed = std::fs::rename(&self.fresh, &self.path);
        let renamed = renamed.and_then(|()| sync_folder_of(&self.path));
        renamed.map_err(StateError::io("write", &self.path))
    }
}

impl Drop for Staged {
    fn drop(&mut self) {
        // After a commit there is no such file.
        let _ = std::fs::remove_file(&self.fresh);
    }
}

/// Makes the private file `path` with `bytes`. An existing file is never replaced.
///
/// # Errors
/// A file exists, or the file cannot be written; nothing is left then.
pub(crate) fn create_private(path: &Path, bytes: &[u8]) -> Result<(), StateError> {
    let made = fill_new(path, bytes).and_then(|()| sync_folder_of(path));
    made.map_err(|error| {
        if error.kind() != ErrorKind::AlreadyExists {
            let _ = std::fs::remove_file(path);
        }
        StateError::io("create", path)(error)
    })
}

/// Adds a line to the private file at `path`, which is made if missing. A part of a line that a crash left at the end
/// becomes a line of its own.
///
/// # Errors
/// The file cannot be written, or can be read by other users.
pub(crate) fn append_line(path: &Path, line: &[u8]) -> Result<(), StateError> {
    let failed = StateError::io("write", path);
    let opened = OpenOptions::new()
        .read(true)
        .append(true)
        .create(true)
        .mode(MODE)
        .open(path);
    let mut file = opened.map_err(&failed)?;
    let found = file.metadata().map_err(&failed)?;
    let mode = found.mode() & 0o777;
    if mode & 0o077 != 0 {
        return Err(StateError::Exposed {
            path: path.to_owned(),
            mode,
            expected: MODE,
        });
    }
    let mut last = [b'\n'];
    if let Some(at) = found.len().checked_sub(1) {
        file.read_exact_at(&mut last, at).map_err(&failed)?;
    }
    let mut bytes = Vec::with_capacity(line.len() + 2);
    if last != *b"\n" {
        bytes.push(b'\n');
    }
    bytes.extend_from_slice(line);
    bytes.push(b'\n');
    // A single call writes the line, so that lines of two processes never mix.
    let written = file.write_all(&bytes).and_then(|()| file.sync_data());
    if written.is_err() {
        // A full disk may have taken a part of the line.
        let _ = file.set_len(found.len());
    }
    written.map_err(&failed)
}

/// Removes a file; a missing file is no error.
///
/// # Errors
/// The file cannot be removed.
pub(crate) fn remove_private(path: &Path) -> Result<(), StateError> {
    match std::fs::remove_file(path) {
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(()),
        removed => removed.map_err(StateError::io("remove", path)),
    }
}

fn fill_new(path: &Path, bytes: &[u8]) -> std::io::Result<()> {
    let mut file = OpenOptions::new()
        .write(true)
        .create_new(true)
        .mode(MODE)
        .open(path)?;
    file.write_all(bytes)?;
    file.sync_all()
}

/// Makes a new name in a folder durable. Without this step a crash of the machine may bring the old name back.
fn sync_folder_of(path: &Path) -> std::io::Result<()> {
    let parent = path.parent().filter(|parent| *parent != Path::new(""));
    File::open(parent.unwrap_or(Path::new(".")))?.sync_all()
}

/// Lock between processes, held until the drop. The kernel releases the lock of a process that ends.
#[derive(Debug)]
pub(crate) struct Lock {
    _file: File,
}

impl Lock {
    /// Longest wait of a command for a lock. Holders write one small file.
    pub(crate) const LONGEST: Duration = Duration::from_secs(5);

    /// Waits up to [`Lock::LONGEST`] for the lock of the file `path`, which is created if missing.
    ///
    /// # Errors
    /// The file cannot be opened, or another process holds the lock all the time.
    pub(crate) fn wait(path: &Path) -> Result<Self, StateError> {
        Self::wait_for(path, Self::LONGEST)
    }

    /// The same with a longest wait of the caller.
    ///
    /// # Errors
    /// The file cannot be opened, or another process holds the lock all the time.
    pub(crate) fn wait_for(path: &Path, longest: Duration) -> Result<Self, StateError> {
        let end = Instant::now() + longest;
        loop {
            match Self::attempt(path, "try again when the other command has ended") {
                Err(StateError::Busy { .. }) if Instant::now() < end => {
                    std::thread::sleep(Duration::from_millis(10));
                }
                other => return other,
            }
        }
    }

    /// Takes the lock of the file `path` at once.
    ///
    /// # Errors
    /// The file cannot be opened, or another process holds the lock; `advice` is a part of the sentence.
    pub(crate) fn attempt(path: &Path, advice: &'static str) -> Result<Self, StateError> {
        let failed = StateError::io("lock", path);
        let file: Result<File, _> = OpenOptions::new()
            .read(true)
            .write(true)
            .create(true)
            .truncate(false)
            .mode(MODE)
            .open(path);
        let file = file.map_err(&failed)?;
        match file.try_lock() {
            Ok(()) => Ok(Self { _file: file }),
            Err(TryLockError::WouldBlock) => Err(StateError::Busy {
                path: PathBuf::from(path),
                advice,
            }),
            Err(TryLockError::Error(error)) => Err(failed(error)),
        }
    }
}

#[cfg(test)]
mod tests {
    use std::os::unix::fs::PermissionsExt as _;

    use super::*;

    #[test]
    fn a_file_is_private_from_the_start_and_replaced_whole() {
        let place = tempfile::tempdir().expect("temporary folder");
        let path = place.path().join("secret");
        assert!(read_private(&path, 10).expect("no file").is_none());
        for content in [&b"one"[..], b"two, longer", b""] {
            write_private(&path, content).expect("writes");
            let mode = std::fs::metadata(&path).expect("there").mode() & 0o777;
            assert_eq!(mode, 0o600);
            let found = read_private(&path, 11).expect("reads");
            assert_eq!(found.as_deref(), Some(content));
        }
        let names = std::fs::read_dir(place.path()).expect("lists").count();
        assert_eq!(names, 1, "no file is left over");
    }

    #[test]
    fn lines_are_added_and_a_torn_line_stays_alone() {
        let place = tempfile::tempdir().expect("temporary folder");
        let path = place.path().join("log");
        append_line(&path, b"one").expect("adds");
        append_line(&path, b"two").expect("adds");
        let mut torn = OpenOptions::new().append(true).open(&path).expect("opens");
        torn.write_all(b"thr").expect("writes");
        append_line(&path, b"four").expect("adds");
        let found = read_private(&path, 100).expect("reads");
        assert_eq!(found.as_deref(), Some(&b"one\ntwo\nthr\nfour\n"[..]));
        std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o644)).expect("own file");
        append_line(&path, b"five").expect_err("others can read");
    }

    #[test]
    fn a_file_that_others_can_read_or_a_long_one_is_refused() {
        let place = tempfile::tempdir().expect("temporary folder");
        let path = place.path().join("secret");
        write_private(&path, b"12345").expect("writes");
        let error = read_private(&path, 4).expect_err("too long").to_string();
        assert!(
            error.contains("5 bytes") && error.contains("at most 4"),
            "{error}"
        );
        for mode in [0o640, 0o604] {
            let open = std::fs::Permissions::from_mode(mode);
            std::fs::set_permissions(&path, open).expect("own file");
            let error = read_private(&path, 10).expect_err("exposed").to_string();
            assert!(error.contains("chmod 600"), "{error}");
            assert!(!error.contains("12345"), "{error}");
        }
        let error = read_private(place.path(), 10).expect_err("a folder");
        assert!(error.to_string().contains("regular file"), "{error}");
    }

    #[test]
    fn a_failed_write_leaves_the_old_file() {
        let place = tempfile::tempdir().expect("temporary folder");
        let path = place.path().join("kept");
        std::fs::create_dir(&path).expect("creates");
        std::fs::write(path.join("inside"), "").expect("writes");
        write_private(&path, b"new").expect_err("a folder with a file has the name");
        assert!(path.join("inside").exists());
        assert_eq!(std::fs::read_dir(place.path()).expect("lists").count(), 1);
    }

    #[test]
    fn an_existing_file_is_never_replaced_by_a_new_one() {
        let place = tempfile::tempdir().expect("temporary folder");
        let path = place.path().join("tickets.csv");
        create_private(&path, b"first").expect("creates");
        create_private(&path, b"second").expect_err("exists");
        assert_eq!(std::fs::read(&path).expect("reads"), b"first");
    }

    #[test]
    fn a_lock_excludes_a_second_holder_until_it_is_dropped() {
        let place = tempfile::tempdir().expect("temporary folder");
        let path = place.path().join("x.lock");
        let held = Lock::wait(&path).expect("free");
        let error = Lock::attempt(&path, "wait").expect_err("held");
        assert!(matches!(error, StateError::Busy { .. }), "{error}");
        drop(held);
        Lock::attempt(&path, "wait").expect("free again");
    }
}
