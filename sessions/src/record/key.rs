//! The station's signing key: one file, made on first use, never leaving the station.

use std::fmt;
use std::io::Write as _;
use std::path::{Path, PathBuf};

use ed25519_dalek::{Signature, Signer as _, SigningKey, VerifyingKey};
use sulcus_program::PathText;

use crate::record::bytes::{from_hex32, hex};

/// First line of a key file.
const KEY_TITLE: &str = "sulcus station key 1";

/// Why there is no usable key.
#[derive(Debug, thiserror::Error)]
pub enum KeyError {
    /// The file could not be read or written.
    #[error("cannot {action} `{}`: {source}", path.shown())]
    Io {
        /// What was tried.
        action: &'static str,
        /// Which file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// The file holds something else.
    #[error("`{}` is not a {expected}: move it away, or name another file", path.shown())]
    NotAKey {
        /// Which file.
        path: PathBuf,
        /// What it should be.
        expected: &'static str,
    },
    /// Others can read the secret.
    #[error("`{}` can be read by others (mode {mode:03o}): anyone could sign as this station; run chmod 600 on it, or delete it to make a new key", path.shown())]
    Exposed {
        /// Which file.
        path: PathBuf,
        /// Its permission bits.
        mode: u32,
    },
    /// Nowhere to keep the key.
    #[error("no place for the station's key: set SULCUS_STATE_DIR, XDG_STATE_HOME or HOME")]
    NoHome,
    /// The system gave no random numbers.
    #[error("the system gave no random numbers for a new key: {0}")]
    Random(String),
}

/// The public half: enough to verify, printed as its fingerprint.
#[derive(Clone, Copy, PartialEq, Eq)]
pub struct PublicKey(VerifyingKey);

impl PublicKey {
    /// The key of the station that this program runs on; `None` when it has none yet.
    pub fn of_this_station() -> Option<Self> {
        let file = StationKey::default_path().ok()?.with_extension("pub");
        Self::from_file_or_hex(file).ok()
    }

    /// From 64 hexadecimal digits; `None` for anything else.
    pub fn from_hex(text: &str) -> Option<Self> {
        let key = VerifyingKey::from_bytes(&from_hex32(text.trim())?).ok()?;
        (!key.is_weak()).then_some(Self(key))
    }

    /// From a file that holds the 64 digits, or the digits themselves.
    ///
    /// # Errors
    /// When it is neither.
    pub fn from_file_or_hex(given: impl AsRef<Path>) -> Result<Self, KeyError> {
        let path = given.as_ref().to_owned();
        if let Some(key) = path.to_str().and_then(Self::from_hex) {
            return Ok(key);
        }
        let content = std::fs::read(&path).map_err(|source| KeyError::Io {
            action: "read public key",
            path: path.clone(),
            source,
        })?;
        let content = String::from_utf8_lossy(&content);
        Self::from_hex(&content).ok_or(KeyError::NotAKey {
            path,
            expected: "public key (64 hexadecimal digits)",
        })
    }

    /// The key as 64 hexadecimal digits.
    pub fn fingerprint(&self) -> String {
        hex(self.0.as_bytes())
    }

    /// Strict verification: refuses weak keys and malleable signatures.
    pub(crate) fn verify(&self, message: &[u8], signature: &[u8; 64]) -> bool {
        self.0
            .verify_strict(message, &Signature::from_bytes(signature))
            .is_ok()
    }
}

impl fmt::Display for PublicKey {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.fingerprint())
    }
}

impl fmt::Debug for PublicKey {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "PublicKey({self})")
    }
}

/// The secret half, wiped from memory when dropped. Its `Debug` shows the public key only.
#[derive(Clone)]
pub struct StationKey(SigningKey);

impl fmt::Debug for StationKey {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "StationKey({})", self.public())
    }
}

impl StationKey {
    /// A key from given bytes: for tests, and for a demo that must not touch the disk.
    pub fn from_seed(seed: [u8; 32]) -> Self {
        Self(SigningKey::from_bytes(&seed))
    }

    /// A new key from the system's random numbers, kept nowhere.
    ///
    /// # Errors
    /// When the system gives none.
    pub fn generate() -> Result<Self, KeyError> {
        let mut seed = [0; 32];
        getrandom::fill(&mut seed).map_err(|error| KeyError::Random(error.to_string()))?;
        Ok(Self::from_seed(seed))
    }

    /// Where a station keeps its key: `station.key` in `SULCUS_STATE_DIR`, else in
    /// `XDG_STATE_HOME/sulcus`, else in `HOME/.local/state/sulcus`.
    ///
    /// # Errors
    /// When none of the three is set.
    pub fn default_path() -> Result<PathBuf, KeyError> {
        let set = |name| {
            std::env::var_os(name)
                .filter(|value| !value.is_empty())
                .map(PathBuf::from)
        };
        let directory = set("SULCUS_STATE_DIR")
            .or_else(|| set("XDG_STATE_HOME").map(|dir| dir.join("sulcus")))
            .or_else(|| set("HOME").map(|dir| dir.join(".local/state/sulcus")))
            .ok_or(KeyError::NoHome)?;
        Ok(directory.join("station.key"))
    }

    /// The key in the file at `path`; makes one (mode 0600, its public half beside it with the
    /// extension `pub`) when there is no such file.
    ///
    /// # Errors
    /// When the file cannot be read or made, is not a key, or can be read by others.
    pub fn load_or_create(path: &Path) -> Result<Self, KeyError> {
        match Self::load(path) {
            Err(KeyError::Io { source, .. }) if source.kind() == std::io::ErrorKind::NotFound => {}
            found => return found,
        }
        Self::generate()?.store(path)?;
        // Another process may have been first; whoever won, the file is the station's key.
        Self::load(path)
    }

    fn load(path: &Path) -> Result<Self, KeyError> {
        let failed = |source| KeyError::Io {
            action: "read station key",
            path: path.to_owned(),
            source,
        };
        #[cfg(unix)]
        {
            use std::os::unix::fs::PermissionsExt as _;
            let mode = std::fs::metadata(path)
                .map_err(failed)?
                .permissions()
                .mode()
                & 0o777;
            if mode & 0o077 != 0 {
                return Err(KeyError::Exposed {
                    path: path.to_owned(),
                    mode,
                });
            }
        }
        let content = std::fs::read(path).map_err(failed)?;
        std::str::from_utf8(&content)
            .ok()
            .and_then(|text| text.strip_prefix(KEY_TITLE))
            .and_then(|text| from_hex32(text.trim()))
            .map(Self::from_seed)
            .ok_or(KeyError::NotAKey {
                path: path.to_owned(),
                expected: "station key",
            })
    }

    fn store(&self, path: &Path) -> Result<(), KeyError> {
        let failed = |source| KeyError::Io {
            action: "make station key",
            path: path.to_owned(),
            source,
        };
        let directory = path.parent().unwrap_or(Path::new("."));
        std::fs::create_dir_all(directory).map_err(failed)?;
        let fresh = path.with_extension(format!("new-{}", std::process::id()));
        let mut options = std::fs::OpenOptions::new();
        options.write(true).create_new(true);
        #[cfg(unix)]
        {
            use std::os::unix::fs::OpenOptionsExt as _;
            options.mode(0o600);
        }
        let written = (|| {
            let mut file = options.open(&fresh)?;
            file.write_all(format!("{KEY_TITLE}\n{}\n", hex(self.0.as_bytes())).as_bytes())?;
            file.sync_all()?;
            // A link never replaces: of two stations starting at once, one key survives, whole.
            match std::fs::hard_link(&fresh, path) {
                Err(error) if error.kind() == std::io::ErrorKind::AlreadyExists => Ok(()),
                Err(error) => Err(error),
                // For whoever verifies.
                Ok(()) => {
                    std::fs::write(path.with_extension("pub"), format!("{}\n", self.public()))
                }
            }
        })();
        let _ = std::fs::remove_file(&fresh);
        written.map_err(failed)
    }

    /// The public half.
    pub fn public(&self) -> PublicKey {
        PublicKey(self.0.verifying_key())
    }

    pub(crate) fn sign(&self, message: &[u8]) -> [u8; 64] {
        self.0.sign(message).to_bytes()
    }
}

#[cfg(test)]
mod tests;
