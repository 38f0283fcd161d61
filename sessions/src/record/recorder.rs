//! Recorder of one session into one MCAP file.

mod begin;
mod error;
mod output;
mod viewers;

use std::fs::OpenOptions;
use std::path::Path;

use prost::Message;

use crate::record::chain::{Chain, Link};
use crate::record::channels::foxglove_types::log;
use crate::record::envelope;
use crate::record::header;
use crate::record::header::SessionHeader;
use crate::record::key::StationKey;
use crate::record::message::{Event, Level, Topic};
use crate::record::row::Row;
use crate::record::schema::Schema;
use crate::record::statement::{SessionEnd, Statement};
use crate::record::storage::{FileStorage, Storage};

pub use error::RecordError;
pub(crate) use output::reason;

use begin::begin;
use output::{Mcap, Output};
use viewers::Views;

/// Record time between two flushes, nanoseconds: the loss by kill -9, besides the chunk being written.
const FLUSH_EVERY_NS: u64 = 100_000_000;
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
    output: Output,
    ids: [u16; Topic::ALL.len()],
    /// Channel of the log for viewers.
    log: u16,
    views: Views,
    key: StationKey,
    chain: Chain,
    hashes: [[u8; 32]; 3],
    /// Record time of the last flush and of the last signature. The first message sets both.
    times: Option<(u64, u64)>,
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
        let stopped = |error: mcap::McapError| RecordError::Stopped {
            rows: 0,
            what: reason(&error),
        };
        let metadata = header.to_metadata(&key.public());
        let digest = header::digest(&metadata);
        let begun = begin(storage, header, metadata).map_err(stopped)?;
        Ok(Self {
            output: Output::new(begun.writer),
            ids: begun.ids,
            log: begun.log,
            views: begun.views,
            key,
            chain: Chain::new(digest),
            hashes: [digest, header.scene_hash(), header.exercise_hash()],
            times: None,
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
        if !self.output.is_open() {
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
        let log = log(time_unix_ns, level, text);
        self.view(self.log, self.last_time, &log)
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
        self.write(|writer| writer.flush())?;
        self.views.flush(&mut self.output, self.chain.rows())
    }

    /// Adds a channel of protobuf messages for viewers. After a failure to write the number is meaningless.
    pub(crate) fn add_view(&mut self, topic: &str, schema: &Schema) -> Result<u16, RecordError> {
        let (mut id, views) = (0, &mut self.views);
        let rows = self.chain.rows();
        self.output.write(rows, |writer| {
            id = views.declare(writer, topic, schema)?;
            Ok(())
        })?;
        Ok(id)
    }

    /// Adds a message to a channel for viewers.
    pub(crate) fn view(
        &mut self,
        channel: u16,
        time_unix_ns: u64,
        message: &impl Message,
    ) -> Result<(), RecordError> {
        if self.output.is_open() && self.views.push(channel, time_unix_ns, message) {
            self.flush()?;
        }
        Ok(())
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
        let line = self.views.sum().line();
        self.log_exactly(self.last_time, Level::Info, &line)?;
        self.sign(self.last_time, Some(end))?;
        let rows = self.rows();
        let stopped = |what: String| RecordError::Stopped { rows, what };
        let Some(mut writer) = self.output.take() else {
            let lost = self.lost_rows;
            return Err(stopped(format!(
                "{lost} rows came after writing had failed"
            )));
        };
        writer.finish().map_err(|error| stopped(reason(&error)))?;
        let sink = writer.into_inner().into_inner();
        let bytes = sink.close().map_err(|error| stopped(error.to_string()))?;
        Ok(Finished { bytes, rows })
    }

    fn on_time(&mut self, now: u64) -> Result<(), RecordError> {
        // A clock that was set back counts like a clock that went on. Rows must not wait until the clock has caught up.
        let (flushed, signed) = *self.times.get_or_insert((now, now));
        if now.abs_diff(signed) >= SIGN_EVERY_NS {
            self.sign(now, None)?;
            self.times = Some((flushed, now));
        }
        if now.abs_diff(flushed) >= FLUSH_EVERY_NS {
            self.write(|writer| writer.flush())?;
            if self.views.is_due() {
                self.views.flush(&mut self.output, self.chain.rows())?;
            }
            self.times = self.times.map(|(_, signed)| (now, signed));
        }
        Ok(())
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
        let header = output::header(self.ids[topic as usize], self.chain.rows(), time_unix_ns);
        let written = self.write(|writer| writer.write_to_known_channel(&header, &sealed));
        self.sealed = sealed;
        written
    }

    fn write(
        &mut self,
        action: impl FnOnce(&mut Mcap) -> mcap::McapResult<()>,
    ) -> Result<(), RecordError> {
        self.output.write(self.chain.rows(), action)
    }
}

impl Drop for Recorder {
    fn drop(&mut self) {
        // A panic elsewhere should not cost the last tenth of a second.
        let _ = self.flush();
        self.output.abandon();
    }
}
