//! Key table: names of learners by their ids.
//!
//! The table is kept apart from the signed recordings, so that a name can be erased. Only output for people needs it.

use std::collections::BTreeMap;
use std::path::Path;

use sulcus_program::PathText;

use crate::export::cells;
use crate::grade::sheet;
use crate::grade::sheet::{Row, SheetError};

/// Largest key table that is read, bytes.
const MOST_BYTES: u64 = 16 << 20;

/// Names by learner id. The file is a table with the columns `learner_id` and `name`. Commas, semicolons, tabs or
/// vertical bars separate the cells; the encoding is UTF-8, UTF-16 or Windows-1252.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Names(BTreeMap<String, String>);

/// Failure to read a key table.
#[derive(Debug, thiserror::Error)]
pub enum NamesError {
    /// File that cannot be read, or is not text.
    #[error("key table `{path}`: {why}")]
    Read {
        /// Path of the file.
        path: String,
        /// Reason.
        why: String,
    },
    /// Row that is not valid.
    #[error("key table `{path}`, line {line}: {field} is {found}, expected {expected}")]
    Field {
        /// Path of the file.
        path: String,
        /// Line, from 1.
        line: u64,
        /// Column.
        field: &'static str,
        /// Value found.
        found: String,
        /// Value expected.
        expected: String,
    },
}

impl Names {
    /// Reads a key table.
    ///
    /// # Errors
    /// The file, the line, the column, the value found and the value expected.
    pub fn open(path: &Path) -> Result<Self, NamesError> {
        let unread = |why: String| NamesError::Read {
            path: path.shown().to_string(),
            why,
        };
        let length = std::fs::metadata(path).map_err(|error| unread(error.to_string()))?;
        if length.len() > MOST_BYTES {
            let found = length.len();
            return Err(unread(format!(
                "{found} bytes long, expected at most 16 MiB"
            )));
        }
        let bytes = std::fs::read(path).map_err(|error| unread(error.to_string()))?;
        Self::parse(&bytes, path)
    }

    /// Key table from the bytes of a file. `path` is its name in messages.
    ///
    /// # Errors
    /// The errors of [`Names::open`].
    pub fn parse(bytes: &[u8], path: &Path) -> Result<Self, NamesError> {
        let path = || path.shown().to_string();
        let rows = sheet::read(bytes, ["learner_id", "name"]).map_err(|error| match error {
            SheetError::Text(why) => NamesError::Read { path: path(), why },
            SheetError::Line {
                line,
                field,
                found,
                expected,
            } => NamesError::Field {
                path: path(),
                line,
                field,
                found,
                expected,
            },
        })?;
        let mut names = BTreeMap::new();
        for Row { line, cells } in rows {
            let [id, name] = &cells;
            // An id has no apostrophe of its own.
            let key = cells::read(id);
            let key = key.strip_prefix('\'').unwrap_or(key);
            let wrong = |expected: &str| NamesError::Field {
                path: path(),
                line,
                field: "learner_id",
                found: format!("`{}`", key.escape_debug()),
                expected: expected.to_owned(),
            };
            if key.is_empty() {
                return Err(wrong("an opaque id"));
            }
            let name = cells::read(name).trim().to_owned();
            if names.insert(key.to_owned(), name).is_some() {
                return Err(wrong("each id once"));
            }
        }
        Ok(Self(names))
    }

    /// Name of a learner. None if the table does not have the id.
    pub fn of(&self, learner_id: &str) -> Option<&str> {
        self.0.get(learner_id).map(String::as_str)
    }

    /// Label of a learner on a page: the name with the id, or the id alone.
    pub fn label(&self, learner_id: &str) -> String {
        let id = if learner_id.is_empty() {
            "(no id)"
        } else {
            learner_id
        };
        match self.of(learner_id) {
            Some(name) => format!("{name} ({id})"),
            None => id.to_owned(),
        }
    }
}

#[cfg(test)]
mod tests;
