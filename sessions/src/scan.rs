//! The first pass over a recording: header, then every chunk once, then how it ends.

use std::collections::BTreeMap;
use std::ops::Range;

use mcap::records::op;

use crate::format::{self, Migration};
use crate::header::{self, METADATA, SCENE, SessionHeader, TEXTS};
use crate::key::PublicKey;
use crate::message::{Message, Topic};
use crate::read::{Bytes, Ending, Facts, ReadError, Recording};
use crate::recover;
use crate::viewers::{Sum, Summing, Viewers};
use crate::walk::{self, Framed, Stop, Walk};

/// Which channel is which topic; `None` for those of viewers.
pub(crate) type Topics = BTreeMap<u16, Option<Topic>>;

/// Reads and checks everything once.
pub(crate) fn scan(bytes: Bytes) -> Result<Recording, ReadError> {
    let mut walk = Walk::new(&bytes).ok_or(ReadError::NotMcap)?;
    let pairs_and_files = read_header(&mut walk)?;
    let (migration, header, signer, header_digest) = check_header(pairs_and_files)?;
    let mut pass = Pass::default();
    let ending = match pass.run(&mut walk) {
        Ok(ending) => ending,
        Err(Stop::Torn(why)) => Ending::CutOff {
            at_byte: walk.at as u64,
            why: why.to_owned(),
        },
        Err(Stop::Damaged(why)) => Ending::Damaged {
            at_byte: walk.at as u64,
            why,
        },
    };
    if pass.facts.rows == 0 {
        return Err(ReadError::NoRows {
            ending: ending.to_string(),
        });
    }
    let Pass {
        chunks,
        facts,
        viewed,
        ..
    } = pass;
    let viewers = Viewers::of(facts.viewers.as_ref(), &viewed.sum());
    Ok(Recording {
        bytes,
        header,
        header_digest,
        migration,
        signer,
        chunks,
        facts,
        viewers,
        ending,
    })
}

type Pairs = BTreeMap<String, String>;
type Files = BTreeMap<String, Vec<u8>>;

/// Everything up to the metadata, which comes after the attachments and before any data.
fn read_header(walk: &mut Walk<'_>) -> Result<(Pairs, Files), ReadError> {
    let mut files = Files::new();
    let mut ours = false;
    loop {
        let record = match walk.peek() {
            Ok(record) => record,
            Err(Stop::Torn(_)) if ours => {
                return Err(ReadError::HeaderCut { at: walk.at as u64 });
            }
            Err(Stop::Torn(_)) if walk.at == mcap::MAGIC.len() => {
                return Err(ReadError::HeaderCut { at: walk.at as u64 });
            }
            Err(Stop::Damaged(what)) if ours => return Err(ReadError::Header { what }),
            Err(_) => return Err(ReadError::NotSulcus),
        };
        let bad = |what: &str| ReadError::Header {
            what: what.to_owned(),
        };
        match record.opcode {
            op::HEADER => {
                let mut cut = crate::bytes::Cut(record.body);
                let _profile = cut.string();
                ours = cut.string().is_some_and(|by| by.starts_with("sulcus"));
            }
            op::ATTACHMENT => {
                let (name, data) = walk::attachment(record.body)
                    .ok_or_else(|| bad("an attachment is not whole"))?;
                // What nobody asks for is signed by nobody either, and others show it.
                if name != SCENE && !TEXTS.contains(&name) {
                    return Err(bad(&format!(
                        "there is an attachment `{}`, expected `{SCENE}`, `{}` alone",
                        name.escape_debug(),
                        TEXTS.join("`, `")
                    )));
                }
                if files.insert(name.to_owned(), data.to_vec()).is_some() {
                    return Err(bad(&format!("there are two attachments `{name}`")));
                }
            }
            op::METADATA => {
                let (name, pairs) =
                    walk::metadata(record.body).ok_or_else(|| bad("metadata is not whole"))?;
                if name != METADATA {
                    return Err(bad(&format!(
                        "there is metadata `{}`, expected `{METADATA}` alone",
                        name.escape_debug()
                    )));
                }
                walk.pass(&record);
                return Ok((pairs, files));
            }
            _ => return Err(ReadError::NotSulcus),
        }
        walk.pass(&record);
    }
}

fn check_header(
    (pairs, files): (Pairs, Files),
) -> Result<(Option<Migration>, SessionHeader, PublicKey, [u8; 32]), ReadError> {
    let found = pairs.get("format_version").cloned().unwrap_or_default();
    let migration = format::reads(&found).map_err(|advice| ReadError::Version {
        advice,
        found: found.escape_debug().to_string(),
        expected: format::readable(),
    })?;
    for name in [SCENE].into_iter().chain(TEXTS) {
        let data = files.get(name).map_or(&[][..], Vec::as_slice);
        let hash = blake3::hash(data).to_hex();
        if pairs.get(&header::hash_key(name)).map(String::as_str) != Some(hash.as_str()) {
            return Err(ReadError::Header {
                what: format!("attachment `{name}` does not match the hash that the header gives"),
            });
        }
    }
    let digest = header::digest(&pairs);
    let (header, signer) =
        SessionHeader::from_metadata(&pairs, &files).map_err(|key| ReadError::Header {
            what: format!("field `{key}` is missing or not of its kind"),
        })?;
    Ok((migration, header, signer, digest))
}

/// The pass over everything after the header.
#[derive(Default)]
struct Pass {
    topics: Topics,
    chunks: Vec<Range<usize>>,
    facts: Facts,
    viewed: Summing,
    /// Tick of the last row or snapshot.
    tick: u64,
    /// What a recovery says of itself.
    recovered: Option<Pairs>,
}

impl Pass {
    fn run(&mut self, walk: &mut Walk<'_>) -> Result<Ending, Stop> {
        loop {
            let record = walk.peek()?;
            match record.opcode {
                op::CHUNK => match self.chunk(&record, walk.at) {
                    Ok(()) => {}
                    // The exact record behind it is as good as it was.
                    Err(_) if self.is_for_viewers(walk, &record) => self.facts.damaged_views += 1,
                    Err(why) => return Err(Stop::Damaged(why)),
                },
                op::DATA_END => break,
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
        }
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
        match (self.facts.end, &self.recovered) {
            (Some(_), _) => Ok(Ending::Finished),
            (None, Some(pairs)) => {
                let said = |key| pairs.get(key).cloned().unwrap_or_default();
                Ok(Ending::Recovered {
                    was: said(recover::WAS),
                    missing: said(recover::MISSING),
                })
            }
            (None, None) => Err(Stop::Damaged(
                "the file is complete, but the station's last statement is missing".to_owned(),
            )),
        }
    }

    /// Takes in what the summary says again of schemas and channels, which is where other readers look first.
    fn said_again(&mut self, record: &Framed<'_>) -> Result<(), Stop> {
        let damaged = || Stop::Damaged("the summary is damaged".to_owned());
        match record.opcode {
            op::SCHEMA => {
                let (id, name, encoding, data) = walk::schema(record.body).ok_or_else(damaged)?;
                self.viewed.schema(id, name, encoding, data);
            }
            op::CHANNEL => {
                let (id, schema, name, encoding) =
                    walk::channel(record.body).ok_or_else(damaged)?;
                let topic = Topic::from_name(name);
                let before = self.topics.get(&id).copied();
                self.viewed
                    .declared_twice(before.is_some_and(|before| before != topic));
                if topic.is_none() {
                    self.viewed.channel(id, schema, name, encoding);
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
        if self.recovered.replace(pairs).is_some() {
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
            let id = crate::bytes::Cut(index.body).u16();
            if id.and_then(|id| self.topics.get(&id)) != Some(&None) {
                return false;
            }
            channels += 1;
            ahead.pass(&index);
        }
        channels > 0
    }

    /// Takes in a chunk wholly or not at all.
    fn chunk(&mut self, record: &Framed<'_>, at: usize) -> Result<(), String> {
        let mut topics = self.topics.clone();
        let mut facts = self.facts.clone();
        let mut viewed = self.viewed.clone();
        let mut tick = self.tick;
        let messages = unpack(record, &mut topics, Some(&mut viewed))?;
        for message in &messages {
            count(message, &mut facts, &mut tick)?;
        }
        (self.topics, self.facts, self.tick) = (topics, facts, tick);
        self.viewed = viewed;
        // Chunks without messages of ours too: they may declare channels.
        self.chunks.push(at..at + record.whole.len());
        Ok(())
    }
}

fn count(message: &Message, facts: &mut Facts, tick: &mut u64) -> Result<(), String> {
    if facts.end.is_some() {
        return Err("something follows the station's last statement".to_owned());
    }
    match message {
        Message::Row(row) => {
            if facts.snapshots == 0 {
                return Err("the first row comes before the first snapshot".to_owned());
            }
            if row.tick <= *tick {
                return Err(format!("tick {} comes after tick {tick}", row.tick));
            }
            *tick = row.tick;
            facts.rows += 1;
            facts.ticks = Some((facts.ticks.map_or(row.tick, |t| t.0), row.tick));
            let time = row.time_unix_ns;
            facts.times_unix_ns = Some((facts.times_unix_ns.map_or(time, |t| t.0), time));
        }
        Message::Snapshot { tick: of, .. } => {
            if of < tick {
                return Err(format!("a snapshot of tick {of} comes after tick {tick}"));
            }
            *tick = *of;
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

/// The messages of a chunk; learns of the channels that are declared in it, and sums up what is for viewers.
fn unpack(
    chunk: &Framed<'_>,
    topics: &mut Topics,
    mut viewed: Option<&mut Summing>,
) -> Result<Vec<Message>, String> {
    let mut messages = Vec::new();
    walk::unpack(chunk, |opcode, body| {
        match opcode {
            op::SCHEMA => {
                let (id, name, encoding, data) =
                    walk::schema(body).ok_or("a schema's record is not whole")?;
                if let Some(viewed) = &mut viewed {
                    viewed.schema(id, name, encoding, data);
                }
            }
            op::CHANNEL => {
                let (id, schema, name, encoding) =
                    walk::channel(body).ok_or("a channel's record is not whole")?;
                let topic = Topic::from_name(name);
                if topic.is_some_and(|topic| topic.encoding() != encoding) {
                    return Err(format!(
                        "channel {name} has another encoding than this version's"
                    ));
                }
                if topics
                    .insert(id, topic)
                    .is_some_and(|before| before != topic)
                {
                    return Err(format!("channel {id} is declared twice"));
                }
                if let Some(viewed) = viewed.as_mut().filter(|_| topic.is_none()) {
                    viewed.channel(id, schema, name, encoding);
                }
            }
            op::MESSAGE => {
                let (id, times, bytes) =
                    walk::message(body).ok_or("a message's record is not whole")?;
                let topic = topics
                    .get(&id)
                    .ok_or_else(|| format!("a message names channel {id}, which does not exist"))?;
                if let Some(topic) = *topic {
                    let message = Message::decode(topic, bytes)
                        .ok_or_else(|| format!("a message of {} makes no sense", topic.name()))?;
                    if matches!(&message, Message::Row(row) if row.time_unix_ns != times[0]) {
                        return Err("a row's time is not its message's".to_owned());
                    }
                    messages.push(message);
                } else if let Some(viewed) = &mut viewed {
                    viewed.message(id, times, bytes);
                }
            }
            _ => {}
        }
        Ok(())
    })?;
    Ok(messages)
}

/// The messages of the chunk at `range`, which a scan found good.
pub(crate) fn unpack_at(
    bytes: &[u8],
    range: Range<usize>,
    topics: &mut Topics,
) -> Result<Vec<Message>, String> {
    let whole = bytes.get(range).ok_or("it became shorter")?;
    let (Some(opcode), Some(body)) = (whole.first(), whole.get(9..)) else {
        return Err("it became shorter".to_owned());
    };
    let chunk = Framed {
        opcode: *opcode,
        body,
        whole,
    };
    unpack(&chunk, topics, None)
}
