//! Reading of patient files: TOML, then the ranges.

use std::path::Path;

use super::chart::Patient;
use super::check;
use crate::hand_written::{FileError, from_toml, read_text};

impl Patient {
    /// Parses and checks the text of a patient file. Messages name the file as `file`.
    ///
    /// # Errors
    /// [`FileError`] with file, key, value found and value expected.
    pub fn parse(text: &str, file: &Path) -> Result<Self, FileError> {
        let patient: Self = from_toml(text, file)?;
        check::patient(&patient).map_err(|wrong| wrong.in_file(file))?;
        Ok(patient)
    }

    /// Reads and checks a patient file. Also returns its text.
    ///
    /// # Errors
    /// Errors of [`Patient::parse`], and [`FileError::Read`].
    pub fn read(file: &Path) -> Result<(Self, String), FileError> {
        let text = read_text(file)?;
        Ok((Self::parse(&text, file)?, text))
    }
}
