//! `events.csv`: the session's log.

use std::path::Path;

use super::cells;
use super::error::ExportError;
use super::table::Table;
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
    table: Table,
    began_unix_ns: u64,
}

impl EventTable {
    pub fn create(folder: &Path, began_unix_ns: u64) -> Result<Self, ExportError> {
        let table = Table::create(folder.join("events.csv"), COLUMNS)?;
        Ok(Self {
            table,
            began_unix_ns,
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
        self.table.line([
            seconds.to_string(),
            event.time_unix_ns.to_string(),
            level.to_owned(),
            cells::text(&kind).into_owned(),
            tick,
            data,
            cells::text(&text).into_owned(),
        ])
    }

    /// Closes the table; number of lines.
    pub fn finish(self) -> Result<u64, ExportError> {
        self.table.finish()
    }
}
