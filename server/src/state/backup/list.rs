//! List of the files of a backup.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::FORMAT;

/// List of a backup, its last entry.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct List {
    /// Format of the archive.
    pub format: u32,
    /// Release that made the backup.
    pub program: String,
    /// Time, seconds since 1970.
    pub made_unix_s: u64,
    /// Files by path.
    pub files: BTreeMap<String, Listed>,
}

/// File of a list.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Listed {
    /// Length, bytes.
    pub bytes: u64,
    /// BLAKE3, hexadecimal.
    pub blake3: String,
}

/// Start of a list of any format.
#[derive(Deserialize)]
struct Head {
    format: u32,
    #[serde(default)]
    program: String,
}

/// Reason why a text is no list.
pub(super) enum NoList {
    /// A newer release made the list: format and release.
    Newer(u32, String),
    /// Sentence about the violated rule.
    Wrong(String),
}

impl List {
    /// List of a text.
    pub fn parse(bytes: &[u8]) -> Result<Self, NoList> {
        let wrong = |error: serde_json::Error| NoList::Wrong(format!("its list: {error}"));
        let head: Head = serde_json::from_slice(bytes).map_err(wrong)?;
        match head.format {
            0 => Err(NoList::Wrong(format!(
                "its format is 0, expected 1 to {FORMAT}"
            ))),
            1..=FORMAT => serde_json::from_slice(bytes).map_err(wrong),
            newer => Err(NoList::Newer(newer, head.program)),
        }
    }
}
