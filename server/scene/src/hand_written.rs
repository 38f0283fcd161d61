//! Reader of hand-written files: TOML to the letter, and errors with file, key and value.
//!
//! Scene files, patient files and files of springs are parsed here and nowhere else in this crate.

use std::path::{Path, PathBuf};

use sulcus_program::PathText;

/// Reason why a hand-written file is refused.
#[derive(Debug, thiserror::Error)]
pub enum FileError {
    /// The file cannot be read.
    #[error("{}: cannot read the file: {source}", file.shown())]
    Read {
        /// File.
        file: PathBuf,
        /// Error of the system.
        source: std::io::Error,
    },
    /// The text is not TOML, or a key is unknown, missing or of the wrong type.
    #[error("{}, line {line} (`{text}`): {message}", file.shown())]
    Syntax {
        /// File.
        file: PathBuf,
        /// Line, from 1.
        line: usize,
        /// Text of the line.
        text: String,
        /// Fault and expectation.
        message: String,
    },
    /// A value is out of range or does not fit another.
    #[error("{}: {field} is {found}, expected {expected}", file.shown())]
    Field {
        /// File.
        file: PathBuf,
        /// Key, with its tool or object.
        field: String,
        /// Value found.
        found: String,
        /// Value expected.
        expected: &'static str,
    },
}

/// A value that is refused.
pub(crate) struct Wrong {
    pub field: String,
    pub found: String,
    pub expected: &'static str,
}

impl Wrong {
    /// Returns the error of a file.
    pub fn in_file(self, file: &Path) -> FileError {
        FileError::Field {
            file: file.to_owned(),
            field: self.field,
            found: self.found,
            expected: self.expected,
        }
    }
}

pub(crate) type Checked = Result<(), Wrong>;

pub(crate) fn wrong(field: String, found: impl ToString, expected: &'static str) -> Checked {
    Err(Wrong {
        field,
        found: found.to_string(),
        expected,
    })
}

/// Reads the text of a file.
///
/// # Errors
/// [`FileError::Read`] if the file cannot be read or is not UTF-8.
pub(crate) fn read_text(file: &Path) -> Result<String, FileError> {
    std::fs::read_to_string(file).map_err(|source| FileError::Read {
        file: file.to_owned(),
        source,
    })
}

/// Parses TOML to the letter ([`sulcus_core::exactly`]). Messages name the file as `file`.
///
/// # Errors
/// [`FileError::Syntax`] with file, line, text of the line and text expected.
pub(crate) fn from_toml<T: serde::de::DeserializeOwned>(
    text: &str,
    file: &Path,
) -> Result<T, FileError> {
    let read = toml::Deserializer::parse(text).and_then(sulcus_core::exactly);
    read.map_err(|error| {
        let at = error.span().map_or(0, |span| span.start);
        let line = text.get(..at).unwrap_or(text).matches('\n').count() + 1;
        FileError::Syntax {
            file: file.to_owned(),
            line,
            text: text
                .lines()
                .nth(line - 1)
                .unwrap_or_default()
                .trim()
                .to_owned(),
            message: error.message().replace('\n', " "),
        }
    })
}

/// Checks that a number is in a range; the error carries `expected`.
pub(crate) fn number(
    field: &dyn Fn(&str) -> String,
    key: &str,
    found: f64,
    low: f64,
    high: f64,
    expected: &'static str,
) -> Checked {
    // The comparison fails for a NaN.
    if found >= low && found <= high {
        Ok(())
    } else {
        wrong(field(key), found, expected)
    }
}
