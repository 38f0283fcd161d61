//! Messages of a recording as the file has them, with their log times.

use std::collections::BTreeMap;
use std::sync::Arc;

use mcap::records::Record;

use crate::record::read::{ReadError, Recording};
use crate::record::walk;

/// Message as the file has it.
pub(crate) struct RawMessage {
    /// Topic of the channel.
    pub topic: Arc<str>,
    /// Log time, nanoseconds since the Unix epoch.
    pub time_unix_ns: u64,
    /// Protobuf message.
    pub bytes: Vec<u8>,
}

/// Iterator over the messages of some topics, in the order of the file. Unpacks one chunk at a time.
pub(crate) struct Raw<'a> {
    recording: &'a Recording,
    wanted: fn(&str) -> bool,
    next_piece: usize,
    /// Topics of the wanted channels, by number.
    topics: BTreeMap<u16, Arc<str>>,
    unpacked: std::vec::IntoIter<RawMessage>,
}

impl<'a> Raw<'a> {
    /// Messages of the topics that are wanted.
    pub fn new(recording: &'a Recording, wanted: fn(&str) -> bool) -> Self {
        let mut raw = Self {
            recording,
            wanted,
            next_piece: 0,
            topics: BTreeMap::new(),
            unpacked: Vec::new().into_iter(),
        };
        for range in &recording.declared {
            // The scan has checked these bytes. If they have changed since, unpacking of the messages fails.
            let _ = raw.unpack(&recording.bytes[range.clone()]);
        }
        raw
    }

    fn unpack(&mut self, piece: &[u8]) -> Result<Vec<RawMessage>, String> {
        let mut messages = Vec::new();
        walk::visit(piece, |opcode, body| {
            match mcap::parse_record(opcode, body).map_err(|error| error.to_string())? {
                Record::Channel(channel) if (self.wanted)(&channel.topic) => {
                    self.topics.insert(channel.id, channel.topic.into());
                }
                Record::Message { header, data } => {
                    if let Some(topic) = self.topics.get(&header.channel_id) {
                        messages.push(RawMessage {
                            topic: Arc::clone(topic),
                            time_unix_ns: header.log_time,
                            bytes: data.into_owned(),
                        });
                    }
                }
                _ => {}
            }
            Ok(())
        })?;
        Ok(messages)
    }
}

impl Iterator for Raw<'_> {
    type Item = Result<RawMessage, ReadError>;

    fn next(&mut self) -> Option<Self::Item> {
        loop {
            if let Some(message) = self.unpacked.next() {
                return Some(Ok(message));
            }
            let range = self.recording.pieces.get(self.next_piece)?.clone();
            self.next_piece += 1;
            match self.unpack(&self.recording.bytes[range]) {
                Ok(messages) => self.unpacked = messages.into_iter(),
                Err(what) => {
                    self.next_piece = self.recording.pieces.len();
                    return Some(Err(ReadError::Changed { what }));
                }
            }
        }
    }
}
