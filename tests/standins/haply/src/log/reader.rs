//! Reader of the log.

use std::fs;
use std::io;
use std::path::Path;

use super::entry::{Entry, Violation, What};
use crate::fault::Fault;

/// Log of the service, read from its file.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Log {
    /// Entries in the order of the file. An idle state bears the time of the watchdog, up to some ms before its line.
    pub entries: Vec<Entry>,
}

impl Log {
    /// Reads a file; a last line without its end is left out, because the writer may be at work.
    pub fn read(path: &Path) -> io::Result<Self> {
        let text = fs::read_to_string(path)?;
        let whole = text.rfind('\n').map_or("", |end| &text[..end]);
        let mut entries = Vec::new();
        for (index, line) in whole.lines().enumerate() {
            let entry = serde_json::from_str(line).map_err(|error| {
                let text = format!("{}, line {}: {error}", path.display(), index + 1);
                io::Error::new(io::ErrorKind::InvalidData, text)
            })?;
            entries.push(entry);
        }
        Ok(Self { entries })
    }

    /// Entries of this time or later, in ns.
    #[must_use]
    pub fn since(&self, t_ns: u64) -> Self {
        Self {
            entries: self
                .entries
                .iter()
                .filter(|entry| entry.t_ns >= t_ns)
                .cloned()
                .collect(),
        }
    }

    /// Number of messages of every connection.
    #[must_use]
    pub fn messages(&self) -> usize {
        self.entries
            .iter()
            .filter(|entry| matches!(entry.what, What::Message { .. }))
            .count()
    }

    /// Number of messages of one connection.
    #[must_use]
    pub fn messages_of(&self, wanted: u64) -> usize {
        let of =
            |what: &What| matches!(what, What::Message { connection, .. } if *connection == wanted);
        self.entries.iter().filter(|entry| of(&entry.what)).count()
    }

    /// Number of simulation connections that stood.
    #[must_use]
    pub fn connections(&self) -> usize {
        self.entries
            .iter()
            .filter(|entry| matches!(entry.what, What::Connected { .. }))
            .count()
    }

    /// Broken rules with their time in ns.
    #[must_use]
    pub fn violations(&self) -> Vec<(u64, Violation)> {
        let rule = |entry: &Entry| match entry.what {
            What::Violation { rule, .. } => Some((entry.t_ns, rule)),
            _ => None,
        };
        self.entries.iter().filter_map(rule).collect()
    }

    /// Number of times that a rule was broken.
    #[must_use]
    pub fn count(&self, rule: Violation) -> usize {
        self.violations()
            .iter()
            .filter(|(_, broken)| *broken == rule)
            .count()
    }

    /// Faults that the test commanded, with their time in ns.
    #[must_use]
    pub fn faults(&self) -> Vec<(u64, Fault)> {
        let fault = |entry: &Entry| match &entry.what {
            What::Fault { fault } => Some((entry.t_ns, fault.clone())),
            _ => None,
        };
        self.entries.iter().filter_map(fault).collect()
    }

    /// Number of events of a name.
    #[must_use]
    pub fn events(&self, wanted: &str) -> usize {
        let of = |what: &What| matches!(what, What::Event { name, .. } if name == wanted);
        self.entries.iter().filter(|entry| of(&entry.what)).count()
    }
}
