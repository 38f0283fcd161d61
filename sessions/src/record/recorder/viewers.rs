//! What viewers read: chunks of its own between those of the exact record, so that either can be skipped, and each packs
//! like with like.

use mcap::records::MessageHeader;
use prost::Message;

use super::begin::view_channel;
use super::{RecordError, Recorder};
use crate::record::channels::Schema;

/// Flushes of the exact record between two of what viewers read: a longer chunk packs better, and what kill -9 takes of it
/// is in the exact record.
const FLUSHES: u32 = 5;
/// Bytes that wait at most, should rows stop coming.
const MOST: usize = 4 << 20;

/// Messages that wait for their chunk.
#[derive(Default)]
pub(super) struct Waiting {
    bytes: Vec<u8>,
    /// Channel, time, and where the message ends in `bytes`.
    messages: Vec<(u16, u64, usize)>,
    flushes: u32,
}

impl Recorder {
    /// Adds a channel of protobuf messages for viewers. Its number is of no use after a failure to write.
    pub(crate) fn add_view(&mut self, topic: &str, schema: &Schema) -> Result<u16, RecordError> {
        let mut id = 0;
        let mut viewed = std::mem::take(&mut self.viewed);
        let declared = self.write(|writer| {
            id = view_channel(writer, &mut viewed, topic, schema)?;
            Ok(())
        });
        self.viewed = viewed;
        declared.map(|()| id)
    }

    /// Adds a message to a channel for viewers.
    pub(crate) fn view(
        &mut self,
        channel: u16,
        time_unix_ns: u64,
        message: &impl Message,
    ) -> Result<(), RecordError> {
        if self.writer.is_none() {
            return Ok(());
        }
        let waiting = &mut self.waiting;
        // A Vec grows: there is always room.
        let _ = message.encode(&mut waiting.bytes);
        waiting
            .messages
            .push((channel, time_unix_ns, waiting.bytes.len()));
        if waiting.bytes.len() > MOST {
            self.flush()?;
        }
        Ok(())
    }

    /// Writes what waits after so many flushes of the exact record, whose chunk is closed.
    pub(super) fn flush_views_if_due(&mut self) -> Result<(), RecordError> {
        self.waiting.flushes += 1;
        if self.waiting.flushes < FLUSHES {
            return Ok(());
        }
        self.flush_views()
    }

    /// Writes what waits into a chunk of its own and hands it to the system; the exact record's chunk is closed.
    pub(super) fn flush_views(&mut self) -> Result<(), RecordError> {
        self.waiting.flushes = 0;
        if self.waiting.messages.is_empty() {
            return Ok(());
        }
        let mut waiting = std::mem::take(&mut self.waiting);
        let mut begin = 0;
        for (channel, time, end) in &waiting.messages {
            self.viewed
                .message(*channel, [*time; 2], &waiting.bytes[begin..*end]);
            begin = *end;
        }
        let sequence = self.chain.rows() as u32;
        let written = self.write(|writer| {
            let mut begin = 0;
            for (channel_id, time, end) in &waiting.messages {
                let header = MessageHeader {
                    channel_id: *channel_id,
                    sequence,
                    log_time: *time,
                    publish_time: *time,
                };
                writer.write_to_known_channel(&header, &waiting.bytes[begin..*end])?;
                begin = *end;
            }
            writer.flush()
        });
        waiting.bytes.clear();
        waiting.messages.clear();
        self.waiting = waiting;
        written
    }
}
