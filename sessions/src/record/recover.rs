//! Recovery of a cut off or damaged recording.
//!
//! A crash leaves a clean prefix without an end. This program reads the prefix, other MCAP tools may not. A broken disk
//! leaves damage with whole chunks behind it. Recovery writes a new file of all whole chunks, with an index and a
//! proper end.
//!
//! The metadata `sulcus.recovered` of the new file says how the damaged file ended, what is missing, and where the gaps
//! are ([`crate::Gap`]). A replay continues from the first snapshot behind each gap. Damaged chunks of the channels for
//! viewers are left out. Messages are copied unchanged, so chain and signatures hold between the gaps. A recording with
//! a gap is not graded.

mod lost;

use std::fs::OpenOptions;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

use mcap::records::{Metadata, Record};
use mcap::write::NoSeek;
use mcap::{Attachment, Compression, WriteOptions, Writer};
use serde::Serialize;
use sulcus_program::PathText;

use crate::record::note;
use crate::record::note::Note;
use crate::record::read::{Ending, Facts, ReadError, Recording};
use crate::record::signature::Signature;
use crate::record::verify::verify;
use crate::record::walk;
use crate::record::walk::{Framed, Walk};

pub use lost::{Lost, LostChannel};

use lost::Seen;

/// Reason why nothing was recovered.
#[derive(Debug, thiserror::Error)]
pub enum RecoverError {
    /// The file is no recording, or has no row.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// The recording is whole.
    #[error("nothing to recover: the recording is {0}")]
    Whole(Ending),
    /// The new file cannot be written.
    #[error("cannot write `{}`: {what}", path.shown())]
    Write {
        /// Path of the file.
        path: PathBuf,
        /// Error of the system.
        what: String,
    },
    /// A part of the recording that was valid at first cannot be copied.
    #[error("recording cannot be copied: {0}")]
    Copy(String),
}

/// Result of a recovery.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Recovered {
    /// Name of the new file.
    pub file: String,
    /// Length of the new file, bytes.
    pub bytes: u64,
    /// Number of rows in the new file.
    pub ticks: u64,
    /// First tick with a row.
    pub first_tick: u64,
    /// Last tick with a row.
    pub last_tick: u64,
    /// Ending of the damaged file.
    pub was: Ending,
    /// Ending of the new file.
    pub ending: Ending,
    /// Missing part.
    pub lost: Lost,
    /// Result of the signatures of the new file.
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

/// Writes every whole chunk of `recording`, before and behind damage, to a new file at `out`. `progress` gets the
/// number of finished bytes of the damaged file.
///
/// # Errors
/// The recording is whole, or the file exists or cannot be written. In these cases no new file is left at `out`.
pub fn recover(
    recording: &Recording,
    out: &Path,
    progress: &mut dyn FnMut(u64),
) -> Result<Recovered, RecoverError> {
    let failed = |what: std::io::Error| RecoverError::Write {
        path: out.to_owned(),
        what: what.to_string(),
    };
    // The scan may fail, so it precedes the creation of the file.
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
        // An incomplete recovery has no use.
        let _ = std::fs::remove_file(out);
    })
}

/// Recovery to any writer, as by [`recover`]. Gives the writer back, with the missing part.
///
/// # Errors
/// The errors of [`recover`].
pub fn recover_to<W: Write>(
    recording: &Recording,
    out: W,
    progress: &mut dyn FnMut(u64),
) -> Result<(W, Lost), RecoverError> {
    write(&salvaged(recording)?, out, progress)
}

/// Recording with every whole chunk, also behind damage.
fn salvaged(recording: &Recording) -> Result<Recording, RecoverError> {
    match recording.ending() {
        Ending::CutOff { .. } | Ending::Damaged { .. } => {}
        // Other tools cannot open a file with a damaged chunk of the channels for viewers.
        _ if recording.facts().damaged_views > 0 => {}
        ending => return Err(RecoverError::Whole(ending.clone())),
    }
    Ok(recording.salvaged()?)
}

/// Writes the salvaged chunks and the note.
fn write<W: Write>(
    whole: &Recording,
    out: W,
    progress: &mut dyn FnMut(u64),
) -> Result<(W, Lost), RecoverError> {
    let mut copy = Copy::new(out, whole)?;
    copy.all(whole, progress)?;
    let lost = lost::find(whole, &copy.seen);
    let note = Note::new(whole.ending().to_string(), lost.to_string(), whole.gaps());
    copy.writer
        .write_metadata(&Metadata {
            name: note::METADATA.to_owned(),
            metadata: note.0,
        })
        .map_err(copied)?;
    copy.writer.finish().map_err(copied)?;
    Ok((copy.writer.into_inner().into_inner(), lost))
}

fn copied(error: mcap::McapError) -> RecoverError {
    RecoverError::Copy(crate::record::recorder::reason(&error))
}

struct Copy<W: Write> {
    writer: Writer<NoSeek<W>>,
    seen: Seen,
}

impl<W: Write> Copy<W> {
    fn new(out: W, whole: &Recording) -> Result<Self, RecoverError> {
        // The library name stays: the first record names the recording program, and the metadata name the recovering
        // program.
        let first = walk(whole)?.peek().ok();
        let library = first.and_then(|first| match parsed(&first) {
            Ok(Record::Header(header)) => Some(header.library),
            _ => None,
        });
        let library =
            library.ok_or_else(|| RecoverError::Copy("the file has no first record".to_owned()))?;
        let writer = WriteOptions::new()
            .library(library)
            // The compression is that of the recorder.
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

    /// Copies one record.
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
