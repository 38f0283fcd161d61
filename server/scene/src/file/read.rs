//! Reading of scene files: TOML, then the ranges.

use std::path::Path;

use super::validate;
use crate::file::SceneFile;
use crate::hand_written::{FileError, from_toml, read_text};

/// Reads and checks a scene file. Its mesh files are not opened.
///
/// # Errors
/// [`FileError`] with file, key, value found and value expected.
pub fn read(file: &Path) -> Result<(SceneFile, String), FileError> {
    let text = read_text(file)?;
    Ok((parse(&text, file)?, text))
}

/// Parses and checks the text of a scene file. Messages name the file as `file`.
///
/// # Errors
/// [`FileError`] with file, key, value found and value expected.
pub fn parse(text: &str, file: &Path) -> Result<SceneFile, FileError> {
    let scene: SceneFile = from_toml(text, file)?;
    validate::scene_file(&scene).map_err(|wrong| wrong.in_file(file))?;
    Ok(scene)
}
