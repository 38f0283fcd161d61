//! Pass over all records of a file.

use std::ops::Range;

use mcap::records::op;

use super::head::Head;
use super::salvage;
use super::state::{Depth, State};
use crate::record::bytes::Cut;
use crate::record::gap::Gap;
use crate::record::header::METADATA;
use crate::record::message::Topic;
use crate::record::note;
use crate::record::note::Note;
use crate::record::policy::ViewersPolicy;
use crate::record::read::Ending;
use crate::record::unpack::{declare, unpack};
use crate::record::walk;
use crate::record::walk::{Framed, Stop, Walk};

/// Approximate size of a piece of records outside of chunks, bytes.
const LOOSE_BYTES: usize = 256 << 10;

/// State of a pass over a file.
pub(super) struct Pass<'a> {
    head: &'a Head,
    depth: Depth,
    /// Number of exact messages before the first gap of a former recovery. Behind the gap rows may precede any
    /// snapshot.
    first_gap: Option<u64>,
    pub state: State,
    pub pieces: Vec<Range<usize>>,
    /// Schemas and channels that only the summary contains.
    pub declared: Vec<Range<usize>>,
    /// Whether the summary was searched for channels.
    learned: bool,
    /// First byte of the part that is not read.
    pub tail: Option<usize>,
    /// Whether there are messages outside of chunks.
    loose: bool,
    /// Note of a recovery.
    noted: Option<Note>,
}

impl<'a> Pass<'a> {
    pub fn new(head: &'a Head, depth: Depth, policy: ViewersPolicy) -> Self {
        let first_gap = head.gaps().first().map(|gap| gap.messages);
        Self {
            head,
            depth,
            first_gap,
            state: State::by(policy),
            pieces: Vec::new(),
            declared: Vec::new(),
            learned: false,
            tail: None,
            loose: false,
            noted: None,
        }
    }

    /// Walks over the whole file; its ending, by the first fault if there is one.
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
        self.state.close_at_end();
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

    /// Moves to the next whole chunk behind damage and notes the gap; `false` if there is none.
    fn resume(&mut self, walk: &mut Walk<'_>, budget: &mut salvage::Budget) -> bool {
        self.learn_from_summary(walk);
        let Some(at) = salvage::next_whole(walk, &self.state, self.loose, budget) else {
            return false;
        };
        self.state.open_gap(walk.at, at);
        walk.at = at;
        true
    }

    /// Reads the next record of the data; `false` at the end of the data.
    fn record(&mut self, walk: &mut Walk<'_>) -> Result<bool, Stop> {
        let record = walk.peek()?;
        let first = walk.at == mcap::MAGIC.len();
        match record.opcode {
            op::CHUNK => match self.piece(walk.at..walk.at + record.whole.len(), record.whole) {
                Ok(()) => {}
                // The damage does not concern the exact record.
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
                    "a record of opcode {opcode} is out of place"
                )));
            }
        }
        walk.pass(&record);
        Ok(true)
    }

    /// Reads the part behind the data.
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
        if let Some(note) = &self.noted {
            let fits = |gap: &Gap| gap.messages <= self.state.messages;
            if !note.gaps().is_some_and(|gaps| gaps.iter().all(fits)) {
                return Err(Stop::Damaged(format!(
                    "metadata `{}` lists gaps that the recording cannot have",
                    note::METADATA
                )));
            }
        } else if self.state.facts.end.is_none() {
            return Err(Stop::Damaged(
                "the file is complete, but the station's last statement is missing".to_owned(),
            ));
        }
        Ok(())
    }

    /// Ending of a file without a fault.
    fn proper_end(&self) -> Ending {
        match (self.state.facts.end, &self.noted) {
            (Some(_), _) if self.head.gaps().is_empty() => Ending::Finished,
            (_, noted) => Ending::Recovered {
                was: noted.as_ref().map(Note::was).unwrap_or_default(),
                missing: noted.as_ref().map(Note::missing).unwrap_or_default(),
            },
        }
    }

    /// Reads the schemas and channels in the summary, because other readers look there first.
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

    /// Reads the note of a recovery. It occurs once, and no other metadata is allowed behind the header.
    fn note(&mut self, record: &Framed<'_>) -> Result<(), Stop> {
        let damaged = |what: String| Err(Stop::Damaged(what));
        let Some((name, pairs)) = walk::metadata(record.body) else {
            return damaged("metadata behind the header are incomplete".to_owned());
        };
        if name == METADATA {
            return damaged("there is a second header".to_owned());
        }
        if name != note::METADATA {
            return damaged(format!(
                "there is metadata `{}` behind the header, expected none but `{}`",
                name.escape_debug(),
                note::METADATA
            ));
        }
        if self.noted.replace(Note(pairs)).is_some() {
            return damaged(format!("there is metadata `{name}` twice"));
        }
        Ok(())
    }

    /// Whether the damaged chunk `record` has only messages for viewers, by the indexes behind it. If an index is
    /// wrong, exact messages are missing, and the chain shows that.
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

    /// Reads records outside of chunks: as many as fill a piece, or fewer before an invalid record.
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

    /// Reads a piece, as a whole or not at all.
    fn piece(&mut self, range: Range<usize>, whole: &[u8]) -> Result<(), String> {
        let mut next = self.state.clone();
        let messages = unpack(whole, &mut next.topics, Some(&mut next.viewed))?;
        for message in &messages {
            next.take(message, self.depth, self.first_gap)?;
        }
        self.state = next;
        // Pieces without exact messages count, too, because they may declare channels.
        self.pieces.push(range);
        Ok(())
    }

    /// Adds channels from the summary that no chunk before the damage has declared.
    fn learn_from_summary(&mut self, walk: &Walk<'_>) {
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
