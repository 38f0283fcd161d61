//! What a torn recording has lost, as far as its tail still says.

use std::collections::BTreeMap;
use std::fmt;

use mcap::records::op;
use serde::Serialize;

use super::Seen;
use crate::record::bytes::Cut;
use crate::record::gap::Gap;
use crate::record::message::Topic;
use crate::record::read::Recording;
use crate::record::walk;

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
    /// Bytes of the damaged file that were left out: of the gaps, and behind the last whole chunk.
    pub bytes: u64,
    /// Milliseconds of session time in the gaps, and from the last row that was kept to the last time that the tail still names;
    /// `None` where neither says so.
    pub ms: Option<f64>,
    /// Ticks in the gaps and at the end; of the end counted where an index behind the damage has them, otherwise by time. `None` where
    /// nothing says so.
    pub ticks: Option<u64>,
    /// Gaps between what was kept.
    pub gaps: Vec<Gap>,
    /// Channels of which messages are missing, or may be.
    pub channels: Vec<LostChannel>,
    /// Whether the session went on: its last statement is not in the file.
    pub end_is_missing: bool,
    /// Chunks of what viewers read that were damaged and are left behind; all that is exact is in others.
    pub damaged_views: u64,
}

impl fmt::Display for Lost {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let gaps: Vec<String> = self.gaps.iter().map(ToString::to_string).collect();
        f.write_str(&gaps.join("; "))?;
        let of_gaps = self.of_gaps();
        let tail = (
            self.ticks.map(|ticks| ticks.saturating_sub(of_gaps)),
            self.ms,
        );
        let then = if gaps.is_empty() { "" } else { "; at the end " };
        match tail {
            // Behind the session's end there is nothing of it.
            _ if !self.end_is_missing && !gaps.is_empty() => {}
            _ if !self.end_is_missing && self.bytes == 0 => f.write_str("nothing that is exact")?,
            _ if !self.end_is_missing => f.write_str("only the file's index")?,
            (Some(0) | None, _) if !gaps.is_empty() => {}
            (Some(ticks), _) if !gaps.is_empty() => write!(f, "{then}{ticks} ticks")?,
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

impl Lost {
    /// Ticks that are missing in gaps, as far as both ends of them are known.
    fn of_gaps(&self) -> u64 {
        self.gaps.iter().filter_map(Gap::ticks).sum()
    }
}

/// Channels silent for so long before the tear were not being written.
const RECENT_NS: u64 = 1_000_000_000;

/// Looks at what was left out of the damaged file for what it still says.
pub(super) fn find(recording: &Recording, seen: &Seen) -> Lost {
    let tail = recording.bytes.get(recording.tail..).unwrap_or_default();
    let gaps = recording.gaps().to_vec();
    let in_gaps: u64 = gaps.iter().map(|gap| gap.bytes).sum();
    let lost = Lost {
        bytes: in_gaps + tail.len() as u64,
        gaps,
        end_is_missing: recording.facts().end.is_none(),
        damaged_views: recording.facts().damaged_views,
        ..Lost::default()
    };
    if !lost.end_is_missing && lost.gaps.is_empty() {
        return lost;
    }
    let mut said = Tail::default();
    for gap in &lost.gaps {
        said.read(gap_bytes(recording, gap));
    }
    // Only the tail has a time that no row behind it names.
    let counted_in_gaps = std::mem::take(&mut said.counts);
    said.until = None;
    if lost.end_is_missing {
        said.read(tail);
    }
    let last_row = recording.facts().times_unix_ns.unwrap_or_default().1;
    let tick_ms = recording.scene().ok().map(|scene| scene.tick_s() * 1e3);
    let tail_ms = said
        .until
        .filter(|until| *until > last_row)
        .map(|until| (until - last_row) as f64 * 1e-6);
    let tail_rows = seen
        .iter()
        .find(|(_, (topic, _))| topic == Topic::Ticks.name())
        .and_then(|(id, _)| said.counts.get(id).copied());
    let by_time = tail_ms
        .zip(tick_ms)
        .map(|(ms, tick_ms)| (ms / tick_ms).round() as u64);
    let gap_ticks = (!lost.gaps.is_empty()).then(|| lost.of_gaps());
    let gap_ms = gap_ticks
        .zip(tick_ms)
        .map(|(ticks, tick_ms)| ticks as f64 * tick_ms);
    let no_index = said.counts.is_empty();
    for (id, count) in counted_in_gaps {
        let sum = said.counts.entry(id).or_default();
        *sum = sum.saturating_add(count);
    }
    let channels = seen.iter().filter_map(|(id, (topic, last))| {
        let counted = said.counts.get(id).copied();
        let recent = last.is_some_and(|last| last_row.abs_diff(last) <= RECENT_NS);
        // With an index, those that it names; without one, those that were being written.
        let missing =
            counted.is_some() || (no_index && recent && !tail.is_empty() && lost.end_is_missing);
        missing.then(|| LostChannel {
            topic: topic.clone(),
            messages: counted,
            last_unix_ns: *last,
        })
    });
    Lost {
        ms: sum(gap_ms, tail_ms),
        ticks: sum(gap_ticks, tail_rows.or(by_time)),
        channels: channels.collect(),
        ..lost
    }
}

/// The bytes of the damaged file that a gap left out.
fn gap_bytes<'a>(recording: &'a Recording, gap: &Gap) -> &'a [u8] {
    let range = || {
        let begin = usize::try_from(gap.at_byte).ok()?;
        let end = begin.checked_add(usize::try_from(gap.bytes).ok()?)?;
        recording.bytes.get(begin..end)
    };
    range().unwrap_or_default()
}

/// The sum of what is known.
fn sum<T: std::ops::Add<Output = T>>(a: Option<T>, b: Option<T>) -> Option<T> {
    match (a, b) {
        (Some(a), Some(b)) => Some(a + b),
        (a, b) => a.or(b),
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
