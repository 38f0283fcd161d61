//! The pass over all records of the file.

use std::ops::Range;

use mcap::records::op;

use super::head::{Head, Pairs};
use super::unpack::{Topics, declare, unpack};
use super::{Depth, salvage};
use crate::record::bytes::Cut;
use crate::record::gap::Gap;
use crate::record::header::METADATA;
use crate::record::message::{Message, Topic};
use crate::record::read::{Ending, Facts};
use crate::record::recover;
use crate::record::viewers::{Sum, Summing};
use crate::record::walk;
use crate::record::walk::{Framed, Stop, Walk};

/// Records outside of chunks are read in pieces of about this many bytes.
const LOOSE_BYTES: usize = 256 << 10;

/// Facts known after a number of pieces; a piece is taken in wholly or not at all.
#[derive(Clone, Default)]
pub(super) struct State {
    pub topics: Topics,
    pub facts: Facts,
    pub viewed: Summing,
    /// Tick of the last row or snapshot.
    pub tick: u64,
    /// Messages of the exact channels.
    pub messages: u64,
    /// Gaps so far.
    pub gaps: Vec<Gap>,
    /// The gap that no row or snapshot follows yet.
    pub open: Option<Gap>,
}

/// The pass under way.
pub(super) struct Pass<'a> {
    head: &'a Head,
    pub depth: Depth,
    /// Exact messages before the first gap that a recovery noted: behind it rows may come before any snapshot.
    first_gap: Option<u64>,
    pub state: State,
    pub pieces: Vec<Range<usize>>,
    /// Schemas and channels that only the summary still names.
    pub declared: Vec<Range<usize>>,
    /// Whether the summary was asked for them.
    learned: bool,
    /// Where the part of the file begins that is not read to its end.
    pub tail: Option<usize>,
    /// Whether there are messages outside of chunks.
    pub loose: bool,
    /// A recovery's note.
    noted: Option<Pairs>,
}

impl<'a> Pass<'a> {
    pub fn new(head: &'a Head, depth: Depth) -> Self {
        let first_gap = head.gaps().first().map(|gap| gap.messages);
        Self {
            head,
            depth,
            first_gap,
            state: State::default(),
            pieces: Vec::new(),
            declared: Vec::new(),
            learned: false,
            tail: None,
            loose: false,
            noted: None,
        }
    }

    /// Goes over everything; gives how the file ends, by its first fault where it has one.
    pub fn run(&mut self, walk: &mut Walk<'_>) -> Ending {
        let mut first: Option<(usize, Stop)> = None;
        let mut budget = salvage::Budget::new(walk);
        loop {
            match self.record(walk) {
                Ok(true) => {}
                Ok(false) => break,
                Err(stop) => {
                    let at = walk.at;
                    first.get_or_insert((at, stop));
                    if self.depth == Depth::Salvage && self.resume(walk, &mut budget) {
                        continue;
                    }
                    self.tail = Some(at);
                    break;
                }
            }
        }
        let ended = match self.tail {
            Some(_) => Ok(()),
            None => self.summary(walk),
        };
        if let Err(stop) = ended {
            self.tail = Some(walk.at);
            first.get_or_insert((walk.at, stop));
        }
        self.close_at_end();
        match first {
            Some((at, Stop::Torn(why))) => Ending::CutOff {
                at_byte: at as u64,
                why: why.to_owned(),
            },
            Some((at, Stop::Damaged(why))) => Ending::Damaged {
                at_byte: at as u64,
                why,
            },
            None => self.proper_end(),
        }
    }

    /// Takes in the next record of the data; `false` at their end.
    fn record(&mut self, walk: &mut Walk<'_>) -> Result<bool, Stop> {
        let record = walk.peek()?;
        let first = walk.at == mcap::MAGIC.len();
        match record.opcode {
            op::CHUNK => match self.piece(walk.at..walk.at + record.whole.len(), record.whole) {
                Ok(()) => {}
                // The exact record behind it is as good as it was.
                Err(_) if self.is_for_viewers(walk, &record) => {
                    self.state.facts.damaged_views += 1;
                }
                Err(why) => return Err(Stop::Damaged(why)),
            },
            op::SCHEMA | op::CHANNEL | op::MESSAGE => {
                self.loose(walk)?;
                return Ok(true);
            }
            op::DATA_END => {
                walk.pass(&record);
                return Ok(false);
            }
            op::HEADER if first => {}
            op::METADATA | op::ATTACHMENT if self.head.placed.contains(&walk.at) => {}
            op::METADATA => self.note(&record)?,
            op::ATTACHMENT => {
                let name = walk::attachment(record.body).map_or("", |(name, _)| name);
                return Err(Stop::Damaged(format!(
                    "there is an attachment `{}` behind the header, expected none there",
                    name.escape_debug()
                )));
            }
            op::MESSAGE_INDEX => {}
            opcode if opcode >= 0x80 => {}
            opcode => {
                return Err(Stop::Damaged(format!(
                    "a record of kind {opcode} is out of place"
                )));
            }
        }
        walk.pass(&record);
        Ok(true)
    }

    /// Goes over what follows the data.
    fn summary(&mut self, walk: &mut Walk<'_>) -> Result<(), Stop> {
        loop {
            let record = walk.peek()?;
            let last = record.opcode == op::FOOTER;
            if !(last || record.opcode == op::DATA_END || walk::is_summary(record.opcode)) {
                return Err(Stop::Damaged("the summary is damaged".to_owned()));
            }
            self.said_again(&record)?;
            walk.pass(&record);
            if last {
                walk.end()?;
                break;
            }
        }
        let note = self.noted.as_ref();
        if let Some(list) = note.and_then(|note| note.get(recover::GAPS)) {
            let gaps = Gap::parse(list);
            let fits = |gap: &Gap| gap.messages <= self.state.messages;
            if !gaps.is_some_and(|gaps| gaps.iter().all(fits)) {
                return Err(Stop::Damaged(format!(
                    "metadata `{}` lists gaps that the recording cannot have",
                    recover::METADATA
                )));
            }
        }
        if self.state.facts.end.is_none() && note.is_none() {
            return Err(Stop::Damaged(
                "the file is complete, but the station's last statement is missing".to_owned(),
            ));
        }
        Ok(())
    }

    /// How a file without a fault ends.
    fn proper_end(&self) -> Ending {
        match (self.state.facts.end, &self.noted) {
            (Some(_), _) if self.head.gaps().is_empty() => Ending::Finished,
            (_, noted) => {
                let said = |key| {
                    let pairs = noted.as_ref();
                    pairs
                        .and_then(|pairs| pairs.get(key).cloned())
                        .unwrap_or_default()
                };
                Ending::Recovered {
                    was: said(recover::WAS),
                    missing: said(recover::MISSING),
                }
            }
        }
    }

    /// Takes in what the summary says again of schemas and channels, which is where other readers look first.
    fn said_again(&mut self, record: &Framed<'_>) -> Result<(), Stop> {
        let damaged = || Stop::Damaged("the summary is damaged".to_owned());
        let state = &mut self.state;
        match record.opcode {
            op::SCHEMA => {
                let (id, name, encoding, data) = walk::schema(record.body).ok_or_else(damaged)?;
                state.viewed.schema(id, name, encoding, data);
            }
            op::CHANNEL => {
                let (id, schema, name, encoding) =
                    walk::channel(record.body).ok_or_else(damaged)?;
                let topic = Topic::from_name(name);
                let before = state.topics.get(&id).map(|of| of.map(|(topic, _)| topic));
                state
                    .viewed
                    .declared_twice(before.is_some_and(|before| before != topic));
                if topic.is_none() {
                    state.viewed.channel(id, schema, name, encoding);
                }
            }
            _ => {}
        }
        Ok(())
    }

    /// Keeps what a recovery says of itself: once, and nothing else is said behind the header.
    fn note(&mut self, record: &Framed<'_>) -> Result<(), Stop> {
        let damaged = |what: String| Err(Stop::Damaged(what));
        let Some((name, pairs)) = walk::metadata(record.body) else {
            return damaged("metadata behind the header is not whole".to_owned());
        };
        if name == METADATA {
            return damaged("there is a second header".to_owned());
        }
        if name != recover::METADATA {
            return damaged(format!(
                "there is metadata `{}` behind the header, expected none but `{}`",
                name.escape_debug(),
                recover::METADATA
            ));
        }
        if self.noted.replace(pairs).is_some() {
            return damaged(format!("there is metadata `{name}` twice"));
        }
        Ok(())
    }

    /// Whether the chunk `record`, which cannot be unpacked, has messages of viewers' channels alone by the indexes behind it.
    /// (Should they lie, exact messages are missing, and the chain shows it.)
    fn is_for_viewers(&self, walk: &Walk<'_>, record: &Framed<'_>) -> bool {
        let mut ahead = walk.clone();
        ahead.pass(record);
        let mut channels = 0;
        while let Ok(index) = ahead.peek() {
            if index.opcode != op::MESSAGE_INDEX {
                break;
            }
            let id = Cut(index.body).u16();
            if id.and_then(|id| self.state.topics.get(&id)) != Some(&None) {
                return false;
            }
            channels += 1;
            ahead.pass(&index);
        }
        channels > 0
    }

    /// Takes in records outside of any chunk and goes past them: as many as make a piece, fewer where one of them cannot be taken.
    fn loose(&mut self, walk: &mut Walk<'_>) -> Result<(), Stop> {
        let begin = walk.at;
        let mut ends = Vec::new();
        let mut ahead = walk.clone();
        while let Ok(record) = ahead.peek()
            && matches!(record.opcode, op::SCHEMA | op::CHANNEL | op::MESSAGE)
            && (ends.is_empty() || ahead.at - begin < LOOSE_BYTES)
        {
            self.loose |= record.opcode == op::MESSAGE;
            ahead.pass(&record);
            ends.push(ahead.at);
        }
        loop {
            let end = ends.last().copied().unwrap_or(begin);
            match self.piece(begin..end, walk.between(begin, end)) {
                Ok(()) => {
                    walk.at = end;
                    return Ok(());
                }
                Err(why) if ends.len() <= 1 => return Err(Stop::Damaged(why)),
                Err(_) => ends.truncate(ends.len() / 2),
            }
        }
    }

    /// Takes in a piece wholly or not at all.
    fn piece(&mut self, range: Range<usize>, whole: &[u8]) -> Result<(), String> {
        let mut next = self.state.clone();
        let messages = unpack(whole, &mut next.topics, Some(&mut next.viewed))?;
        for message in &messages {
            self.take(message, &mut next)?;
        }
        self.state = next;
        // Pieces without messages of ours too: they may declare channels.
        self.pieces.push(range);
        Ok(())
    }

    fn take(&self, message: &Message, state: &mut State) -> Result<(), String> {
        if state.facts.end.is_some() {
            return Err("something follows the station's last statement".to_owned());
        }
        let salvages = self.depth == Depth::Salvage;
        if salvages {
            salvage::close(message, state);
        }
        state.messages += 1;
        let facts = &mut state.facts;
        match message {
            Message::Row(row) => {
                let behind_gap = match self.first_gap {
                    _ if salvages => !state.gaps.is_empty(),
                    before => before.is_some_and(|before| before < state.messages),
                };
                if facts.snapshots == 0 && !behind_gap {
                    return Err("the first row comes before the first snapshot".to_owned());
                }
                if row.tick <= state.tick {
                    return Err(format!("tick {} comes after tick {}", row.tick, state.tick));
                }
                state.tick = row.tick;
                facts.rows += 1;
                facts.ticks = Some((facts.ticks.map_or(row.tick, |t| t.0), row.tick));
                let time = row.time_unix_ns;
                facts.times_unix_ns = Some((facts.times_unix_ns.map_or(time, |t| t.0), time));
            }
            Message::Snapshot { tick: of, .. } => {
                if *of < state.tick {
                    return Err(format!(
                        "a snapshot of tick {of} comes after tick {}",
                        state.tick
                    ));
                }
                state.tick = *of;
                facts.snapshots += 1;
            }
            Message::Signed(signed) => {
                facts.signatures += 1;
                facts.end = signed.statement.end;
            }
            Message::Event(event) => match Sum::parse(&event.text) {
                Some(sum) => facts.viewers = Some(sum),
                None => facts.events += 1,
            },
        }
        Ok(())
    }

    /// Learns of channels that no chunk before the damage has declared from the summary, where the file has one.
    pub(super) fn learn_from_summary(&mut self, walk: &Walk<'_>) {
        if std::mem::replace(&mut self.learned, true) {
            return;
        }
        let declarations = walk.summary_declarations();
        let (channels, schemas): (Vec<_>, Vec<_>) = declarations
            .into_iter()
            .partition(|(_, record)| record.opcode == op::CHANNEL);
        let topics = &mut self.state.topics;
        let learned: Vec<Range<usize>> = channels
            .into_iter()
            .filter(|(_, record)| {
                walk::channel(record.body).is_some_and(|(id, ..)| !topics.contains_key(&id))
                    && declare(record.body, topics).is_ok()
            })
            .map(|(range, _)| range)
            .collect();
        if !learned.is_empty() {
            self.declared = schemas.into_iter().map(|(range, _)| range).collect();
            self.declared.extend(learned);
        }
    }
}
