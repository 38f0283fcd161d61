//! Predecessor of a recording: the recording of the same session before the station's program stopped.
//!
//! After a crash the same session goes on in a second recording. Its signed header names the file of the first one and
//! the BLAKE3 hash of all its bytes as the crash left them. The signature of the second recording thus covers the first
//! one to its last byte, also behind its own last statement.

use std::fmt;
use std::io;
use std::path::Path;

use serde::{Deserialize, Serialize};

use crate::record::bytes::{from_hex32, hex};
use crate::record::sane::text_of;

/// File that a recording continues.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Predecessor {
    /// Name of the file, without its folder.
    pub file: String,
    /// BLAKE3 of all bytes of the file.
    pub blake3: [u8; 32],
}

/// Predecessor as JSON.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Written {
    file: String,
    blake3: String,
}

impl Predecessor {
    /// Predecessor in the file at `path`. The whole file is read.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn of(path: &Path) -> io::Result<Self> {
        let mut hasher = blake3::Hasher::new();
        io::copy(&mut std::fs::File::open(path)?, &mut hasher)?;
        let name = path.file_name().unwrap_or(path.as_os_str());
        Ok(Self {
            file: name.to_string_lossy().into_owned(),
            blake3: *hasher.finalize().as_bytes(),
        })
    }

    /// Checks the name.
    pub(crate) fn check(&self) -> Result<(), String> {
        text_of("predecessor file", &self.file)
    }
}

impl Serialize for Predecessor {
    fn serialize<S: serde::Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        let written = Written {
            file: self.file.clone(),
            blake3: hex(&self.blake3),
        };
        written.serialize(to)
    }
}

impl<'de> Deserialize<'de> for Predecessor {
    fn deserialize<D: serde::Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        let Written { file, blake3 } = Written::deserialize(from)?;
        let blake3 = from_hex32(&blake3)
            .ok_or_else(|| serde::de::Error::custom("blake3 has no 64 hexadecimal digits"))?;
        Ok(Self { file, blake3 })
    }
}

impl fmt::Display for Predecessor {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{} (blake3 {})",
            self.file.escape_debug(),
            hex(&self.blake3)
        )
    }
}
