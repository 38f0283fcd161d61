//! The controller's log: its entries and its reader.

mod entry;
mod judge;

pub use entry::{Cause, Closed, CommandEntry, Entry, Event, lossy};

use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::path::Path;

/// All entries of a controller up to a moment, in the order of their times for each device.
#[derive(Clone, Debug, Default)]
pub struct Log {
    /// The entries.
    pub entries: Vec<Entry>,
}

impl Log {
    /// Reads the log's file: one entry as JSON in each line. A last line without its end is left out.
    pub fn read(path: &Path) -> std::io::Result<Self> {
        let mut log = Self::default();
        log.append(path, 0)?;
        Ok(log)
    }

    /// Adds the entries of the file from the byte `from`. Returns how many bytes they take.
    pub(crate) fn append(&mut self, path: &Path, from: u64) -> std::io::Result<u64> {
        let mut file = File::open(path)?;
        file.seek(SeekFrom::Start(from))?;
        let mut text = String::new();
        file.read_to_string(&mut text)?;
        let whole = text.rfind('\n').map_or("", |end| &text[..=end]);
        for line in whole.lines() {
            self.entries.push(serde_json::from_str(line)?);
        }
        Ok(whole.len() as u64)
    }
}
