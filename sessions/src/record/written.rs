//! Texts that people write and recordings carry, exercises and rubrics: how they are read, and what is wrong with one.

use std::path::Path;

use serde::de::DeserializeOwned;
use sulcus_program::PathText;

/// Why a text is not what it should be.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum WrittenError {
    /// It cannot be read.
    #[error("{what} file `{path}`: {why}")]
    Read {
        /// What it should be: `exercise` or `rubric`.
        what: &'static str,
        /// The file.
        path: String,
        /// Why not.
        why: String,
    },
    /// It is not TOML, a key is missing, or one is unknown.
    #[error("{what}: {why}")]
    Syntax {
        /// What it should be.
        what: &'static str,
        /// What the reader said.
        why: String,
    },
    /// A value is out of range.
    #[error("{what}: {field} is {found}, expected {expected}")]
    Field {
        /// What it should be.
        what: &'static str,
        /// Key.
        field: String,
        /// Value found.
        found: String,
        /// What it must be.
        expected: String,
    },
}

/// Most bytes of a text.
const MOST_BYTES: usize = 64 * 1024;

/// What can be written: a kind of text with values in ranges.
pub(crate) trait Written: DeserializeOwned {
    /// What it is called.
    const WHAT: &'static str;

    /// Checks every value.
    fn check(&self) -> Result<(), WrittenError>;

    /// From its text.
    fn parsed(text: &str) -> Result<Self, WrittenError> {
        let written = Self::read(text)?;
        written.check()?;
        Ok(written)
    }

    /// From its text, values as they are.
    fn read(text: &str) -> Result<Self, WrittenError> {
        if text.len() > MOST_BYTES {
            let found = format!("{} bytes long", text.len());
            return Self::wrong("text", found, "at most 64 KiB");
        }
        let read = toml::Deserializer::parse(text).and_then(sulcus_core::exactly);
        read.map_err(|error| Self::syntax(&error))
    }

    /// From its file.
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

    /// What TOML says.
    fn syntax(error: &dyn std::error::Error) -> WrittenError {
        WrittenError::Syntax {
            what: Self::WHAT,
            why: error.to_string().trim().to_owned(),
        }
    }

    /// A value that is out of range.
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

    /// Checks a name, which becomes part of files' names.
    fn check_name(name: &str) -> Result<(), WrittenError> {
        let known = |c: char| c.is_ascii_alphanumeric() || matches!(c, '-' | '_' | '/');
        if name.is_empty() || name.len() > 64 || !name.chars().all(known) {
            let found = format!("`{}`", name.escape_debug());
            return Self::wrong("name", found, "1 to 64 letters, digits, `-`, `_` or `/`");
        }
        Ok(())
    }
}
