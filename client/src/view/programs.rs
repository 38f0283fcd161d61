//! Programs of the system that speak or play, one of several.

use std::path::PathBuf;

/// Program: its name, and its options.
pub type Row = (&'static str, &'static [&'static str]);

/// First program of a table that a folder of `PATH` holds, with its options.
pub fn find(table: &[Row]) -> Option<(PathBuf, &'static [&'static str])> {
    let folders = std::env::var_os("PATH").unwrap_or_default();
    table.iter().find_map(|(name, options)| {
        let mut files = std::env::split_paths(&folders).map(|folder| folder.join(name));
        Some((files.find(|file| file.is_file())?, *options))
    })
}
