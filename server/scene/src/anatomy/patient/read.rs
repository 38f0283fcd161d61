//! Reading of patient files: TOML, then the ranges.

use std::path::Path;

use super::chart::Patient;
use super::check;
use super::check::PatientFault;
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

    /// Parses the text of a patient file and leaves the ranges unchecked: see [`crate::anatomy::mouth::faults`].
    ///
    /// # Errors
    /// [`FileError::Syntax`] with file, line and text expected.
    pub fn parse_unchecked(text: &str, file: &Path) -> Result<Self, FileError> {
        from_toml(text, file)
    }

    /// Returns all values out of range, with their places.
    pub fn faults(&self) -> Vec<PatientFault> {
        check::faults(self)
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
