//! Missing part of a cut off or damaged recording, as far as the rest of the file tells.

use std::collections::BTreeMap;
use std::fmt;

use mcap::records::op;
use serde::Serialize;

use crate::record::bytes::Cut;
use crate::record::gap::Gap;
use crate::record::message::Topic;
use crate::record::read::Recording;
use crate::record::walk;

/// Copied channels by number: topic and time of the last copied message, nanoseconds since the Unix epoch.
pub(super) type Seen = BTreeMap<u16, (String, Option<u64>)>;

/// Channel of which messages may be missing.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct LostChannel {
    /// Topic of the channel.
    pub topic: String,
    /// Number of missing messages, if an index behind the damage tells it.
    pub messages: Option<u64>,
    /// Time of the last copied message, nanoseconds since the Unix epoch; `None` without a copied message.
    pub last_unix_ns: Option<u64>,
}

impl fmt::Display for LostChannel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: ", self.topic.escape_debug())?;
        match self.messages {
            Some(n) => write!(f, "{n} messages"),
            None => f.write_str("an unknown number of messages"),
        }
    }
}

/// Missing part of a recording.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Lost {
    /// Left out bytes of the damaged file: in the gaps, and behind the last whole chunk.
    pub bytes: u64,
    /// Missing session time, milliseconds: in the gaps, and from the last copied row to the last time that the rest
    /// names; `None` if unknown.
    pub ms: Option<f64>,
    /// Missing ticks, in the gaps and at the end; `None` if unknown. Those at the end are counted by an index behind
    /// the damage, otherwise by time.
    pub ticks: Option<u64>,
    /// Gaps between the copied parts.
    pub gaps: Vec<Gap>,
    /// Channels of which messages are missing or may be missing.
    pub channels: Vec<LostChannel>,
    /// Whether the station's last statement is missing, so that the session may have continued.
    pub end_is_missing: bool,
    /// Damaged chunks of the channels for viewers, which were left out. The exact record is in other chunks.
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
            // Behind the session's end nothing of the session is missing.
            _ if !self.end_is_missing && !gaps.is_empty() => {}
            _ if !self.end_is_missing && self.bytes == 0 => f.write_str("no exact message")?,
            _ if !self.end_is_missing => f.write_str("only the file's index")?,
            (Some(0) | None, _) if !gaps.is_empty() => {}
            (Some(ticks), _) if !gaps.is_empty() => write!(f, "{then}{ticks} ticks")?,
            (Some(ticks), Some(ms)) => write!(f, "{ticks} ticks ({ms:.0} ms)")?,
            (Some(ticks), None) => write!(f, "{ticks} ticks")?,
            (None, Some(ms)) => write!(f, "{ms:.0} ms")?,
            (None, None) if self.bytes == 0 => {
                f.write_str("no message that had reached the file")?
            }
            (None, None) => write!(f, "the content of the last {} bytes", self.bytes)?,
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
            1 => f.write_str(", and a damaged chunk of the channels for viewers")?,
            n => write!(f, ", and {n} damaged chunks of the channels for viewers")?,
        }
        Ok(())
    }
}

impl Lost {
    /// Missing ticks in gaps with two known ends.
    fn of_gaps(&self) -> u64 {
        self.gaps.iter().filter_map(Gap::ticks).sum()
    }
}

/// A channel without a message for this time before the damage counts as not written, nanoseconds.
const RECENT_NS: u64 = 1_000_000_000;

/// Missing part by the copied channels and by the left out bytes.
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
    // Only the rest behind the last chunk has times that no later row names.
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
        // With an index the named channels count; without an index the recently written ones.
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

/// Bytes of the damaged file in a gap.
fn gap_bytes<'a>(recording: &'a Recording, gap: &Gap) -> &'a [u8] {
    let range = || {
        let begin = usize::try_from(gap.at_byte).ok()?;
        let end = begin.checked_add(usize::try_from(gap.bytes).ok()?)?;
        recording.bytes.get(begin..end)
    };
    range().unwrap_or_default()
}

/// Sum of the known values.
fn sum<T: std::ops::Add<Output = T>>(a: Option<T>, b: Option<T>) -> Option<T> {
    match (a, b) {
        (Some(a), Some(b)) => Some(a + b),
        (a, b) => a.or(b),
    }
}

/// Numbers from a rest with arbitrary bytes. They are for display only.
#[derive(Default)]
struct Tail {
    /// Latest time in the header of a chunk.
    until: Option<u64>,
    /// Number of messages by channel, from the indexes behind chunks.
    counts: BTreeMap<u16, u64>,
}

impl Tail {
    fn read(&mut self, tail: &[u8]) {
        let mut cut = Cut(tail);
        while let (Some(opcode), Some(length)) = (cut.u8(), cut.u64()) {
            let length = usize::try_from(length).unwrap_or(usize::MAX);
            // The last record may be cut off; its present bytes count.
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
        // A chunk with an invalid header has no time.
        if walk::is_chunk_header(body) {
            self.until = self.until.max(Some(until));
        }
    }

    fn index(&mut self, body: &[u8]) {
        let mut cut = Cut(body);
        if let (Some(channel), Some(bytes)) = (cut.u16(), cut.u32()) {
            // Each entry has a time and an offset.
            let there = cut.0.len().min(bytes as usize) as u64 / 16;
            let count = self.counts.entry(channel).or_default();
            *count = count.saturating_add(there);
        }
    }
}
