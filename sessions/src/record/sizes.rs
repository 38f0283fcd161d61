//! Bytes of a recording by part: header, exact record, channels for viewers; and by channel.

use std::collections::BTreeMap;
use std::fmt;

use mcap::records::op;
use serde::Serialize;

use crate::record::bytes::Cut;
use crate::record::message::Topic;
use crate::record::read::{ReadError, Recording};
use crate::record::walk;
use crate::record::walk::{Framed, Walk};

/// Bytes of one channel.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct ChannelSize {
    /// Topic of the channel.
    pub topic: String,
    /// Name of the messages' type.
    pub schema: String,
    /// Encoding of the messages: `protobuf` for viewers.
    pub encoding: String,
    /// Whether the channel belongs to the exact record; otherwise it is for viewers.
    pub exact: bool,
    /// Number of messages.
    pub messages: u64,
    /// Bytes of the messages themselves, uncompressed.
    pub message_bytes: u64,
    /// Bytes in the file, with framing and index. A chunk contains several channels, and the share of each is by
    /// uncompressed length.
    pub stored_bytes: f64,
}

/// Bytes of a recording by part.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Sizes {
    /// Everything before the first message, and all attachments and metadata. The largest part is the scene.
    /// Independent of the length of the session.
    pub header_bytes: u64,
    /// Exact rows, snapshots, signatures and events.
    pub exact_bytes: f64,
    /// Channels for viewers.
    pub view_bytes: f64,
    /// Rest: the summary, and incomplete records.
    pub rest_bytes: f64,
    /// Exact record, 10^6 bytes per minute of the session; `None` for a session without duration.
    pub exact_mb_per_minute: Option<f64>,
    /// Channels for viewers, 10^6 bytes per minute of the session; `None` for a session without duration.
    pub view_mb_per_minute: Option<f64>,
    /// Forecast for an hour that is one session, 10^9 bytes.
    pub gb_per_station_hour: Option<f64>,
    /// Channels, sorted by topic.
    pub channels: Vec<ChannelSize>,
}

/// Bytes by part and channel. Reads every chunk once.
///
/// # Errors
/// The file has changed since it was opened.
pub(crate) fn sizes(recording: &Recording, duration_s: f64) -> Result<Sizes, ReadError> {
    let changed = |what: String| ReadError::Changed { what };
    let begin = recording.pieces.first().map_or(0, |first| first.start);
    let end = recording.pieces.last().map_or(0, |last| last.end);
    let mut walk = Walk::new(&recording.bytes).ok_or(ReadError::NotMcap)?;
    let behind = recording.placed.iter().filter(|at| **at >= begin);
    let header = behind.fold(begin, |sum, at| {
        sum + walk.peek_at(*at).map_or(0, |record| record.whole.len())
    });
    walk.at = begin;
    let mut table = Table::default();
    // Behind the last valid piece only indexes count.
    while let Ok(record) = walk.peek() {
        match record.opcode {
            op::CHUNK if recording.is_good_chunk(walk.at) => {
                table.chunk(&record).map_err(changed)?
            }
            op::SCHEMA | op::CHANNEL | op::MESSAGE if walk.at < end => table.loose(&record),
            op::MESSAGE_INDEX => table.index(&record),
            _ if walk.at >= end => break,
            _ => {}
        }
        walk.pass(&record);
    }
    let mut channels: Vec<ChannelSize> = table.channels.into_values().collect();
    channels.sort_by(|a, b| a.topic.cmp(&b.topic));
    let sum = |exact: bool| {
        let ours = channels.iter().filter(|channel| channel.exact == exact);
        ours.fold(0.0, |sum, channel| sum + channel.stored_bytes)
    };
    let (exact, view) = (sum(true), sum(false));
    let rate = |bytes: f64| (duration_s > 0.0).then(|| bytes * 1e-6 / duration_s * 60.0);
    let rest = recording.len() as f64 - header as f64 - exact - view;
    let hour = rate(exact + view + rest).map(|per_minute| per_minute * 60.0 * 1e-3);
    Ok(Sizes {
        header_bytes: header as u64,
        exact_bytes: exact,
        view_bytes: view,
        rest_bytes: rest,
        exact_mb_per_minute: rate(exact),
        view_mb_per_minute: rate(view),
        gb_per_station_hour: hour.map(|hour| hour + header as f64 * 1e-9),
        channels,
    })
}

#[derive(Default)]
struct Table {
    schemas: BTreeMap<u16, String>,
    channels: BTreeMap<u16, ChannelSize>,
}

impl Table {
    /// Divides the bytes of a chunk among its channels.
    fn chunk(&mut self, chunk: &Framed<'_>) -> Result<(), String> {
        let mut shares: BTreeMap<u16, u64> = BTreeMap::new();
        walk::unpack(chunk, |opcode, body| {
            if let Some(id) = self.record(opcode, body) {
                *shares.entry(id).or_default() += body.len() as u64;
            }
            Ok(())
        })?;
        let total: u64 = shares.values().sum();
        for (id, share) in shares {
            if let Some(channel) = self.channels.get_mut(&id) {
                channel.stored_bytes += chunk.whole.len() as f64 * share as f64 / total as f64;
            }
        }
        Ok(())
    }

    /// Adds a record outside of chunks.
    fn loose(&mut self, record: &Framed<'_>) {
        if let Some(id) = self.record(record.opcode, record.body)
            && let Some(channel) = self.channels.get_mut(&id)
        {
            channel.stored_bytes += record.whole.len() as f64;
        }
    }

    /// Adds a record; number of the channel for a message.
    fn record(&mut self, opcode: u8, body: &[u8]) -> Option<u16> {
        match opcode {
            op::SCHEMA => {
                let (id, name, ..) = walk::schema(body)?;
                self.schemas.insert(id, name.to_owned());
                None
            }
            op::CHANNEL => {
                self.channel(body);
                None
            }
            op::MESSAGE => {
                let (id, _, bytes) = walk::message(body)?;
                let channel = self.channels.get_mut(&id)?;
                channel.messages += 1;
                channel.message_bytes += bytes.len() as u64;
                Some(id)
            }
            _ => None,
        }
    }

    fn channel(&mut self, body: &[u8]) {
        let Some((id, schema_id, topic, encoding)) = walk::channel(body) else {
            return;
        };
        let schema = self.schemas.get(&schema_id);
        self.channels.entry(id).or_insert_with(|| ChannelSize {
            topic: topic.to_owned(),
            schema: schema.cloned().unwrap_or_default(),
            encoding: encoding.to_owned(),
            exact: Topic::from_name(topic).is_some(),
            ..ChannelSize::default()
        });
    }

    fn index(&mut self, record: &Framed<'_>) {
        if let Some(id) = Cut(record.body).u16()
            && let Some(channel) = self.channels.get_mut(&id)
        {
            channel.stored_bytes += record.whole.len() as f64;
        }
    }
}

impl fmt::Display for Sizes {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let rate = |rate: Option<f64>| {
            rate.map_or(String::new(), |rate| format!(", {rate:.2} MB per minute"))
        };
        let header = self.header_bytes as f64 * 1e-6;
        writeln!(f, "  header     {header:.2} MB")?;
        for (name, exact, bytes, per_minute) in [
            ("exact", true, self.exact_bytes, self.exact_mb_per_minute),
            ("viewers", false, self.view_bytes, self.view_mb_per_minute),
        ] {
            writeln!(f, "  {name:<10} {:.2} MB{}", bytes * 1e-6, rate(per_minute))?;
            let mut kinds: BTreeMap<&str, (u64, u64, f64)> = BTreeMap::new();
            for channel in self.channels.iter().filter(|of| of.exact == exact) {
                let kind = kinds.entry(&channel.schema).or_default();
                kind.0 += 1;
                kind.1 += channel.messages;
                kind.2 += channel.stored_bytes;
            }
            for (schema, (channels, messages, bytes)) in kinds {
                // Text from a file may contain control characters of a terminal.
                let schema = schema.escape_debug().to_string();
                let plural = if channels == 1 { "" } else { "s" };
                writeln!(
                    f,
                    "    {schema:<26} {:>8.3} MB, {messages:>7} messages on {channels} channel{plural}",
                    bytes * 1e-6
                )?;
            }
        }
        match self.gb_per_station_hour {
            Some(hour) => write!(
                f,
                "  disk       {hour:.2} GB per station hour; {header:.1} MB more for each further session that begins in it"
            ),
            None => write!(f, "  disk       unknown, the session is too short"),
        }
    }
}
