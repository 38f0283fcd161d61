//! The log's file and the thread that writes it.

use std::fs::File;
use std::io::{BufWriter, Result, Write};
use std::path::Path;
use std::sync::mpsc::{Receiver, Sender, channel};
use sulcus_standins::clock;
use sulcus_standins::log::{Entry, Event};

enum Item {
    Entry(Box<Entry>),
    Sync(Sender<()>),
}

/// The log. Adding an entry does not wait for the file.
pub struct Journal {
    to: Sender<Item>,
}

impl Journal {
    /// Creates the file and its thread.
    pub fn create(path: &Path) -> Result<Self> {
        let file = BufWriter::new(File::create(path)?);
        let (to, from) = channel();
        std::thread::spawn(move || {
            if let Err(error) = write(file, &from) {
                eprintln!("standin-controller: the log cannot be written: {error}");
                std::process::exit(1);
            }
        });
        Ok(Self { to })
    }

    /// Adds an event of the time `t`.
    pub fn add(&self, t: u64, device: Option<usize>, event: Event) {
        let entry = Entry {
            t,
            seen: clock::now_ns(),
            device,
            event,
        };
        let _ = self.to.send(Item::Entry(Box::new(entry)));
    }

    /// Tells `done` when the file holds every entry up to now.
    pub fn sync(&self, done: Sender<()>) {
        let _ = self.to.send(Item::Sync(done));
    }
}

fn write(mut file: BufWriter<File>, from: &Receiver<Item>) -> Result<()> {
    while let Ok(item) = from.recv() {
        match item {
            Item::Entry(entry) => {
                serde_json::to_writer(&mut file, &entry)?;
                file.write_all(b"\n")?;
            }
            Item::Sync(done) => {
                file.flush()?;
                let _ = done.send(());
            }
        }
    }
    file.flush()
}
