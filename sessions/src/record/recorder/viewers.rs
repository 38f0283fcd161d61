//! Channels for viewers in a recording. Their chunks are apart from those of the exact record, so that a reader can
//! skip either kind, and each kind compresses well.

use prost::Message;

use super::error::RecordError;
use super::output::{Mcap, Output, declare, header};
use crate::record::schema::Schema;
use crate::record::viewers::{Sum, Summing};

/// Flushes of the exact record between two flushes of the channels for viewers. A longer chunk compresses better, and
/// the data that kill -9 can cost is also in the exact record.
const FLUSHES: u32 = 5;
/// Largest number of waiting bytes, if no more rows come.
const MOST: usize = 4 << 20;

/// Messages for viewers that wait for their chunk, and the sum over the written ones.
#[derive(Default)]
pub(super) struct Views {
    bytes: Vec<u8>,
    /// Channel, time, and end of the message in `bytes`.
    messages: Vec<(u16, u64, usize)>,
    flushes: u32,
    sum: Summing,
}

impl Views {
    /// Declares a channel of protobuf messages, in the file and in the sum.
    pub fn declare(
        &mut self,
        writer: &mut Mcap,
        topic: &str,
        schema: &Schema,
    ) -> mcap::McapResult<u16> {
        let encoding = "protobuf";
        let (schema_id, id) = declare(writer, topic, encoding, schema)?;
        self.sum
            .schema(schema_id, schema.name, encoding, schema.data);
        self.sum.channel(id, schema_id, topic, encoding);
        Ok(id)
    }

    /// Adds a message; whether so many bytes wait that a flush is due.
    pub fn push(&mut self, channel: u16, time_unix_ns: u64, message: &impl Message) -> bool {
        // Encoding into a Vec never fails: a Vec grows.
        let _ = message.encode(&mut self.bytes);
        self.messages
            .push((channel, time_unix_ns, self.bytes.len()));
        self.bytes.len() > MOST
    }

    /// Counts a flush of the exact record; whether a flush of these channels is due.
    pub fn is_due(&mut self) -> bool {
        self.flushes += 1;
        self.flushes >= FLUSHES
    }

    /// Writes the waiting messages into a chunk of their own and flushes it. The chunk of the exact record must be
    /// closed.
    ///
    /// # Errors
    /// The first failure to write.
    pub fn flush(&mut self, output: &mut Output, rows: u64) -> Result<(), RecordError> {
        self.flushes = 0;
        if self.messages.is_empty() {
            return Ok(());
        }
        let (bytes, messages) = (&self.bytes, &self.messages);
        let mut begin = 0;
        for (channel, time, end) in messages {
            self.sum.message(*channel, [*time; 2], &bytes[begin..*end]);
            begin = *end;
        }
        let written = output.write(rows, |writer| {
            let mut begin = 0;
            for (channel, time, end) in messages {
                let header = header(*channel, rows, *time);
                writer.write_to_known_channel(&header, &bytes[begin..*end])?;
                begin = *end;
            }
            writer.flush()
        });
        self.bytes.clear();
        self.messages.clear();
        written
    }

    /// Sum over the written messages.
    pub fn sum(&self) -> Sum {
        self.sum.sum()
    }
}
