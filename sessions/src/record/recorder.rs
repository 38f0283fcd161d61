//! Writing one session into one MCAP file.

mod begin;
mod error;
mod viewers;

use std::fs::OpenOptions;
use std::path::Path;

use mcap::records::MessageHeader;
use mcap::write::NoSeek;

use crate::record::chain::{Chain, Link};
use crate::record::channels;
use crate::record::envelope;
use crate::record::header;
use crate::record::header::SessionHeader;
use crate::record::key::StationKey;
use crate::record::message::{Event, Level, Topic};
use crate::record::row::Row;
use crate::record::statement::{SessionEnd, Statement};
use crate::record::storage::{FileStorage, Sink, Storage};
use crate::record::viewers::Summing;

use begin::begin;
pub(crate) use begin::reason;
pub use error::RecordError;
use viewers::Waiting;

/// Record time between two flushes: what kill -9 can cost, besides the chunk being written.
const FLUSH_EVERY_NS: u64 = 100_000_000;
/// Record time between two signatures.
const SIGN_EVERY_NS: u64 = 10_000_000_000;
/// Seconds between two snapshots of the state in a record.
pub const SNAPSHOT_EVERY_S: f64 = 10.0;

/// What a finished recording holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Finished {
    /// Length of the file.
    pub bytes: u64,
    /// Rows in it.
    pub rows: u64,
}

/// Writes one session. Not for the thread that ticks: a flush may take milliseconds.
///
/// A recorder dropped without [`Recorder::finish`] leaves a file that says it was cut off.
pub struct Recorder {
    /// Gone after the first failure, or when finished.
    writer: Option<mcap::Writer<NoSeek<Sink>>>,
    ids: [u16; Topic::ALL.len()],
    /// Channel of the log for viewers.
    log: u16,
    /// Messages for viewers that are not in a chunk yet.
    waiting: Waiting,
    /// Sum over those that are.
    viewed: Summing,
    key: StationKey,
    chain: Chain,
    hashes: [[u8; 32]; 3],
    /// Record time of the last flush and of the last signature; the first message sets both.
    times: Option<(u64, u64)>,
    last_time: u64,
    /// The protobuf message around the bytes that are written next.
    sealed: Vec<u8>,
    snapshots: u64,
    lost_rows: u64,
}

impl Recorder {
    /// Makes the file, with header and attachments already on their way to the disk.
    ///
    /// # Errors
    /// When the file exists, or cannot be written.
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
            // Without its header the file is of no use to anyone.
            let _ = std::fs::remove_file(path);
        })
    }

    pub(crate) fn on(
        storage: Box<dyn Storage>,
        header: &SessionHeader,
        key: StationKey,
    ) -> Result<Self, RecordError> {
        let stopped = |error: mcap::McapError| RecordError::Stopped {
            rows: 0,
            what: reason(&error),
        };
        let metadata = header.to_metadata(&key.public());
        let digest = header::digest(&metadata);
        let begun = begin(storage, header, metadata).map_err(stopped)?;
        Ok(Self {
            writer: Some(begun.writer),
            ids: begun.ids,
            log: begun.log,
            waiting: Waiting::default(),
            viewed: begun.viewed,
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

    /// Adds the row of a tick; flushes and signs when record time says so.
    ///
    /// # Errors
    /// Out of order; or the first failure to write. After that failure rows are only counted
    /// ([`Recorder::lost_rows`]) and `Ok` is returned, so that a caller logs it once.
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
        if self.writer.is_none() {
            self.lost_rows += 1;
            return Ok(());
        }
        let bytes = row.to_bytes();
        self.chain.add(Link::Row, Some(row.tick), &bytes);
        self.put(Topic::Ticks, row.time_unix_ns, &bytes)?;
        self.on_time(row.time_unix_ns)
    }

    /// Adds the state after `tick` (bytes of [`sulcus_core::State::to_bytes`]): once before the
    /// first row, then every [`SNAPSHOT_EVERY_S`], right after that tick's row.
    ///
    /// # Errors
    /// Out of order; or the first failure to write.
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

    /// Adds something worth reading to the session's log, and to the log for viewers.
    ///
    /// # Errors
    /// The first failure to write.
    pub fn event(
        &mut self,
        time_unix_ns: u64,
        level: Level,
        text: &str,
    ) -> Result<(), RecordError> {
        self.log_exactly(time_unix_ns, level, text)?;
        let log = channels::log(time_unix_ns, level, text);
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
        // In MCAP's log the time of what came before it: a tool that sorts messages by that time keeps the order of the chain.
        self.put(Topic::Events, self.last_time, &bytes)
    }

    /// Closes the chunks and hands them to the system. [`Recorder::push`] does so by itself every
    /// 100 ms of record time (what viewers read: every 500 ms); call this when rows stop coming.
    ///
    /// # Errors
    /// The first failure to write.
    pub fn flush(&mut self) -> Result<(), RecordError> {
        self.write(|writer| writer.flush())?;
        self.flush_views()
    }

    /// Rows that came after writing had failed.
    pub fn lost_rows(&self) -> u64 {
        self.lost_rows
    }

    /// Rows given to the file.
    pub fn rows(&self) -> u64 {
        self.chain.rows()
    }

    /// Signs the end and closes the file, synced to the disk.
    ///
    /// # Errors
    /// When writing fails or has failed before.
    pub fn finish(mut self, end: SessionEnd) -> Result<Finished, RecordError> {
        self.flush()?;
        // In the signed log alone: what viewers read is over.
        let line = self.viewed.sum().line();
        self.log_exactly(self.last_time, Level::Info, &line)?;
        self.sign(self.last_time, Some(end))?;
        let rows = self.rows();
        let stopped = |what: String| RecordError::Stopped { rows, what };
        let Some(mut writer) = self.writer.take() else {
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
        // A clock set back counts like one that went on: rows must not wait for it to catch up.
        let (flushed, signed) = *self.times.get_or_insert((now, now));
        if now.abs_diff(signed) >= SIGN_EVERY_NS {
            self.sign(now, None)?;
            self.times = Some((flushed, now));
        }
        if now.abs_diff(flushed) >= FLUSH_EVERY_NS {
            self.write(|writer| writer.flush())?;
            self.flush_views_if_due()?;
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
        self.last_time = time_unix_ns;
        let header = MessageHeader {
            channel_id: self.ids[topic as usize],
            // Wraps after 49 days; nothing reads it but other tools.
            sequence: self.chain.rows() as u32,
            log_time: time_unix_ns,
            publish_time: time_unix_ns,
        };
        let mut sealed = std::mem::take(&mut self.sealed);
        envelope::seal(bytes, &mut sealed);
        let written = self.write(|writer| writer.write_to_known_channel(&header, &sealed));
        self.sealed = sealed;
        written
    }

    /// Runs `action` on the writer; after the first failure there is no writer, and this is `Ok`.
    fn write(
        &mut self,
        action: impl FnOnce(&mut mcap::Writer<NoSeek<Sink>>) -> mcap::McapResult<()>,
    ) -> Result<(), RecordError> {
        let Some(writer) = &mut self.writer else {
            return Ok(());
        };
        action(writer).map_err(|error| {
            self.abandon();
            RecordError::Stopped {
                rows: self.chain.rows(),
                what: reason(&error),
            }
        })
    }

    /// Lets go of the writer without the summary that it would write when dropped: the file must
    /// not look finished.
    fn abandon(&mut self) {
        drop(self.writer.take().map(mcap::Writer::into_inner));
    }
}

impl Drop for Recorder {
    fn drop(&mut self) {
        // A panic elsewhere should not cost the last tenth of a second.
        let _ = self.flush();
        self.abandon();
    }
}
