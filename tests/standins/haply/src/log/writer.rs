//! Writer of the log.

use std::fs::{File, OpenOptions};
use std::io::{self, BufWriter, Write};
use std::path::Path;

use super::entry::{Entry, What};

/// Writer that appends to a file.
#[derive(Debug)]
pub(crate) struct Writer {
    file: BufWriter<File>,
}

impl Writer {
    /// Opens a file to append to it.
    pub(crate) fn open(path: &Path) -> io::Result<Self> {
        let file = OpenOptions::new().create(true).append(true).open(path)?;
        Ok(Self {
            file: BufWriter::with_capacity(1 << 18, file),
        })
    }

    /// Appends an entry; an error of the disk goes to the error stream.
    pub(crate) fn add(&mut self, t_ns: u64, what: What) {
        let entry = Entry { t_ns, what };
        let written = serde_json::to_writer(&mut self.file, &entry).map_err(io::Error::from);
        if let Err(error) = written.and_then(|()| self.file.write_all(b"\n")) {
            eprintln!("the log could not be written: {error}");
        }
    }

    /// Hands what is buffered to the system.
    pub(crate) fn flush(&mut self) {
        if let Err(error) = self.file.flush() {
            eprintln!("the log could not be written: {error}");
        }
    }
}
