//! Texts that people write and recordings contain, exercises and rubrics: reading and errors.

use std::path::Path;

use serde::de::DeserializeOwned;
use sulcus_program::PathText;

/// Fault of a text.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum WrittenError {
    /// The file cannot be read.
    #[error("{what} file `{path}`: {why}")]
    Read {
        /// Kind of the text: `exercise` or `rubric`.
        what: &'static str,
        /// Path of the file.
        path: String,
        /// Reason.
        why: String,
    },
    /// The text is not TOML, a key is missing, or a key is unknown.
    #[error("{what}: {why}")]
    Syntax {
        /// Kind of the text.
        what: &'static str,
        /// Error of the TOML reader.
        why: String,
    },
    /// A value is out of range.
    #[error("{what}: {field} is {found}, expected {expected}")]
    Field {
        /// Kind of the text.
        what: &'static str,
        /// Key.
        field: String,
        /// Value found.
        found: String,
        /// Valid values.
        expected: String,
    },
}

/// Largest length of a text, bytes.
const MOST_BYTES: usize = 64 * 1024;

/// Kind of a text with values in ranges.
pub(crate) trait Written: DeserializeOwned {
    /// Name of the kind.
    const WHAT: &'static str;

    /// Checks every value.
    fn check(&self) -> Result<(), WrittenError>;

    /// Value from a text, checked.
    fn parsed(text: &str) -> Result<Self, WrittenError> {
        let written = Self::read(text)?;
        written.check()?;
        Ok(written)
    }

    /// Value from a text, not checked.
    fn read(text: &str) -> Result<Self, WrittenError> {
        if text.len() > MOST_BYTES {
            let found = format!("{} bytes long", text.len());
            return Self::wrong("text", found, "at most 64 KiB");
        }
        let read = toml::Deserializer::parse(text).and_then(sulcus_core::exactly);
        read.map_err(|error| Self::syntax(&error))
    }

    /// Value from a file, checked.
    fn opened(path: &Path) -> Result<Self, WrittenError> {
        let unread = |why: String| WrittenError::Read {
            what: Self::WHAT,
            path: path.shown().to_string(),
            why,
        };
        let length = std::fs::metadata(path)
            .map_err(|error| unread(error.to_string()))?
            .len();
        if length > MOST_BYTES as u64 {
            return Err(unread(format!(
                "{length} bytes long, expected at most 64 KiB"
            )));
        }
        let text = std::fs::read_to_string(path).map_err(|error| unread(error.to_string()))?;
        Self::parsed(&text).map_err(|error| unread(error.to_string()))
    }

    /// Error of the TOML reader as an error of this kind.
    fn syntax(error: &dyn std::error::Error) -> WrittenError {
        WrittenError::Syntax {
            what: Self::WHAT,
            why: error.to_string().trim().to_owned(),
        }
    }

    /// Error of a value out of range.
    fn wrong<T>(
        field: &str,
        found: impl Into<String>,
        expected: impl Into<String>,
    ) -> Result<T, WrittenError> {
        Err(WrittenError::Field {
            what: Self::WHAT,
            field: field.into(),
            found: found.into(),
            expected: expected.into(),
        })
    }

    /// Checks a name, which becomes part of file names.
    fn check_name(name: &str) -> Result<(), WrittenError> {
        let known = |c: char| c.is_ascii_alphanumeric() || matches!(c, '-' | '_' | '/');
        if name.is_empty() || name.len() > 64 || !name.chars().all(known) {
            let found = format!("`{}`", name.escape_debug());
            return Self::wrong("name", found, "1 to 64 letters, digits, `-`, `_` or `/`");
        }
        Ok(())
    }
}
