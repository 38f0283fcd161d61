//! What a torn recording has lost, as far as its tail still says.

use std::collections::BTreeMap;
use std::fmt;

use mcap::records::op;
use serde::Serialize;

use super::Seen;
use crate::bytes::Cut;
use crate::message::Topic;
use crate::read::Recording;
use crate::walk;

/// A channel of which messages may be missing.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct LostChannel {
    /// Its topic.
    pub topic: String,
    /// How many, where an index behind the damage says so.
    pub messages: Option<u64>,
    /// Time of its last message that was kept, nanoseconds since the Unix epoch; `None` where there is none.
    pub last_unix_ns: Option<u64>,
}

impl fmt::Display for LostChannel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: ", self.topic.escape_debug())?;
        match self.messages {
            Some(n) => write!(f, "{n} messages"),
            None => f.write_str("unknown how many messages"),
        }
    }
}

/// What is missing.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Lost {
    /// Bytes behind the last whole chunk.
    pub bytes: u64,
    /// From the last row that was kept to the last time that the tail still names, milliseconds of session time; `None` where it
    /// names none.
    pub ms: Option<f64>,
    /// Ticks: counted where an index behind the damage has them, otherwise by time; `None` where neither is there.
    pub ticks: Option<u64>,
    /// Channels of which messages are missing, or may be.
    pub channels: Vec<LostChannel>,
    /// Whether the session went on: its last statement is not in the file.
    pub end_is_missing: bool,
    /// Chunks of what viewers read that were damaged and are left behind; all that is exact is in others.
    pub damaged_views: u64,
}

impl fmt::Display for Lost {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (self.ticks, self.ms) {
            // Whatever is behind the session's end is none of it.
            _ if !self.end_is_missing && self.bytes == 0 => f.write_str("nothing that is exact")?,
            _ if !self.end_is_missing => f.write_str("only the file's index")?,
            (Some(ticks), Some(ms)) => write!(f, "{ticks} ticks ({ms:.0} ms)")?,
            (Some(ticks), None) => write!(f, "{ticks} ticks")?,
            (None, Some(ms)) => write!(f, "{ms:.0} ms")?,
            (None, None) if self.bytes == 0 => f.write_str("nothing that had reached the file")?,
            (None, None) => write!(f, "what was in the last {} bytes", self.bytes)?,
        }
        if !self.channels.is_empty() {
            let names: Vec<&str> = self.channels.iter().map(|c| c.topic.as_str()).collect();
            write!(f, " of {}", names.join(", ").escape_debug())?;
        }
        if self.end_is_missing {
            f.write_str(
                ", and the end of the session: up to 200 ms may never have reached the file",
            )?;
        }
        match self.damaged_views {
            0 => {}
            1 => f.write_str(", and a damaged chunk of what viewers read")?,
            n => write!(f, ", and {n} damaged chunks of what viewers read")?,
        }
        Ok(())
    }
}

/// Channels silent for so long before the tear were not being written.
const RECENT_NS: u64 = 1_000_000_000;

/// Looks behind byte `whole` for what the tail still says.
pub(super) fn find(recording: &Recording, whole: usize, seen: &Seen) -> Lost {
    let tail = recording.bytes.get(whole..).unwrap_or_default();
    let lost = Lost {
        bytes: tail.len() as u64,
        end_is_missing: recording.facts().end.is_none(),
        damaged_views: recording.facts().damaged_views,
        ..Lost::default()
    };
    if !lost.end_is_missing {
        return lost;
    }
    let mut said = Tail::default();
    said.read(tail);
    let last_row = recording.facts().times_unix_ns.unwrap_or_default().1;
    let ms = said
        .until
        .filter(|until| *until > last_row)
        .map(|until| (until - last_row) as f64 * 1e-6);
    let tick_ms = recording.scene().ok().map(|scene| scene.tick_s() * 1e3);
    let rows = seen
        .iter()
        .find(|(_, (topic, _))| topic == Topic::Ticks.name())
        .and_then(|(id, _)| said.counts.get(id).copied());
    let by_time = ms
        .zip(tick_ms)
        .map(|(ms, tick_ms)| (ms / tick_ms).round() as u64);
    let channels = seen.iter().filter_map(|(id, (topic, last))| {
        let counted = said.counts.get(id).copied();
        let recent = last.is_some_and(|last| last_row.abs_diff(last) <= RECENT_NS);
        // With an index, those that it names; without one, those that were being written.
        let missing = if said.counts.is_empty() {
            recent && !tail.is_empty()
        } else {
            counted.is_some()
        };
        missing.then(|| LostChannel {
            topic: topic.clone(),
            messages: counted,
            last_unix_ns: *last,
        })
    });
    Lost {
        ms,
        ticks: rows.or(by_time),
        channels: channels.collect(),
        ..lost
    }
}

/// What can be read of a tail whose bytes may be anything: nothing in it is believed but numbers to tell a person.
#[derive(Default)]
struct Tail {
    /// Latest time that a chunk names.
    until: Option<u64>,
    /// Messages by channel, from the indexes that follow chunks.
    counts: BTreeMap<u16, u64>,
}

impl Tail {
    fn read(&mut self, tail: &[u8]) {
        let mut cut = Cut(tail);
        while let (Some(opcode), Some(length)) = (cut.u8(), cut.u64()) {
            let length = usize::try_from(length).unwrap_or(usize::MAX);
            // The last may be torn: what there is of it.
            let body = cut.take(length.min(cut.0.len())).unwrap_or_default();
            match opcode {
                op::CHUNK => self.chunk(body),
                op::MESSAGE_INDEX => self.index(body),
                _ => {}
            }
        }
    }

    fn chunk(&mut self, body: &[u8]) {
        let mut cut = Cut(body);
        let (Some(_), Some(until)) = (cut.u64(), cut.u64()) else {
            return;
        };
        // A chunk whose header makes no sense names no time.
        if walk::is_chunk_header(body) {
            self.until = self.until.max(Some(until));
        }
    }

    fn index(&mut self, body: &[u8]) {
        let mut cut = Cut(body);
        if let (Some(channel), Some(bytes)) = (cut.u16(), cut.u32()) {
            // Time and offset of each message.
            let there = cut.0.len().min(bytes as usize) as u64 / 16;
            let count = self.counts.entry(channel).or_default();
            *count = count.saturating_add(there);
        }
    }
}
