//! Signing key of a station: one file, made on first use, which never leaves the station.

use std::fmt;
use std::io::Write as _;
use std::path::{Path, PathBuf};

use ed25519_dalek::{Signature, Signer as _, SigningKey, VerifyingKey};
use sulcus_program::PathText;

use crate::record::bytes::{from_hex32, hex};

/// First line of a key file.
const KEY_TITLE: &str = "sulcus station key 1";

/// Reason why no key can be used.
#[derive(Debug, thiserror::Error)]
pub enum KeyError {
    /// The file could not be read or written.
    #[error("cannot {action} `{}`: {source}", path.shown())]
    Io {
        /// Failed action.
        action: &'static str,
        /// Path of the file.
        path: PathBuf,
        /// Error of the system.
        source: std::io::Error,
    },
    /// The file holds other content.
    #[error("`{}` is not a {expected}: move the file away, or name another file", path.shown())]
    NotAKey {
        /// Path of the file.
        path: PathBuf,
        /// Expected content.
        expected: &'static str,
    },
    /// Other users can read the secret.
    #[error("`{}` can be read by others (mode {mode:03o}), expected mode 600: other users could sign as this station; run chmod 600 on the file, or delete the file to get a new key", path.shown())]
    Exposed {
        /// Path of the file.
        path: PathBuf,
        /// Permission bits of the file.
        mode: u32,
    },
    /// No folder for the key is known.
    #[error("no place for the station's key: set SULCUS_STATE_DIR, XDG_STATE_HOME or HOME")]
    NoHome,
    /// The system has no random numbers.
    #[error("the system gave no random numbers for a new key: {0}")]
    Random(String),
}

/// Public half of a key, which verifies signatures. Its text is the fingerprint.
#[derive(Clone, Copy, PartialEq, Eq)]
pub struct PublicKey(VerifyingKey);

impl PublicKey {
    /// Public key of this station; `None` if the station has no key yet.
    pub fn of_this_station() -> Option<Self> {
        let file = StationKey::default_path().ok()?.with_extension("pub");
        Self::from_file_or_hex(file).ok()
    }

    /// Public key from 64 hexadecimal digits; `None` for any other text.
    pub fn from_hex(text: &str) -> Option<Self> {
        let key = VerifyingKey::from_bytes(&from_hex32(text.trim())?).ok()?;
        (!key.is_weak()).then_some(Self(key))
    }

    /// Public key from 64 hexadecimal digits, or from a file with the digits.
    ///
    /// # Errors
    /// The argument is neither.
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

    /// Whether the signature is valid. Strict: refuses weak keys and malleable signatures.
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

/// Secret half of a key, wiped from memory when dropped. Its `Debug` shows the public key only.
#[derive(Clone)]
pub struct StationKey(SigningKey);

impl fmt::Debug for StationKey {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "StationKey({})", self.public())
    }
}

impl StationKey {
    /// Key from given bytes, for tests and for a demo without access to the disk.
    pub fn from_seed(seed: [u8; 32]) -> Self {
        Self(SigningKey::from_bytes(&seed))
    }

    /// New key from the system's random numbers, not stored.
    ///
    /// # Errors
    /// The system has no random numbers.
    fn generate() -> Result<Self, KeyError> {
        let mut seed = [0; 32];
        getrandom::fill(&mut seed).map_err(|error| KeyError::Random(error.to_string()))?;
        Ok(Self::from_seed(seed))
    }

    /// Path of the station's key: `station.key` in `SULCUS_STATE_DIR`, else in `XDG_STATE_HOME/sulcus`, else in
    /// `HOME/.local/state/sulcus`.
    ///
    /// # Errors
    /// None of the three variables is set.
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

    /// Key in the file at `path`. Without a file a new key is made, with mode 0600, and its public half beside it with
    /// the extension `pub`.
    ///
    /// # Errors
    /// The file cannot be read or made, is no key, or can be read by other users.
    pub fn load_or_create(path: &Path) -> Result<Self, KeyError> {
        match Self::load(path) {
            Err(KeyError::Io { source, .. }) if source.kind() == std::io::ErrorKind::NotFound => {}
            found => return found,
        }
        Self::generate()?.store(path)?;
        // Another process may have stored its key first. The key in the file is the station's key.
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
            // A link never replaces a file, so of two stations that start at once one whole key survives.
            match std::fs::hard_link(&fresh, path) {
                Err(error) if error.kind() == std::io::ErrorKind::AlreadyExists => Ok(()),
                Err(error) => Err(error),
                // The public half is for programs that verify.
                Ok(()) => {
                    std::fs::write(path.with_extension("pub"), format!("{}\n", self.public()))
                }
            }
        })();
        let _ = std::fs::remove_file(&fresh);
        written.map_err(failed)
    }

    /// Public half of the key.
    pub fn public(&self) -> PublicKey {
        PublicKey(self.0.verifying_key())
    }

    pub(crate) fn sign(&self, message: &[u8]) -> [u8; 64] {
        self.0.sign(message).to_bytes()
    }
}

#[cfg(test)]
mod tests;
