//! `events.csv`: the session's log.

use std::path::{Path, PathBuf};

use super::cells;
use super::error::{ExportError, create};
use crate::record::message::{Event, Level};
use crate::record::occurrence::Occurrence;

/// Columns. `kind`, `tick` and `data` (JSON) are those of an occurrence. `text` is any other line.
const COLUMNS: [&str; 7] = [
    "time_s",
    "time_unix_ns",
    "level",
    "kind",
    "tick",
    "data",
    "text",
];

pub(super) struct EventTable {
    path: PathBuf,
    csv: csv::Writer<std::io::BufWriter<std::fs::File>>,
    began_unix_ns: u64,
    lines: u64,
}

impl EventTable {
    pub fn create(folder: &Path, began_unix_ns: u64) -> Result<Self, ExportError> {
        let path = folder.join("events.csv");
        let mut csv = csv::Writer::from_writer(create(&path)?);
        csv.write_record(COLUMNS)
            .map_err(|source| ExportError::write(&path, source))?;
        Ok(Self {
            path,
            csv,
            began_unix_ns,
            lines: 0,
        })
    }

    pub fn line(&mut self, event: &Event) -> Result<(), ExportError> {
        // Lines before the first tick have a negative time.
        let seconds = if event.time_unix_ns >= self.began_unix_ns {
            (event.time_unix_ns - self.began_unix_ns) as f64 / 1e9
        } else {
            -((self.began_unix_ns - event.time_unix_ns) as f64 / 1e9)
        };
        let level = match event.level {
            Level::Info => "info",
            Level::Warning => "warning",
            Level::Error => "error",
        };
        let (kind, tick, data, text) = match Occurrence::parse(&event.text) {
            Some(said) => (
                said.kind,
                said.tick.to_string(),
                said.data.to_string(),
                String::new(),
            ),
            None => Default::default(),
        };
        let text = if kind.is_empty() {
            event.text.clone()
        } else {
            text
        };
        self.lines += 1;
        self.csv
            .write_record([
                seconds.to_string(),
                event.time_unix_ns.to_string(),
                level.to_owned(),
                cells::text(&kind).into_owned(),
                tick,
                data,
                cells::text(&text).into_owned(),
            ])
            .map_err(|source| ExportError::write(&self.path, source))
    }

    /// Closes the table; number of lines.
    pub fn finish(mut self) -> Result<u64, ExportError> {
        let flushed = self.csv.flush();
        flushed.map_err(|source| ExportError::write(&self.path, source))?;
        Ok(self.lines)
    }
}
