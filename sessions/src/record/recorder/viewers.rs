//! Channels for viewers in a recording. Their chunks are apart from those of the exact record, so that a reader can
//! skip either kind, and each kind compresses well.

use prost::Message;

use super::error::RecordError;
use super::output::{Mcap, Output, declare, header};
use crate::record::policy::ViewersPolicy;
use crate::record::schema::Schema;
use crate::record::viewers::{Said, Summing};

/// Flushes of the exact record between two flushes of the channels for viewers. A longer chunk compresses better, and
/// the data that kill -9 can cost is also in the exact record.
const FLUSHES: u32 = 5;
/// Largest number of waiting bytes, if no more rows come.
const MOST: usize = 4 << 20;

/// Encoding of all messages for viewers.
const ENCODING: &str = "protobuf";

/// Extent of the channels for viewers in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Extent {
    /// Channels that the policy writes.
    Policy,
    /// All channels: the file is made from one whose policy left channels out.
    All,
}

/// Message that waits for its chunk.
struct Waiting {
    channel: u16,
    /// Number of rows before the message.
    rows: u64,
    time_unix_ns: u64,
    /// End of the message in the waiting bytes.
    end: usize,
}

/// Messages for viewers that wait for their chunk, and the sums over all and over the kept ones.
pub(super) struct Views {
    policy: ViewersPolicy,
    extent: Extent,
    /// Numbers of the channels in the file, by the order of declaration; `None` for a channel that is not written.
    written: Vec<Option<u16>>,
    bytes: Vec<u8>,
    messages: Vec<Waiting>,
    flushes: u32,
    sum: Summing,
    kept: Summing,
}

impl Views {
    pub fn new(policy: ViewersPolicy, extent: Extent) -> Self {
        Self {
            policy,
            extent,
            written: Vec::new(),
            bytes: Vec::new(),
            messages: Vec::new(),
            flushes: 0,
            sum: Summing::by(policy),
            kept: Summing::by(policy),
        }
    }

    /// Declares a channel of protobuf messages, in the file if it is written, and in the sums; its number here.
    pub fn declare(
        &mut self,
        writer: &mut Mcap,
        topic: &str,
        schema: &Schema,
    ) -> mcap::McapResult<u16> {
        let number = self.written.len() as u16;
        let is_kept = self.policy.writes(topic);
        let id = if is_kept || self.extent == Extent::All {
            Some(declare(writer, topic, ENCODING, schema)?.1)
        } else {
            None
        };
        self.written.push(id);
        let sums = std::iter::once(&mut self.sum).chain(is_kept.then_some(&mut self.kept));
        for sum in sums {
            sum.schema(number, schema.name, ENCODING, schema.data);
            sum.channel(number, number, topic, ENCODING);
        }
        Ok(number)
    }

    /// Adds a message behind so many rows; whether so many bytes wait that a flush is due.
    pub fn push(
        &mut self,
        channel: u16,
        rows: u64,
        time_unix_ns: u64,
        message: &impl Message,
    ) -> bool {
        let begin = self.bytes.len();
        // Encoding into a Vec never fails: a Vec grows.
        let _ = message.encode(&mut self.bytes);
        let (bytes, times) = (&self.bytes[begin..], [time_unix_ns; 2]);
        self.sum.message(channel, times, bytes);
        if self.kept.knows(channel) {
            self.kept.message(channel, times, bytes);
        }
        match self.written.get(usize::from(channel)) {
            Some(Some(id)) => self.messages.push(Waiting {
                channel: *id,
                rows,
                time_unix_ns,
                end: self.bytes.len(),
            }),
            _ => self.bytes.truncate(begin),
        }
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
        let written = output.write(rows, |writer| {
            let mut begin = 0;
            for message in messages {
                let header = header(message.channel, message.rows, message.time_unix_ns);
                writer.write_to_known_channel(&header, &bytes[begin..message.end])?;
                begin = message.end;
            }
            writer.flush()
        });
        self.bytes.clear();
        self.messages.clear();
        written
    }

    /// Sums so far, for the signed log.
    pub fn said(&self) -> Said {
        match self.policy {
            ViewersPolicy::Recorded => Said::Recorded(self.sum.sum()),
            ViewersPolicy::OnDemand => Said::OnDemand {
                all: self.sum.sum(),
                kept: self.kept.sum(),
            },
        }
    }
}
