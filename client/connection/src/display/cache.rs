//! Cache of scenes on disk, by hash. A file holds the encoded scene and nothing else; its hash is its name.

use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};

use sulcus_proto::display::{SCENE_BYTES, SceneHash};

/// Largest number of cached scenes. A whole mouth takes a few megabytes.
pub const SCENES: usize = 8;
/// Beginning and end of the names of files.
const NAME: (&str, &str) = ("display-", ".bin");

/// Cache of scenes in one folder.
#[derive(Clone, Debug)]
pub struct Cache {
    folder: PathBuf,
}

impl Cache {
    /// Cache in `folder`, which the first scene creates.
    pub fn new(folder: impl Into<PathBuf>) -> Self {
        Self {
            folder: folder.into(),
        }
    }

    /// Cache in `$SULCUS_CACHE`, else `$XDG_CACHE_HOME/sulcus`, else `~/.cache/sulcus`; `None` without any of them.
    pub fn in_default_folder() -> Option<Self> {
        let set = |name: &str| {
            let value = std::env::var_os(name).filter(|value| !value.is_empty());
            value.map(PathBuf::from)
        };
        set("SULCUS_CACHE")
            .or_else(|| set("XDG_CACHE_HOME").map(|folder| folder.join("sulcus")))
            .or_else(|| set("HOME").map(|folder| folder.join(".cache").join("sulcus")))
            .map(Self::new)
    }

    /// Hashes of the cached scenes, newest first, at most [`SCENES`]. Every file is read and compared with its hash; a
    /// damaged file is deleted.
    pub fn known(&self) -> Vec<SceneHash> {
        let mut files = self.files();
        files.reverse();
        files.truncate(SCENES);
        let sound = files.iter().filter(|(_, hash)| self.load(hash).is_some());
        sound.map(|(_, hash)| *hash).collect()
    }

    /// Scene of a hash; `None` if it is absent or damaged. A damaged file is deleted.
    pub fn load(&self, hash: &SceneHash) -> Option<Vec<u8>> {
        let path = self.path(hash);
        let length = std::fs::metadata(&path).ok()?.len();
        let bytes = (length <= SCENE_BYTES as u64)
            .then(|| std::fs::read(&path).ok())
            .flatten();
        let bytes = bytes.filter(|bytes| SceneHash::of(bytes) == *hash);
        if bytes.is_none() {
            // Without the right to delete it, the file is found damaged again.
            let _ = std::fs::remove_file(&path);
            return None;
        }
        if let Ok(file) = std::fs::File::options().append(true).open(&path) {
            // A cache that cannot be written can still be read.
            let _ = file.set_modified(std::time::SystemTime::now());
        }
        bytes
    }

    /// Caches a scene under its hash, and deletes the scenes that were not used for the longest time. Readers see no
    /// file or the whole file.
    ///
    /// # Errors
    /// The folder cannot be written.
    pub fn store(&self, bytes: &[u8]) -> std::io::Result<()> {
        static WRITES: AtomicU32 = AtomicU32::new(0);
        std::fs::create_dir_all(&self.folder)?;
        // The name is unique for each writer, so two clients at once do not mix.
        let write = WRITES.fetch_add(1, Ordering::Relaxed);
        let name = format!("{}{}-{write}.part", NAME.0, std::process::id());
        let part = self.folder.join(name);
        let written = write_and_rename(&part, &self.path(&SceneHash::of(bytes)), bytes);
        if written.is_err() {
            let _ = std::fs::remove_file(&part);
        }
        written?;
        let files = self.files();
        let surplus = files.len().saturating_sub(SCENES);
        for (_, hash) in &files[..surplus] {
            // Another client may have deleted the file.
            let _ = std::fs::remove_file(self.path(hash));
        }
        Ok(())
    }

    fn path(&self, hash: &SceneHash) -> PathBuf {
        self.folder.join(format!("{}{hash}{}", NAME.0, NAME.1))
    }

    /// Files of the cache with the time of their last use, oldest first.
    fn files(&self) -> Vec<(std::time::SystemTime, SceneHash)> {
        let entries = std::fs::read_dir(&self.folder)
            .into_iter()
            .flatten()
            .flatten();
        let file = |entry: std::fs::DirEntry| {
            let hash = hash_of(&entry.file_name().to_string_lossy())?;
            Some((entry.metadata().ok()?.modified().ok()?, hash))
        };
        let mut files: Vec<_> = entries.filter_map(file).collect();
        files.sort();
        files
    }
}

fn write_and_rename(part: &Path, target: &Path, bytes: &[u8]) -> std::io::Result<()> {
    let mut file = std::fs::File::create(part)?;
    file.write_all(bytes)?;
    drop(file);
    std::fs::rename(part, target)
}

/// Hash in the name of a file; `None` for any other file.
fn hash_of(name: &str) -> Option<SceneHash> {
    let digits = name.strip_prefix(NAME.0)?.strip_suffix(NAME.1)?;
    let (pairs, rest) = digits.as_bytes().as_chunks::<2>();
    let mut hash = [0; 32];
    if pairs.len() != hash.len() || !rest.is_empty() {
        return None;
    }
    for (byte, pair) in hash.iter_mut().zip(pairs) {
        let digit = |c: u8| char::from(c).to_digit(16);
        *byte = (digit(pair[0])? * 16 + digit(pair[1])?) as u8;
    }
    Some(SceneHash(hash))
}

#[cfg(test)]
mod tests {
    use std::time::{Duration, SystemTime};

    use super::*;

    fn cache() -> (tempfile::TempDir, Cache) {
        let folder = tempfile::tempdir().expect("folder");
        let cache = Cache::new(folder.path().join("cache"));
        (folder, cache)
    }

    #[test]
    fn a_scene_is_found_by_its_hash_and_a_damaged_one_never() {
        let (_folder, cache) = cache();
        let bytes = b"an encoded scene".to_vec();
        let hash = SceneHash::of(&bytes);
        assert_eq!(cache.load(&hash), None);
        cache.store(&bytes).expect("stored");
        assert_eq!(cache.load(&hash), Some(bytes.clone()));
        assert_eq!(cache.known(), [hash]);
        for damaged in [&bytes[1..], b"", b"an encoded scenf"] {
            std::fs::write(cache.path(&hash), damaged).expect("written");
            assert_eq!(cache.known(), []);
            assert!(!cache.path(&hash).exists(), "it is deleted");
        }
    }

    #[test]
    fn a_file_larger_than_any_scene_is_not_read() {
        let (_folder, cache) = cache();
        cache.store(b"x").expect("stored");
        let hash = SceneHash::of(b"x");
        let file = std::fs::File::create(cache.path(&hash)).expect("file");
        file.set_len(SCENE_BYTES as u64 + 1).expect("a hole");
        assert_eq!(cache.load(&hash), None);
    }

    #[test]
    fn the_number_of_scenes_is_bounded_and_the_last_used_stay() {
        let (_folder, cache) = cache();
        let first = SceneHash::of(&[0]);
        for k in 0..SCENES as u8 {
            cache.store(&[k]).expect("stored");
            // Times of use in the order of the numbers, whatever the resolution of the file system.
            let ago = Duration::from_secs(100 - u64::from(k));
            let path = cache.path(&SceneHash::of(&[k]));
            let file = std::fs::File::options().append(true).open(path);
            let set = file.and_then(|file| file.set_modified(SystemTime::now() - ago));
            set.expect("the time of a file");
        }
        assert!(cache.load(&first).is_some());
        cache.store(b"one more").expect("stored");
        let known = cache.known();
        assert_eq!(known.len(), SCENES);
        assert!(known.contains(&first), "it was used");
        assert!(!known.contains(&SceneHash::of(&[1])));
    }

    #[test]
    fn other_files_of_the_folder_are_left_alone() {
        let (_folder, cache) = cache();
        cache.store(b"x").expect("stored");
        for name in [
            "tree-12.bin",
            "display-.bin",
            "display-zz.bin",
            "display-12.part",
        ] {
            std::fs::write(cache.folder.join(name), b"theirs").expect("written");
            assert_eq!(hash_of(name), None);
        }
        assert_eq!(cache.known().len(), 1);
        assert_eq!(std::fs::read_dir(&cache.folder).expect("folder").count(), 5);
    }
}
