//! File of a recording, in which exact messages and messages for viewers have chunks of their own.

use prost::Message;

use super::begin::{Head, begin};
use super::error::RecordError;
use super::output::{Mcap, Output, header, reason};
use super::viewers::{Extent, Views};
use crate::record::channels::foxglove_types::log;
use crate::record::message::{Level, Topic};
use crate::record::policy::ViewersPolicy;
use crate::record::schema::Schema;
use crate::record::storage::Storage;
use crate::record::viewers::Said;

/// Record time between two flushes, nanoseconds: the loss by kill -9, besides the chunk being written.
const FLUSH_EVERY_NS: u64 = 100_000_000;

/// File of a recording being written. It knows neither chain nor key.
pub(crate) struct Tape {
    output: Output,
    ids: [u16; Topic::ALL.len()],
    /// Channel of the log for viewers.
    log: u16,
    views: Views,
    /// Number of rows given to the file.
    rows: u64,
    /// Record time of the last flush. The first row sets it.
    flushed: Option<u64>,
}

impl Tape {
    /// Writes header and channels.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn begin(
        storage: Box<dyn Storage>,
        head: &Head,
        policy: ViewersPolicy,
        extent: Extent,
    ) -> Result<Self, RecordError> {
        let begun = begin(storage, head, Views::new(policy, extent)).map_err(|error| {
            RecordError::Stopped {
                rows: 0,
                what: reason(&error),
            }
        })?;
        Ok(Self {
            output: Output::new(begun.writer),
            ids: begun.ids,
            log: begun.log,
            views: begun.views,
            rows: 0,
            flushed: None,
        })
    }

    /// Whether the file is still written.
    pub fn is_open(&self) -> bool {
        self.output.is_open()
    }

    /// Adds an exact message, with its protobuf envelope.
    ///
    /// # Errors
    /// Writing fails for the first time.
    pub fn put(
        &mut self,
        topic: Topic,
        time_unix_ns: u64,
        sealed: &[u8],
    ) -> Result<(), RecordError> {
        if topic == Topic::Ticks {
            self.rows += 1;
        }
        let header = header(self.ids[topic as usize], self.rows, time_unix_ns);
        self.write(|writer| writer.write_to_known_channel(&header, sealed))
    }

    /// Adds a line to the log for viewers. `log_time_unix_ns` is the log time of the exact event.
    ///
    /// # Errors
    /// Writing fails for the first time.
    pub fn say(
        &mut self,
        log_time_unix_ns: u64,
        time_unix_ns: u64,
        level: Level,
        text: &str,
    ) -> Result<(), RecordError> {
        let line = log(time_unix_ns, level, text);
        self.view(self.log, log_time_unix_ns, &line)
    }

    /// Adds a channel of protobuf messages for viewers. After a failure to write the number is meaningless.
    ///
    /// # Errors
    /// Writing fails for the first time.
    pub fn add_view(&mut self, topic: &str, schema: &Schema) -> Result<u16, RecordError> {
        let (mut id, views) = (0, &mut self.views);
        self.output.write(self.rows, |writer| {
            id = views.declare(writer, topic, schema)?;
            Ok(())
        })?;
        Ok(id)
    }

    /// Adds a message to a channel for viewers.
    ///
    /// # Errors
    /// Writing fails for the first time.
    pub fn view(
        &mut self,
        channel: u16,
        time_unix_ns: u64,
        message: &impl Message,
    ) -> Result<(), RecordError> {
        if self.output.is_open() && self.views.push(channel, self.rows, time_unix_ns, message) {
            self.flush()?;
        }
        Ok(())
    }

    /// Flushes if record time says so.
    ///
    /// # Errors
    /// Writing fails for the first time.
    pub fn on_time(&mut self, now: u64) -> Result<(), RecordError> {
        // A clock that was set back counts like a clock that went on. Rows must not wait until the clock has caught up.
        let flushed = *self.flushed.get_or_insert(now);
        if now.abs_diff(flushed) >= FLUSH_EVERY_NS {
            self.write(|writer| writer.flush())?;
            if self.views.is_due() {
                self.views.flush(&mut self.output, self.rows)?;
            }
            self.flushed = Some(now);
        }
        Ok(())
    }

    /// Closes the chunks and hands them to the system.
    ///
    /// # Errors
    /// Writing fails for the first time.
    pub fn flush(&mut self) -> Result<(), RecordError> {
        self.write(|writer| writer.flush())?;
        self.views.flush(&mut self.output, self.rows)
    }

    /// Sums over the channels for viewers so far.
    pub fn said(&self) -> Said {
        self.views.said()
    }

    /// Flushes and closes the file, and waits until the disk has it; length in bytes. `lost_rows` came after writing
    /// had failed.
    ///
    /// # Errors
    /// Writing fails or has failed before.
    pub fn finish(&mut self, lost_rows: u64) -> Result<u64, RecordError> {
        self.flush()?;
        let rows = self.rows;
        let stopped = |what: String| RecordError::Stopped { rows, what };
        let Some(mut writer) = self.output.take() else {
            return Err(stopped(format!(
                "{lost_rows} rows came after writing had failed"
            )));
        };
        writer.finish().map_err(|error| stopped(reason(&error)))?;
        let sink = writer.into_inner().into_inner();
        sink.close().map_err(|error| stopped(error.to_string()))
    }

    fn write(
        &mut self,
        action: impl FnOnce(&mut Mcap) -> mcap::McapResult<()>,
    ) -> Result<(), RecordError> {
        self.output.write(self.rows, action)
    }
}

impl Drop for Tape {
    fn drop(&mut self) {
        // A panic elsewhere should not cost the last tenth of a second.
        let _ = self.flush();
        self.output.abandon();
    }
}
