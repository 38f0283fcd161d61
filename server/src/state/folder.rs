//! Place and protection of the state folder.

use std::fs::{DirBuilder, Permissions};
use std::io::ErrorKind;
use std::os::unix::fs::{DirBuilderExt as _, MetadataExt as _, PermissionsExt as _};
use std::path::{Path, PathBuf};

use sulcus_sessions::StationKey;

use super::error::StateError;

/// Permission bits of the folder: the owner alone.
const MODE: u32 = 0o700;

/// State folder that exists and is closed to other users.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StateFolder {
    path: PathBuf,
}

impl StateFolder {
    /// Path of the folder, whether the folder exists or not: `asked`, else `$SULCUS_STATE_DIR`, else
    /// `$XDG_STATE_HOME/sulcus`, else `$HOME/.local/state/sulcus`. The station key has the same rule.
    ///
    /// # Errors
    /// Nothing was asked for, and none of the variables is set.
    pub fn locate(asked: Option<&Path>) -> Result<PathBuf, StateError> {
        if let Some(asked) = asked {
            return Ok(asked.to_owned());
        }
        let key = StationKey::default_path().map_err(|_| StateError::NoHome)?;
        key.parent().map(Path::to_owned).ok_or(StateError::NoHome)
    }

    /// Opens the folder of [`StateFolder::locate`]; a missing folder is created with mode 0700.
    ///
    /// A folder of former versions, which other users can only list, is closed to them at once. The rule holds for an
    /// empty folder and for a folder with a station key. Any other folder that is open to others is refused.
    ///
    /// # Errors
    /// The folder cannot be created, is no folder, belongs to another user, or is open to other users.
    pub fn open(asked: Option<&Path>) -> Result<Self, StateError> {
        let path = Self::locate(asked)?;
        let failed = StateError::io("create the state folder", &path);
        let made = DirBuilder::new().recursive(true).mode(MODE).create(&path);
        match made {
            Err(error) if error.kind() == ErrorKind::AlreadyExists => {}
            made => made.map_err(failed)?,
        }
        let folder = Self { path };
        folder.close_to_others()?;
        Ok(folder)
    }

    /// Folder at `path` without a check or a change, for a reader that only looks; `None` if no folder is there.
    pub fn existing(asked: Option<&Path>) -> Result<Option<Self>, StateError> {
        let path = Self::locate(asked)?;
        Ok(path.is_dir().then_some(Self { path }))
    }

    /// Path of the folder.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Path of a file in the folder.
    pub fn file(&self, name: &str) -> PathBuf {
        self.path.join(name)
    }

    /// Path of the key that signs recordings, unless `serve --key` names another one.
    pub fn station_key(&self) -> PathBuf {
        self.file("station.key")
    }

    /// Folder inside, created with mode 0700 if missing.
    ///
    /// # Errors
    /// The folder cannot be created, or is open to other users.
    pub(crate) fn inside(&self, name: &str) -> Result<Self, StateError> {
        Self::open(Some(&self.path.join(name)))
    }

    fn close_to_others(&self) -> Result<(), StateError> {
        let path = &self.path;
        let found = std::fs::metadata(path).map_err(StateError::io("read", path))?;
        if !found.is_dir() {
            return Err(StateError::Kind {
                path: path.clone(),
                found: "a file".into(),
                expected: "a folder".into(),
            });
        }
        let user = rustix::process::geteuid().as_raw();
        if found.uid() != user {
            return Err(StateError::Foreign {
                path: path.clone(),
                owner: found.uid(),
                user,
            });
        }
        let mode = found.mode() & 0o777;
        if mode & 0o077 == 0 {
            return Ok(());
        }
        let listed_only = mode & 0o022 == 0;
        if listed_only && self.is_plainly_ours() {
            return std::fs::set_permissions(path, Permissions::from_mode(MODE))
                .map_err(StateError::io("close to other users", path));
        }
        Err(StateError::Exposed {
            path: path.clone(),
            mode,
            expected: MODE,
        })
    }

    /// Whether the folder is empty or has a station key. A change of its mode then affects no other program.
    fn is_plainly_ours(&self) -> bool {
        let is_empty =
            || std::fs::read_dir(&self.path).is_ok_and(|mut entries| entries.next().is_none());
        self.file("station.key").exists() || is_empty()
    }
}

/// A new state folder for a test, and the temporary folder that holds it.
#[cfg(test)]
pub(crate) fn fresh() -> (tempfile::TempDir, StateFolder) {
    let place = tempfile::tempdir().expect("temporary folder");
    let folder = StateFolder::open(Some(&place.path().join("state"))).expect("creates");
    (place, folder)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mode(path: &Path) -> u32 {
        std::fs::metadata(path).expect("there").mode() & 0o777
    }

    #[test]
    fn a_new_folder_is_closed_to_others() {
        let place = tempfile::tempdir().expect("temporary folder");
        let path = place.path().join("a/b");
        let folder = StateFolder::open(Some(&path)).expect("creates");
        assert_eq!((folder.path(), mode(&path)), (path.as_path(), 0o700));
        assert!(StateFolder::open(Some(&path)).is_ok(), "again");
    }

    #[test]
    fn an_open_folder_is_closed_if_it_is_ours_and_refused_otherwise() {
        let place = tempfile::tempdir().expect("temporary folder");
        let path = place.path().join("state");
        std::fs::create_dir(&path).expect("creates");
        let opened = |bits| {
            std::fs::set_permissions(&path, Permissions::from_mode(bits)).expect("own folder");
            StateFolder::open(Some(&path)).map(|_| mode(&path))
        };
        assert_eq!(opened(0o755).expect("an empty folder"), 0o700);
        let error = opened(0o777).expect_err("others can write").to_string();
        assert!(
            error.contains("777") && error.contains("chmod 700"),
            "{error}"
        );
        std::fs::write(path.join("thesis.txt"), "").expect("writes");
        opened(0o755).expect_err("the folder of another program");
        assert_eq!(mode(&path), 0o755, "left alone");
        std::fs::write(path.join("station.key"), "").expect("writes");
        assert_eq!(opened(0o755).expect("a folder of former versions"), 0o700);
    }

    #[test]
    fn a_file_is_no_folder() {
        let file = tempfile::NamedTempFile::new().expect("temporary file");
        let error = StateFolder::open(Some(file.path())).expect_err("a file");
        assert!(error.to_string().contains("folder"), "{error}");
    }
}
