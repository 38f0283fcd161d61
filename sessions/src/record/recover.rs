//! A torn or damaged recording made whole again, as far as it goes.
//!
//! A crash leaves a clean prefix without an end: this program reads it as it is, other MCAP tools may not. A broken disk leaves
//! damage with whole chunks behind it. Recovery writes a new file of all whole chunks, with an index and a proper end. Its metadata
//! `sulcus.recovered` says how the damaged file ended, what is missing, and where the gaps are ([`Gap`]), so that a replay begins
//! again with the first snapshot behind each. A damaged chunk of what viewers read is left behind, so that they can open the
//! rest. Messages are copied as they are: chain and signatures hold between the gaps. A grade does not rest on a recording with a
//! gap.

mod lost;

use std::collections::BTreeMap;
use std::fs::OpenOptions;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

use mcap::records::{Metadata, Record};
use mcap::write::NoSeek;
use mcap::{Attachment, Compression, WriteOptions, Writer};
use serde::Serialize;
use sulcus_program::PathText;

use crate::record::gap::Gap;
use crate::record::read::{Ending, Facts, ReadError, Recording};
use crate::record::verify::{Signature, verify};
use crate::record::walk;
use crate::record::walk::{Framed, Walk};

pub use lost::{Lost, LostChannel};

/// Name of the metadata record that a recovered file has.
pub(crate) const METADATA: &str = "sulcus.recovered";
/// Its keys that a reader asks for.
pub(crate) const WAS: &str = "was";
/// See there.
pub(crate) const MISSING: &str = "missing";
/// The gaps, as JSON; not there where there is none.
pub(crate) const GAPS: &str = "gaps";

/// Why nothing was recovered.
#[derive(Debug, thiserror::Error)]
pub enum RecoverError {
    /// It is no recording, or holds no row.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// There is nothing to do.
    #[error("nothing to recover: the recording is {0}")]
    Whole(Ending),
    /// The new file cannot be written.
    #[error("cannot write `{}`: {what}", path.shown())]
    Write {
        /// Which file.
        path: PathBuf,
        /// What the system said.
        what: String,
    },
    /// What a first reading found good cannot be copied.
    #[error("recording cannot be copied: {0}")]
    Copy(String),
}

/// What was recovered.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Recovered {
    /// The new file.
    pub file: String,
    /// Its length, bytes.
    pub bytes: u64,
    /// Rows in it.
    pub ticks: u64,
    /// The first of them.
    pub first_tick: u64,
    /// The last of them.
    pub last_tick: u64,
    /// How the torn file ends.
    pub was: Ending,
    /// How the new one does.
    pub ending: Ending,
    /// What is missing.
    pub lost: Lost,
    /// What the signatures say of the new file.
    pub signature: Signature,
}

impl std::fmt::Display for Recovered {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        writeln!(f, "{}", self.file)?;
        writeln!(
            f,
            "  recovered  {} ticks, {} to {}, {:.2} MB",
            self.ticks,
            self.first_tick,
            self.last_tick,
            self.bytes as f64 * 1e-6
        )?;
        writeln!(f, "  was        {}", self.was)?;
        writeln!(f, "  missing    {}", self.lost)?;
        for channel in &self.lost.channels {
            writeln!(f, "             {channel}")?;
        }
        writeln!(f, "  ending     {}", self.ending)?;
        write!(f, "  signature  {}", self.signature)
    }
}

/// Writes every whole chunk of `recording`, before and behind damage, to a new file at `out`. `progress` is told the bytes of
/// the damaged file that are done.
///
/// # Errors
/// When the recording is whole, or the file exists or cannot be written. Then nothing is left at `out`, unless it was there before.
pub fn recover(
    recording: &Recording,
    out: &Path,
    progress: &mut dyn FnMut(u64),
) -> Result<Recovered, RecoverError> {
    let failed = |what: std::io::Error| RecoverError::Write {
        path: out.to_owned(),
        what: what.to_string(),
    };
    // Before a file is made.
    let whole = salvaged(recording)?;
    let file = OpenOptions::new()
        .write(true)
        .create_new(true)
        .open(out)
        .map_err(failed)?;
    let written = (|| {
        let (writer, lost) = write(&whole, BufWriter::new(&file), progress)?;
        writer
            .into_inner()
            .map_err(|error| failed(error.into_error()))?;
        file.sync_all().map_err(failed)?;
        let again = Recording::open(out)?;
        let facts = Facts {
            damaged_views: 0,
            ..whole.facts().clone()
        };
        if *again.facts() != facts || again.gaps() != whole.gaps() {
            return Err(RecoverError::Copy("the copy has other messages".to_owned()));
        }
        let (first_tick, last_tick) = facts.ticks.unwrap_or_default();
        Ok(Recovered {
            file: out.shown().to_string(),
            bytes: again.len(),
            ticks: facts.rows,
            first_tick,
            last_tick,
            was: recording.ending().clone(),
            ending: again.ending().clone(),
            lost,
            signature: verify(&again, None)?.signature,
        })
    })();
    written.inspect_err(|_| {
        // Half a recovery is of no use to anyone.
        let _ = std::fs::remove_file(out);
    })
}

/// As [`recover`], to any writer; gives it back, and what is missing.
///
/// # Errors
/// As [`recover`].
pub fn recover_to<W: Write>(
    recording: &Recording,
    out: W,
    progress: &mut dyn FnMut(u64),
) -> Result<(W, Lost), RecoverError> {
    write(&salvaged(recording)?, out, progress)
}

/// The recording with every whole chunk.
fn salvaged(recording: &Recording) -> Result<Recording, RecoverError> {
    match recording.ending() {
        Ending::CutOff { .. } | Ending::Damaged { .. } => {}
        // Others cannot open it for a damaged chunk of viewers'.
        _ if recording.facts().damaged_views > 0 => {}
        ending => return Err(RecoverError::Whole(ending.clone())),
    }
    Ok(recording.salvaged()?)
}

/// Writes what was salvaged, and the note.
fn write<W: Write>(
    whole: &Recording,
    out: W,
    progress: &mut dyn FnMut(u64),
) -> Result<(W, Lost), RecoverError> {
    let mut copy = Copy::new(out, whole)?;
    copy.all(whole, progress)?;
    let lost = lost::find(whole, &copy.seen);
    let mut note = BTreeMap::from([
        (
            "by".to_owned(),
            crate::record::program::Program::this().to_string(),
        ),
        (WAS.to_owned(), whole.ending().to_string()),
        (MISSING.to_owned(), lost.to_string()),
    ]);
    if !whole.gaps().is_empty() {
        note.insert(GAPS.to_owned(), Gap::list(whole.gaps()));
    }
    copy.writer
        .write_metadata(&Metadata {
            name: METADATA.to_owned(),
            metadata: note,
        })
        .map_err(copied)?;
    copy.writer.finish().map_err(copied)?;
    Ok((copy.writer.into_inner().into_inner(), lost))
}

fn copied(error: mcap::McapError) -> RecoverError {
    RecoverError::Copy(crate::record::recorder::reason(&error))
}

/// A channel and the time of the last message of it that was kept.
pub(crate) type Seen = BTreeMap<u16, (String, Option<u64>)>;

struct Copy<W: Write> {
    writer: Writer<NoSeek<W>>,
    seen: Seen,
}

impl<W: Write> Copy<W> {
    fn new(out: W, whole: &Recording) -> Result<Self, RecoverError> {
        // As it was: the first record says who wrote the messages, the metadata who recovered them.
        let first = walk(whole)?.peek().ok();
        let library = first.and_then(|first| match parsed(&first) {
            Ok(Record::Header(header)) => Some(header.library),
            _ => None,
        });
        let library =
            library.ok_or_else(|| RecoverError::Copy("it has no first record".to_owned()))?;
        let writer = WriteOptions::new()
            .library(library)
            // As the recorder packs.
            .compression(Some(Compression::Zstd))
            .compression_level(1)
            .compression_threads(0)
            .chunk_size(Some(256 << 10))
            .disable_seeking(true)
            .create(NoSeek::new(out))
            .map_err(copied)?;
        Ok(Self {
            writer,
            seen: Seen::new(),
        })
    }

    fn all(
        &mut self,
        whole: &Recording,
        progress: &mut dyn FnMut(u64),
    ) -> Result<(), RecoverError> {
        let walk = walk(whole)?;
        for at in &whole.placed {
            if let Ok(record) = walk.peek_at(*at) {
                self.one(parsed(&record)?)?;
            }
        }
        for range in &whole.declared {
            self.piece(&whole.bytes[range.clone()])?;
        }
        for range in &whole.pieces {
            self.piece(&whole.bytes[range.clone()])?;
            progress(range.end as u64);
        }
        progress(whole.len());
        Ok(())
    }

    fn piece(&mut self, piece: &[u8]) -> Result<(), RecoverError> {
        let mut failed = None;
        let visited = walk::visit(piece, |opcode, body| {
            if failed.is_none() {
                let record = mcap::parse_record(opcode, body).map_err(copied);
                failed = record.and_then(|record| self.one(record)).err();
            }
            Ok(())
        });
        match failed {
            Some(error) => Err(error),
            None => Ok(visited.map_err(|what| ReadError::Changed { what })?),
        }
    }

    /// Copies a record.
    fn one(&mut self, record: Record<'_>) -> Result<(), RecoverError> {
        let writer = &mut self.writer;
        match record {
            Record::Schema { header, data } => {
                writer
                    .add_schema_with_id(header.id, &header.name, &header.encoding, &data)
                    .map_err(copied)?;
            }
            Record::Channel(c) => {
                writer
                    .add_channel_with_id(
                        c.id,
                        c.schema_id,
                        &c.topic,
                        &c.message_encoding,
                        &c.metadata,
                    )
                    .map_err(copied)?;
                self.seen.entry(c.id).or_insert((c.topic, None));
            }
            Record::Message { header, data } => {
                writer
                    .write_to_known_channel(&header, &data)
                    .map_err(copied)?;
                if let Some((_, last)) = self.seen.get_mut(&header.channel_id) {
                    *last = Some(header.log_time);
                }
            }
            Record::Attachment { header, data, .. } => {
                writer
                    .attach(&Attachment {
                        log_time: header.log_time,
                        create_time: header.create_time,
                        name: header.name,
                        media_type: header.media_type,
                        data,
                    })
                    .map_err(copied)?;
            }
            Record::Metadata(metadata) => writer.write_metadata(&metadata).map_err(copied)?,
            _ => {}
        }
        Ok(())
    }
}

fn walk(whole: &Recording) -> Result<Walk<'_>, RecoverError> {
    Ok(Walk::new(&whole.bytes).ok_or(ReadError::NotMcap)?)
}

fn parsed<'a>(record: &Framed<'a>) -> Result<Record<'a>, RecoverError> {
    mcap::parse_record(record.opcode, record.body).map_err(copied)
}
