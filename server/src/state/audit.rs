//! Audit log: who changed or read what, a JSON object a line. Lines are added and never changed.
//!
//! The log is bounded: a full file becomes `audit-1.jsonl`, that one `audit-2.jsonl`, and so on; the oldest is removed.

use serde::{Deserialize, Serialize};

use super::error::StateError;
use super::files::{Lock, append_line, read_private, remove_private};
use super::folder::StateFolder;

/// Newest file.
const FILE: &str = "audit.jsonl";
/// Length from which a file is closed, bytes.
const FULL: u64 = 4 << 20;
/// Number of closed files that are kept.
const CLOSED: u32 = 9;
/// Longest text of a field, characters.
const LONGEST: usize = 240;

/// An entry.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Entry {
    /// Time, seconds since 1970.
    pub unix_s: u64,
    /// Author: the id of a token, `code`, or `shell (uid N)`.
    pub by: String,
    /// Action, such as `read names`.
    pub action: String,
    /// Object of the action, such as `class c-3`; never a name of a learner.
    pub object: String,
}

/// Audit log of a state folder.
#[derive(Clone, Debug)]
pub struct Audit {
    folder: StateFolder,
}

impl Audit {
    /// Log of `folder`. The file is made with the first entry.
    pub fn of(folder: &StateFolder) -> Self {
        Self {
            folder: folder.clone(),
        }
    }

    /// Adds an entry with the present time.
    ///
    /// # Errors
    /// The file cannot be written, or can be read by other users.
    pub fn record(&self, by: &str, action: &str, object: &str) -> Result<(), StateError> {
        let plain = |text: &str| -> String {
            let plain = text.chars().filter(|c| !c.is_control());
            plain.take(LONGEST).collect()
        };
        let entry = Entry {
            unix_s: super::date::now_s(),
            by: plain(by),
            action: plain(action),
            object: plain(object),
        };
        let path = self.folder.file(FILE);
        let bytes = serde_json::to_vec(&entry);
        let bytes = bytes.map_err(|error| StateError::content(&path, error.to_string()))?;
        let _lock = Lock::wait(&self.folder.file("audit.lock"))?;
        self.close_if_full(FULL)?;
        append_line(&path, &bytes)
    }

    /// Newest entries, newest first, at most `most`. A line that is no entry, such as one torn by a crash, is left out.
    ///
    /// # Errors
    /// A file cannot be read, or can be read by other users.
    pub fn newest(&self, most: usize) -> Result<Vec<Entry>, StateError> {
        let mut all = Vec::new();
        for number in 0..=CLOSED {
            let path = self.folder.file(&name(number));
            // A file grows past its limit by one entry at most.
            let Some(bytes) = read_private(&path, 2 * FULL)? else {
                break;
            };
            let lines = bytes.rsplit(|byte| *byte == b'\n');
            let entries = lines.filter_map(|line| serde_json::from_slice(line).ok());
            all.extend(entries.take(most - all.len()));
            if all.len() == most {
                break;
            }
        }
        Ok(all)
    }

    fn close_if_full(&self, full: u64) -> Result<(), StateError> {
        let newest = std::fs::metadata(self.folder.file(FILE));
        if !newest.is_ok_and(|found| found.len() >= full) {
            return Ok(());
        }
        remove_private(&self.folder.file(&name(CLOSED)))?;
        for number in (0..CLOSED).rev() {
            let from = self.folder.file(&name(number));
            match std::fs::rename(&from, self.folder.file(&name(number + 1))) {
                Err(error) if error.kind() == std::io::ErrorKind::NotFound => {}
                renamed => renamed.map_err(StateError::io("rename", &from))?,
            }
        }
        Ok(())
    }
}

fn name(number: u32) -> String {
    match number {
        0 => FILE.to_owned(),
        number => format!("audit-{number}.jsonl"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::state::folder::fresh;

    #[test]
    fn entries_are_added_and_read_newest_first() {
        let (_place, folder) = fresh();
        let audit = Audit::of(&folder);
        assert_eq!(audit.newest(10).expect("no file"), []);
        for object in ["a", "b\n\"<x>", "c"] {
            audit.record("t-1", "open", object).expect("writes");
        }
        let found = audit.newest(2).expect("reads");
        let objects: Vec<&str> = found.iter().map(|entry| entry.object.as_str()).collect();
        assert_eq!(objects, ["c", "b\"<x>"]);
        assert!(found[0].unix_s > 1_700_000_000 && found[0].by == "t-1");
    }

    #[test]
    fn a_full_log_goes_on_in_a_new_file_and_the_oldest_is_removed() {
        let (_place, folder) = fresh();
        let audit = Audit::of(&folder);
        for round in 0..CLOSED + 3 {
            audit.close_if_full(1).expect("renames");
            audit
                .record("t-1", "open", &round.to_string())
                .expect("writes");
        }
        let found = audit.newest(100).expect("reads");
        let objects: Vec<String> = found.into_iter().map(|entry| entry.object).collect();
        let expected: Vec<String> = (2..CLOSED + 3)
            .rev()
            .map(|round| round.to_string())
            .collect();
        assert_eq!(objects, expected);
        assert!(!folder.file(&name(CLOSED + 1)).exists());
    }

    #[test]
    fn a_torn_line_hides_no_other() {
        let (_place, folder) = fresh();
        let audit = Audit::of(&folder);
        audit.record("t-1", "open", "a").expect("writes");
        let path = folder.file(FILE);
        let mut bytes = std::fs::read(&path).expect("reads");
        bytes.extend_from_slice(b"{\"unix_s\":1");
        std::fs::write(&path, bytes).expect("writes");
        audit.record("t-1", "open", "b").expect("writes");
        assert_eq!(audit.newest(10).expect("reads").len(), 2);
    }
}
