//! Recorder of one session into one MCAP file.

mod begin;
mod error;
mod output;
mod tape;
mod viewers;

use std::fs::OpenOptions;
use std::path::Path;

use crate::record::chain::{Chain, Link};
use crate::record::envelope;
use crate::record::header;
use crate::record::header::SessionHeader;
use crate::record::key::StationKey;
use crate::record::message::{Event, Level, Topic};
use crate::record::row::Row;
use crate::record::statement::{SessionEnd, Statement};
use crate::record::storage::{FileStorage, Storage};

pub(crate) use begin::Head;
pub use error::RecordError;
pub(crate) use output::reason;
pub(crate) use tape::Tape;
pub(crate) use viewers::Extent;

/// Record time between two signatures, nanoseconds.
const SIGN_EVERY_NS: u64 = 10_000_000_000;
/// Time between two snapshots of the state in a recording, seconds.
pub const SNAPSHOT_EVERY_S: f64 = 10.0;

/// Size of a finished recording.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Finished {
    /// Length of the file, bytes.
    pub bytes: u64,
    /// Number of rows.
    pub rows: u64,
}

/// Recorder of one session. It must not run in the thread that ticks, because a flush may take milliseconds.
///
/// A recorder that is dropped without [`Recorder::finish`] leaves a file that is read as cut off.
pub struct Recorder {
    tape: Tape,
    key: StationKey,
    chain: Chain,
    hashes: [[u8; 32]; 3],
    /// Record time of the last signature. The first row sets it.
    signed: Option<u64>,
    last_time: u64,
    /// Protobuf message around the bytes of the next message.
    sealed: Vec<u8>,
    snapshots: u64,
    /// Number of rows that came after writing had failed.
    lost_rows: u64,
}

impl Recorder {
    /// Makes the file and writes header and attachments.
    ///
    /// # Errors
    /// The file exists, or cannot be written.
    pub fn create(
        path: &Path,
        header: &SessionHeader,
        key: StationKey,
    ) -> Result<Self, RecordError> {
        let failed = |source: std::io::Error| match source.kind() {
            std::io::ErrorKind::AlreadyExists => RecordError::Exists(path.to_owned()),
            _ => RecordError::Create {
                path: path.to_owned(),
                source,
            },
        };
        let file = OpenOptions::new()
            .write(true)
            .create_new(true)
            .open(path)
            .map_err(failed)?;
        let storage = FileStorage::new(file).map_err(failed)?;
        Self::on(Box::new(storage), header, key).inspect_err(|_| {
            // A file without its header has no use.
            let _ = std::fs::remove_file(path);
        })
    }

    pub(crate) fn on(
        storage: Box<dyn Storage>,
        header: &SessionHeader,
        key: StationKey,
    ) -> Result<Self, RecordError> {
        header.check().map_err(RecordError::Header)?;
        let metadata = header.to_metadata(&key.public());
        let digest = header::digest(&metadata);
        let head = Head { header, metadata };
        let tape = Tape::begin(storage, &head, header.viewers, Extent::Policy)?;
        Ok(Self {
            tape,
            key,
            chain: Chain::new(digest),
            hashes: [digest, header.scene_hash(), header.exercise_hash()],
            signed: None,
            last_time: header.started_unix_ns,
            sealed: Vec::new(),
            snapshots: 0,
            lost_rows: 0,
        })
    }

    /// Adds the row of a tick. Flushes and signs by record time.
    ///
    /// # Errors
    /// The row is out of order, or writing fails for the first time. After that failure rows are only
    /// counted and the result is `Ok`, so that a caller logs the failure once.
    pub fn push(&mut self, row: &Row) -> Result<(), RecordError> {
        if self.snapshots == 0 {
            return Err(RecordError::NoSnapshot);
        }
        if row.tick <= self.chain.tick() {
            return Err(RecordError::Order {
                found: row.tick,
                last: self.chain.tick(),
            });
        }
        if !self.tape.is_open() {
            self.lost_rows += 1;
            return Ok(());
        }
        let mut bytes = std::mem::take(&mut self.sealed);
        row.chained(&mut bytes);
        self.chain.add(Link::Row, Some(row.tick), &bytes);
        envelope::seal_row(row, &mut bytes);
        self.put_sealed(Topic::Ticks, row.time_unix_ns, bytes)?;
        self.on_time(row.time_unix_ns)
    }

    /// Adds the state after `tick`, bytes of [`sulcus_core::State::to_bytes`]. The first snapshot precedes the first
    /// row. Further snapshots follow every [`SNAPSHOT_EVERY_S`], right after the row of their tick.
    ///
    /// # Errors
    /// The snapshot is out of order, or writing fails for the first time.
    pub fn snapshot(
        &mut self,
        time_unix_ns: u64,
        tick: u64,
        state: &[u8],
    ) -> Result<(), RecordError> {
        if tick < self.chain.tick() {
            return Err(RecordError::Order {
                found: tick,
                last: self.chain.tick(),
            });
        }
        self.snapshots += 1;
        let bytes = [&tick.to_le_bytes(), state].concat();
        self.chain.add(Link::Snapshot, Some(tick), &bytes);
        self.put(Topic::Snapshots, time_unix_ns, &bytes)
    }

    /// Adds a line to the session's log, and to the log for viewers.
    ///
    /// # Errors
    /// Writing fails for the first time.
    pub fn event(
        &mut self,
        time_unix_ns: u64,
        level: Level,
        text: &str,
    ) -> Result<(), RecordError> {
        self.log_exactly(time_unix_ns, level, text)?;
        self.tape.say(self.last_time, time_unix_ns, level, text)
    }

    fn log_exactly(
        &mut self,
        time_unix_ns: u64,
        level: Level,
        text: &str,
    ) -> Result<(), RecordError> {
        let bytes = Event {
            time_unix_ns,
            level,
            text: text.to_owned(),
        }
        .to_bytes();
        self.chain.add(Link::Event, None, &bytes);
        // The log time is the time of the message before. A tool that sorts messages by log time then keeps the order
        // of the chain.
        self.put(Topic::Events, self.last_time, &bytes)
    }

    /// Closes the chunks and hands them to the system. [`Recorder::push`] does so every 100 ms of record time, and
    /// every 500 ms for the channels for viewers. A caller without further rows calls this method.
    ///
    /// # Errors
    /// Writing fails for the first time.
    pub fn flush(&mut self) -> Result<(), RecordError> {
        self.tape.flush()
    }

    /// File with the channels for viewers.
    pub(crate) fn tape(&mut self) -> &mut Tape {
        &mut self.tape
    }

    /// Number of rows given to the file.
    pub fn rows(&self) -> u64 {
        self.chain.rows()
    }

    /// Signs the end, closes the file, and waits until the disk has the file.
    ///
    /// # Errors
    /// Writing fails or has failed before.
    pub fn finish(mut self, end: SessionEnd) -> Result<Finished, RecordError> {
        self.flush()?;
        // Only the exact log has this line, because the channels for viewers are complete.
        let line = self.tape.said().line();
        self.log_exactly(self.last_time, Level::Info, &line)?;
        self.sign(self.last_time, Some(end))?;
        let bytes = self.tape.finish(self.lost_rows)?;
        Ok(Finished {
            bytes,
            rows: self.rows(),
        })
    }

    fn on_time(&mut self, now: u64) -> Result<(), RecordError> {
        let signed = *self.signed.get_or_insert(now);
        if now.abs_diff(signed) >= SIGN_EVERY_NS {
            self.sign(now, None)?;
            self.signed = Some(now);
        }
        self.tape.on_time(now)
    }

    fn sign(&mut self, time_unix_ns: u64, end: Option<SessionEnd>) -> Result<(), RecordError> {
        let [header, scene, exercise] = self.hashes;
        let statement = Statement {
            tick: self.chain.tick(),
            rows: self.chain.rows(),
            head: *self.chain.head(),
            header,
            scene,
            exercise,
            end,
        };
        let bytes = statement.sign(&self.key).to_bytes();
        self.put(Topic::Chain, time_unix_ns, &bytes)
    }

    fn put(&mut self, topic: Topic, time_unix_ns: u64, bytes: &[u8]) -> Result<(), RecordError> {
        let mut sealed = std::mem::take(&mut self.sealed);
        envelope::seal(bytes, &mut sealed);
        self.put_sealed(topic, time_unix_ns, sealed)
    }

    /// Writes a whole protobuf message, and keeps its memory for the next one.
    fn put_sealed(
        &mut self,
        topic: Topic,
        time_unix_ns: u64,
        sealed: Vec<u8>,
    ) -> Result<(), RecordError> {
        self.last_time = time_unix_ns;
        let written = self.tape.put(topic, time_unix_ns, &sealed);
        self.sealed = sealed;
        written
    }
}
