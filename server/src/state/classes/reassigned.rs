//! Sessions of another learner than the recording says: an entry for each, never changed, never removed.
//!
//! A signed recording is not changed. Pages of grades read the learner of a recording here first.

use serde::{Deserialize, Serialize};

use super::{ClassError, Classes, told};
use crate::state::error::StateError;
use crate::state::files::{Lock, append_line, read_private};

/// File of the entries, a JSON object a line.
const FILE: &str = "reassigned.jsonl";
/// Largest file that is read, bytes: some 100,000 entries.
const MOST_BYTES: u64 = 32 << 20;
/// Longest reason, characters.
pub const LONGEST_WHY: usize = 300;

/// An entry.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Entry {
    /// Time, seconds since 1970.
    pub unix_s: u64,
    /// Author: the id of a token, or `shell (uid N)`.
    pub by: String,
    /// File name of the recording.
    pub recording: String,
    /// Opaque id of the learner to whom the session belongs.
    pub learner: String,
    /// Reason.
    pub why: String,
}

impl Classes {
    /// All entries, oldest first. A line that is no entry is left out, with a message in the log.
    ///
    /// # Errors
    /// The file cannot be read, or can be read by other users.
    pub fn reassigned(&self) -> Result<Vec<Entry>, StateError> {
        let path = self.folder.file(FILE);
        let bytes = read_private(&path, MOST_BYTES)?.unwrap_or_default();
        let lines = bytes.split(|byte| *byte == b'\n').enumerate();
        let entry = |(at, line): (usize, &[u8])| {
            if line.is_empty() {
                return None;
            }
            let entry = serde_json::from_slice(line);
            if let Err(error) = &entry {
                tracing::warn!("{FILE}, line {}: {error}", at + 1);
            }
            entry.ok()
        };
        Ok(lines.filter_map(entry).collect())
    }

    /// Learner to whom a recording belongs by the newest entry; `None`: the recording itself says so.
    ///
    /// # Errors
    /// The file cannot be read, or can be read by other users.
    pub fn learner_of(&self, recording: &str) -> Result<Option<String>, StateError> {
        let mut all = self.reassigned()?;
        all.reverse();
        let found = all.into_iter().find(|entry| entry.recording == recording);
        Ok(found.map(|entry| entry.learner))
    }

    /// Adds an entry: the session of a recording was that of `learner`.
    ///
    /// # Errors
    /// No learner has the id, the name of the recording or the reason is not valid, or the file cannot be written.
    pub fn reassign(
        &self,
        recording: &str,
        learner: &str,
        why: &str,
        now_s: u64,
    ) -> Result<(), ClassError> {
        let (recording, why) = (recording.trim(), why.trim());
        let plain = |c: char| c.is_ascii_alphanumeric() || matches!(c, '-' | '_' | '.');
        let is_name = !recording.is_empty()
            && recording.len() <= 128
            && recording.chars().all(plain)
            && !recording.starts_with('.');
        if !is_name {
            return Err(ClassError::Invalid(format!(
                "recording is `{}`, expected the name of a recording's file without its folder",
                told(recording)
            )));
        }
        let length = why.chars().count();
        if why.is_empty() || length > LONGEST_WHY || why.contains(char::is_control) {
            return Err(ClassError::Invalid(format!(
                "why has {length} characters, expected a reason of 1 to {LONGEST_WHY} on one line"
            )));
        }
        let roll = self.roll()?;
        // A session of an archived class can be corrected, too.
        if !roll.was_learner(learner) {
            super::change::Target::Learner(learner.to_owned()).check(&super::Book {
                roll,
                ..super::Book::default()
            })?;
        }
        let entry = Entry {
            unix_s: now_s,
            by: self.by.clone(),
            recording: recording.to_owned(),
            learner: learner.to_owned(),
            why: why.to_owned(),
        };
        let path = self.folder.file(FILE);
        let bytes = serde_json::to_vec(&entry);
        let bytes = bytes.map_err(|error| StateError::content(&path, error.to_string()))?;
        let _lock = Lock::wait(&self.folder.file("reassigned.lock"))?;
        let object = format!("{recording} to {learner}");
        self.audit().record(&self.by, "reassign", &object)?;
        Ok(append_line(&path, &bytes)?)
    }
}
