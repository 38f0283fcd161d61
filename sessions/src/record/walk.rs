//! Walking over the records of an MCAP file whose bytes may be anything.
//!
//! The mcap crate reads well-formed files; a recording may be torn by a crash or altered on
//! purpose. So framing is checked here, record by record, with every length bounded, and the mcap
//! crate only unpacks chunks whose header was found sane.

use std::ops::Range;

use mcap::records::op;
use mcap::sans_io::{LinearReadEvent, LinearReader, LinearReaderOptions};

use crate::record::bytes::Cut;

/// Largest chunk that is unpacked, bytes. Ours are 256 KiB and one message.
const MAX_CHUNK: u64 = 64 << 20;
/// Compressions of chunks, and what each cannot pack better than: lz4 by its lengths of a byte, zstd by a block of
/// 128 KiB that is one byte repeated. The recorder packs with zstd, at first it did with lz4; a tool may leave chunks unpacked.
const MAX_RATIOS: [(&str, u64); 3] = [("zstd", 1 << 15), ("lz4", 256), ("", 1)];
/// Opcode and length of a record.
const FRAME: usize = 9;

/// Why reading ended, other than at the proper end.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Stop {
    /// The bytes end in the middle of something.
    Torn(&'static str),
    /// The bytes are there, and are wrong.
    Damaged(String),
}

/// A record in its frame.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Framed<'a> {
    pub opcode: u8,
    pub body: &'a [u8],
    /// Opcode, length and body.
    pub whole: &'a [u8],
}

/// Position in a file, always at the end of a whole record.
#[derive(Clone)]
pub(crate) struct Walk<'a> {
    bytes: &'a [u8],
    pub at: usize,
}

impl<'a> Walk<'a> {
    /// After the magic; `None` when the file does not begin with it.
    pub fn new(bytes: &'a [u8]) -> Option<Self> {
        bytes.starts_with(mcap::MAGIC).then_some(Self {
            bytes,
            at: mcap::MAGIC.len(),
        })
    }

    /// The record at the present position, which stays.
    pub fn peek(&self) -> Result<Framed<'a>, Stop> {
        let rest = &self.bytes[self.at..];
        if rest.is_empty() {
            return Err(Stop::Torn("there is no end record"));
        }
        let mut cut = Cut(rest);
        let (Some(opcode), Some(length)) = (cut.u8(), cut.u64()) else {
            return Err(Stop::Torn("the last record is not whole"));
        };
        if opcode == 0 {
            // A disk may leave zeros where the last write was lost.
            return Err(if rest.iter().all(|byte| *byte == 0) {
                Stop::Torn("zeros follow")
            } else {
                Stop::Damaged("a record has no kind".to_owned())
            });
        }
        let Some(body) = usize::try_from(length).ok().and_then(|n| cut.take(n)) else {
            return Err(Stop::Torn("the last record is not whole"));
        };
        Ok(Framed {
            opcode,
            body,
            whole: &rest[..FRAME + body.len()],
        })
    }

    /// As [`Walk::peek`], at another position.
    pub fn peek_at(&self, at: usize) -> Result<Framed<'a>, Stop> {
        Self {
            bytes: self.bytes,
            at,
        }
        .peek()
    }

    /// The byte at a position, which is the kind of a record where one begins there.
    pub fn opcode_at(&self, at: usize) -> Option<u8> {
        self.bytes.get(at).copied()
    }

    /// The bytes between two positions that were walked over.
    pub fn between(&self, begin: usize, end: usize) -> &'a [u8] {
        self.bytes.get(begin..end).unwrap_or_default()
    }

    /// Length of the file.
    pub fn length(&self) -> usize {
        self.bytes.len()
    }

    /// Schemas and channels that the summary repeats, with their place; empty where the file has no whole summary.
    pub fn summary_declarations(&self) -> Vec<(Range<usize>, Framed<'a>)> {
        const FOOTER: usize = FRAME + 8 + 8 + 4;
        let mut found = Vec::new();
        let at_footer = self.bytes.strip_suffix(mcap::MAGIC);
        let Some(footer) = at_footer.and_then(|rest| rest.len().checked_sub(FOOTER)) else {
            return found;
        };
        let begins = match self.peek_at(footer) {
            Ok(record) if record.opcode == op::FOOTER => Cut(record.body).u64(),
            _ => None,
        };
        let Some(begins) = begins.and_then(|at| usize::try_from(at).ok()) else {
            return found;
        };
        let mut walk = self.clone();
        walk.at = begins;
        while walk.at >= mcap::MAGIC.len() && walk.at < footer {
            let Ok(record) = walk.peek() else { break };
            let begin = walk.at;
            walk.pass(&record);
            if matches!(record.opcode, op::SCHEMA | op::CHANNEL) {
                found.push((begin..walk.at, record));
            }
        }
        found
    }

    /// Goes past a record that [`Walk::peek`] gave.
    pub fn pass(&mut self, record: &Framed<'_>) {
        self.at += record.whole.len();
    }

    /// Checks what follows the footer, which must be the magic and nothing else.
    pub fn end(&self) -> Result<(), Stop> {
        let rest = &self.bytes[self.at..];
        if rest == mcap::MAGIC {
            Ok(())
        } else if mcap::MAGIC.starts_with(rest) {
            Err(Stop::Torn("the end is not whole"))
        } else {
            Err(Stop::Damaged("something follows the footer".to_owned()))
        }
    }
}

/// Gives each record of a piece of a file to `visit`: those in a chunk, or those that stand one after another outside of any.
pub(crate) fn visit(
    piece: &[u8],
    mut visit: impl FnMut(u8, &[u8]) -> Result<(), String>,
) -> Result<(), String> {
    let mut walk = Walk {
        bytes: piece,
        at: 0,
    };
    while walk.at < piece.len() {
        let record = walk.peek().map_err(|stop| match stop {
            Stop::Torn(why) => why.to_owned(),
            Stop::Damaged(why) => why,
        })?;
        if record.opcode == op::CHUNK {
            unpack(&record, &mut visit)?;
        } else {
            visit(record.opcode, record.body)?;
        }
        walk.pass(&record);
    }
    Ok(())
}

/// Unpacks a chunk, checks its CRC, then gives each record in it to `visit`.
pub(crate) fn unpack(
    chunk: &Framed<'_>,
    mut visit: impl FnMut(u8, &[u8]) -> Result<(), String>,
) -> Result<(), String> {
    check_chunk(chunk.body)?;
    let limit = usize::try_from(MAX_CHUNK).unwrap_or(usize::MAX);
    let mut reader = LinearReader::new_with_options(
        LinearReaderOptions::default()
            .with_skip_start_magic(true)
            .with_skip_end_magic(true)
            .with_prevalidate_chunk_crcs(true)
            .with_record_length_limit(limit),
    );
    let mut rest = chunk.whole;
    while let Some(event) = reader.next_event() {
        match event.map_err(|error| error.to_string())? {
            LinearReadEvent::ReadRequest(wanted) => {
                let (head, tail) = rest.split_at(wanted.min(rest.len()));
                reader.insert(head.len()).copy_from_slice(head);
                reader.notify_read(head.len());
                rest = tail;
            }
            LinearReadEvent::Record { opcode, data } => visit(opcode, data)?,
        }
    }
    Ok(())
}

/// Whether what there is of a chunk begins as ours do, though the rest may be torn or wrong.
pub(crate) fn is_chunk_header(body: &[u8]) -> bool {
    let mut cut = Cut(body);
    // Times, unpacked length, CRC.
    let packed_with = cut.take(16 + 8 + 4).and_then(|_| cut.string());
    MAX_RATIOS
        .iter()
        .any(|(name, _)| packed_with == Some(*name))
}

/// Bytes that unpacking a chunk with this body reads and writes; `None` where it is no chunk that would be unpacked.
pub(crate) fn chunk_cost(body: &[u8]) -> Option<usize> {
    let unpacked = check_chunk(body).ok()?;
    usize::try_from(unpacked).ok()?.checked_add(body.len())
}

/// Bounds what the chunk's header claims, before anything is allocated for it; gives its unpacked length.
fn check_chunk(body: &[u8]) -> Result<u64, String> {
    let parse = || {
        let mut cut = Cut(body);
        let _times = cut.take(16)?;
        let unpacked = cut.u64()?;
        let _crc = cut.u32()?;
        let compression = cut.string()?;
        Some((unpacked, compression, cut.u64()?, cut.0.len() as u64))
    };
    let Some((unpacked, compression, packed, there)) = parse() else {
        return Err("a chunk's header is not whole".to_owned());
    };
    let known = MAX_RATIOS
        .into_iter()
        .find(|(name, _)| *name == compression);
    let Some((_, max_ratio)) = known else {
        return Err(format!(
            "a chunk is packed with `{}`, expected `zstd`, `lz4` or no compression",
            compression.escape_debug()
        ));
    };
    if packed != there {
        return Err(format!("a chunk claims {packed} bytes and has {there}"));
    }
    if unpacked > MAX_CHUNK {
        return Err(format!(
            "a chunk claims to unpack to {unpacked} bytes, expected at most {MAX_CHUNK}: write the file anew with smaller chunks"
        ));
    }
    if unpacked > packed.saturating_add(64).saturating_mul(max_ratio) {
        return Err(format!("a chunk claims to unpack to {unpacked} bytes"));
    }
    Ok(unpacked)
}

/// The message of a message record: channel, times (of the log, of publication), and bytes.
pub(crate) fn message(body: &[u8]) -> Option<(u16, [u64; 2], &[u8])> {
    let mut cut = Cut(body);
    let channel = cut.u16()?;
    let _sequence = cut.u32()?;
    Some((channel, [cut.u64()?, cut.u64()?], cut.0))
}

/// Id, schema's id, topic and encoding of a channel record.
pub(crate) fn channel(body: &[u8]) -> Option<(u16, u16, &str, &str)> {
    let mut cut = Cut(body);
    Some((cut.u16()?, cut.u16()?, cut.string()?, cut.string()?))
}

/// Id, name, encoding and data of a schema record.
pub(crate) fn schema(body: &[u8]) -> Option<(u16, &str, &str, &[u8])> {
    let mut cut = Cut(body);
    let (id, name, encoding) = (cut.u16()?, cut.string()?, cut.string()?);
    let length = usize::try_from(cut.u32()?).ok()?;
    Some((id, name, encoding, cut.take(length)?))
}

/// Name and data of an attachment record.
pub(crate) fn attachment(body: &[u8]) -> Option<(&str, &[u8])> {
    let mut cut = Cut(body);
    let _times = cut.take(16)?;
    let name = cut.string()?;
    let _media_type = cut.string()?;
    let length = usize::try_from(cut.u64()?).ok()?;
    Some((name, cut.take(length)?))
}

/// Name and pairs of a metadata record; `None` also when a key comes twice.
pub(crate) fn metadata(body: &[u8]) -> Option<(&str, std::collections::BTreeMap<String, String>)> {
    let mut cut = Cut(body);
    let name = cut.string()?;
    let length = usize::try_from(cut.u32()?).ok()?;
    let mut map = Cut(cut.take(length)?);
    let mut pairs = std::collections::BTreeMap::new();
    while !map.0.is_empty() {
        let (key, value) = (map.string()?, map.string()?);
        if pairs.insert(key.to_owned(), value.to_owned()).is_some() {
            return None;
        }
    }
    Some((name, pairs))
}

/// Whether a record kind belongs after the data.
pub(crate) fn is_summary(opcode: u8) -> bool {
    matches!(
        opcode,
        op::SCHEMA
            | op::CHANNEL
            | op::STATISTICS
            | op::CHUNK_INDEX
            | op::ATTACHMENT_INDEX
            | op::METADATA_INDEX
            | op::SUMMARY_OFFSET
    )
}
