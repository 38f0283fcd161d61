//! MCAP file being written. After the first failure nothing more is written to it.

use std::collections::BTreeMap;

use mcap::records::MessageHeader;
use mcap::write::NoSeek;
use sulcus_program::disk;

use super::error::RecordError;
use crate::record::schema::Schema;
use crate::record::storage::Sink;

/// Writer of MCAP on a sink.
pub(super) type Mcap = mcap::Writer<NoSeek<Sink>>;

/// Text of an MCAP error. The crate's own text of an I/O error does not contain the cause.
pub(crate) fn reason(error: &mcap::McapError) -> String {
    match error {
        mcap::McapError::Io(source) => format!("{source}{}", disk::advice(source)),
        other => other.to_string(),
    }
}

/// MCAP file being written, until the first failure.
pub(super) struct Output(Option<Mcap>);

impl Output {
    pub fn new(writer: Mcap) -> Self {
        Self(Some(writer))
    }

    /// Whether the file is still written.
    pub fn is_open(&self) -> bool {
        self.0.is_some()
    }

    /// Runs `action` on the writer. After the first failure there is no writer, and the result is `Ok`.
    ///
    /// # Errors
    /// The first failure, with the number of rows given to the file.
    pub fn write(
        &mut self,
        rows: u64,
        action: impl FnOnce(&mut Mcap) -> mcap::McapResult<()>,
    ) -> Result<(), RecordError> {
        let Some(writer) = &mut self.0 else {
            return Ok(());
        };
        action(writer).map_err(|error| {
            self.abandon();
            RecordError::Stopped {
                rows,
                what: reason(&error),
            }
        })
    }

    /// Takes the writer; `None` after a failure.
    pub fn take(&mut self) -> Option<Mcap> {
        self.0.take()
    }

    /// Drops the writer without the summary that its own `drop` would write: the file must not look finished.
    pub fn abandon(&mut self) {
        drop(self.0.take().map(mcap::Writer::into_inner));
    }
}

/// Declares a channel with its schema; number of the schema and of the channel.
pub(super) fn declare(
    writer: &mut Mcap,
    topic: &str,
    encoding: &str,
    schema: &Schema,
) -> mcap::McapResult<(u16, u16)> {
    let schema_id = writer.add_schema(schema.name, encoding, schema.data)?;
    let id = writer.add_channel(schema_id, topic, encoding, &BTreeMap::new())?;
    Ok((schema_id, id))
}

/// Header of a message whose two times are equal. The sequence is the number of rows; it wraps after 49 days at 1 kHz,
/// and no reader of this crate uses it.
pub(super) fn header(channel_id: u16, rows: u64, time_unix_ns: u64) -> MessageHeader {
    MessageHeader {
        channel_id,
        sequence: rows as u32,
        log_time: time_unix_ns,
        publish_time: time_unix_ns,
    }
}
