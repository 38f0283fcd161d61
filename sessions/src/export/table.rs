//! A table of an export: a CSV file with a head, and the number of its lines.

use std::fs::File;
use std::io::BufWriter;
use std::path::PathBuf;

use super::error::{ExportError, create};

pub(super) struct Table {
    path: PathBuf,
    csv: csv::Writer<BufWriter<File>>,
    lines: u64,
}

impl Table {
    /// Creates the file and writes the names of the columns.
    pub fn create<S: AsRef<[u8]>>(
        path: PathBuf,
        columns: impl IntoIterator<Item = S>,
    ) -> Result<Self, ExportError> {
        let mut csv = csv::Writer::from_writer(create(&path)?);
        csv.write_record(columns)
            .map_err(|source| ExportError::write(&path, source))?;
        Ok(Self {
            path,
            csv,
            lines: 0,
        })
    }

    pub fn line<S: AsRef<[u8]>>(
        &mut self,
        fields: impl IntoIterator<Item = S>,
    ) -> Result<(), ExportError> {
        self.lines += 1;
        self.csv
            .write_record(fields)
            .map_err(|source| ExportError::write(&self.path, source))
    }

    /// Closes the table; number of lines.
    pub fn finish(mut self) -> Result<u64, ExportError> {
        let flushed = self.csv.flush();
        flushed.map_err(|source| ExportError::write(&self.path, source))?;
        Ok(self.lines)
    }
}
