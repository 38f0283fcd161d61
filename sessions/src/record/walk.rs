//! Walk over the records of an MCAP file with arbitrary bytes.
//!
//! The crate `mcap` reads well-formed files. A recording may be cut off by a crash or edited. So this module checks the
//! framing record by record, with a bound on every length. The crate only unpacks chunks with a valid header.

use std::ops::Range;

use mcap::records::op;
use mcap::sans_io::{LinearReadEvent, LinearReader, LinearReaderOptions};

use crate::record::bytes::Cut;

/// Largest chunk that is unpacked, bytes. The recorder's chunks have 256 KiB and one message.
const MAX_CHUNK: u64 = 64 << 20;
/// Compressions of chunks, with an upper bound on each ratio. The bound of lz4 follows from its lengths of one byte,
/// that of zstd from a block of 128 KiB of one repeated byte. The recorder uses zstd, and used lz4 at first. Another
/// tool may leave chunks uncompressed.
const MAX_RATIOS: [(&str, u64); 3] = [("zstd", 1 << 15), ("lz4", 256), ("", 1)];
/// Length of opcode and length field of a record, bytes.
const FRAME: usize = 9;

/// Reason for the end of reading before the proper end.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Stop {
    /// The bytes end inside a record or before the end of the file.
    Torn(&'static str),
    /// The bytes are invalid.
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
    /// Position behind the magic bytes; `None` if the file begins otherwise.
    pub fn new(bytes: &'a [u8]) -> Option<Self> {
        bytes.starts_with(mcap::MAGIC).then_some(Self {
            bytes,
            at: mcap::MAGIC.len(),
        })
    }

    /// Record at the present position. The position stays.
    pub fn peek(&self) -> Result<Framed<'a>, Stop> {
        let rest = &self.bytes[self.at..];
        if rest.is_empty() {
            return Err(Stop::Torn("there is no end record"));
        }
        let mut cut = Cut(rest);
        let (Some(opcode), Some(length)) = (cut.u8(), cut.u64()) else {
            return Err(Stop::Torn("the last record is incomplete"));
        };
        if opcode == 0 {
            // A disk may leave zeros in place of the last write.
            return Err(if rest.iter().all(|byte| *byte == 0) {
                Stop::Torn("zeros follow")
            } else {
                Stop::Damaged("a record has opcode 0".to_owned())
            });
        }
        let Some(body) = usize::try_from(length).ok().and_then(|n| cut.take(n)) else {
            return Err(Stop::Torn("the last record is incomplete"));
        };
        Ok(Framed {
            opcode,
            body,
            whole: &rest[..FRAME + body.len()],
        })
    }

    /// Record at another position, as by [`Walk::peek`].
    pub fn peek_at(&self, at: usize) -> Result<Framed<'a>, Stop> {
        Self {
            bytes: self.bytes,
            at,
        }
        .peek()
    }

    /// Byte at a position: the opcode of a record that begins there.
    pub fn opcode_at(&self, at: usize) -> Option<u8> {
        self.bytes.get(at).copied()
    }

    /// Bytes between two positions.
    pub fn between(&self, begin: usize, end: usize) -> &'a [u8] {
        self.bytes.get(begin..end).unwrap_or_default()
    }

    /// Length of the file, bytes.
    pub fn length(&self) -> usize {
        self.bytes.len()
    }

    /// Schemas and channels in the summary, with their places; empty without a whole summary.
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

    /// Moves behind a record of [`Walk::peek`].
    pub fn pass(&mut self, record: &Framed<'_>) {
        self.at += record.whole.len();
    }

    /// Checks that only the magic bytes follow the footer.
    pub fn end(&self) -> Result<(), Stop> {
        let rest = &self.bytes[self.at..];
        if rest == mcap::MAGIC {
            Ok(())
        } else if mcap::MAGIC.starts_with(rest) {
            Err(Stop::Torn("the magic bytes at the end are incomplete"))
        } else {
            Err(Stop::Damaged("bytes follow the footer".to_owned()))
        }
    }
}

/// Calls `visit` for each record of a piece, inside and outside of chunks.
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

/// Unpacks a chunk, checks its CRC, then calls `visit` for each record in the chunk.
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

/// Whether the bytes begin like a chunk with a known compression. The rest may be cut off or damaged.
pub(crate) fn is_chunk_header(body: &[u8]) -> bool {
    let mut cut = Cut(body);
    // The skipped bytes are times, unpacked length and CRC.
    let packed_with = cut.take(16 + 8 + 4).and_then(|_| cut.string());
    MAX_RATIOS
        .iter()
        .any(|(name, _)| packed_with == Some(*name))
}

/// Bytes that unpacking a chunk with this body reads and writes; `None` for an invalid chunk.
pub(crate) fn chunk_cost(body: &[u8]) -> Option<usize> {
    let unpacked = check_chunk(body).ok()?;
    usize::try_from(unpacked).ok()?.checked_add(body.len())
}

/// Checks the numbers in a chunk's header before memory is allocated; unpacked length.
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
        return Err("a chunk's header is incomplete".to_owned());
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
        return Err(format!(
            "a chunk has {there} bytes of data, expected {packed} by its header"
        ));
    }
    if unpacked > MAX_CHUNK {
        return Err(format!(
            "a chunk has {unpacked} unpacked bytes by its header, expected at most {MAX_CHUNK}: write the file anew with smaller chunks"
        ));
    }
    if unpacked > packed.saturating_add(64).saturating_mul(max_ratio) {
        return Err(format!(
            "a chunk has {unpacked} unpacked bytes by its header, which {packed} bytes of data cannot contain"
        ));
    }
    Ok(unpacked)
}

/// Message in a message record: channel, times (log, publication), bytes.
pub(crate) fn message(body: &[u8]) -> Option<(u16, [u64; 2], &[u8])> {
    let mut cut = Cut(body);
    let channel = cut.u16()?;
    let _sequence = cut.u32()?;
    Some((channel, [cut.u64()?, cut.u64()?], cut.0))
}

/// Number, number of the schema, topic and encoding in a channel record.
pub(crate) fn channel(body: &[u8]) -> Option<(u16, u16, &str, &str)> {
    let mut cut = Cut(body);
    Some((cut.u16()?, cut.u16()?, cut.string()?, cut.string()?))
}

/// Number, name, encoding and data in a schema record.
pub(crate) fn schema(body: &[u8]) -> Option<(u16, &str, &str, &[u8])> {
    let mut cut = Cut(body);
    let (id, name, encoding) = (cut.u16()?, cut.string()?, cut.string()?);
    let length = usize::try_from(cut.u32()?).ok()?;
    Some((id, name, encoding, cut.take(length)?))
}

/// Name and data in an attachment record.
pub(crate) fn attachment(body: &[u8]) -> Option<(&str, &[u8])> {
    let mut cut = Cut(body);
    let _times = cut.take(16)?;
    let name = cut.string()?;
    let _media_type = cut.string()?;
    let length = usize::try_from(cut.u64()?).ok()?;
    Some((name, cut.take(length)?))
}

/// Name and pairs in a metadata record; `None` also for a repeated key.
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

/// Whether a record of this opcode belongs to the summary.
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
