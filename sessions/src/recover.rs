//! A torn recording made whole again, as far as it goes.
//!
//! What a crash leaves is a clean prefix without an end: this program reads it as it is, other MCAP tools may not. Recovery writes
//! a new file of all whole chunks, with an index and a proper end, and says in its metadata `sulcus.recovered` that it did,
//! and what is missing. A damaged chunk of what viewers read is left behind, so that they can open the rest. Messages are copied as they are: chain and signatures hold as far as they went.

mod lost;

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::fs::OpenOptions;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

use mcap::read::{ChunkFlattener, Options};
use mcap::records::{Metadata, Record, op};
use mcap::write::NoSeek;
use mcap::{Attachment, Compression, WriteOptions, Writer};
use serde::Serialize;
use sulcus_program::PathText;

use crate::read::{Ending, Facts, ReadError, Recording};
use crate::verify::{Signature, verify};
use crate::walk::Walk;

pub use lost::{Lost, LostChannel};

/// Name of the metadata record that a recovered file has.
pub(crate) const METADATA: &str = "sulcus.recovered";
/// Its keys that a reader asks for.
pub(crate) const WAS: &str = "was";
/// See there.
pub(crate) const MISSING: &str = "missing";

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
            "  recovered  {} ticks, up to tick {}, {:.2} MB",
            self.ticks,
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

/// Writes what is whole of `recording` to a new file at `out`; `progress` is told the bytes of the torn file that are done.
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
    tear(recording)?;
    let file = OpenOptions::new()
        .write(true)
        .create_new(true)
        .open(out)
        .map_err(failed)?;
    let written = (|| {
        let (writer, lost) = recover_to(recording, BufWriter::new(&file), progress)?;
        writer
            .into_inner()
            .map_err(|error| failed(error.into_error()))?;
        file.sync_all().map_err(failed)?;
        let again = Recording::open(out)?;
        let facts = Facts {
            damaged_views: 0,
            ..recording.facts().clone()
        };
        if *again.facts() != facts {
            return Err(RecoverError::Copy("the copy has other messages".to_owned()));
        }
        Ok(Recovered {
            file: out.shown().to_string(),
            bytes: again.len(),
            ticks: again.facts().rows,
            last_tick: again.facts().ticks.unwrap_or_default().1,
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
    let tear = tear(recording)?;
    let whole = good_bytes(recording, tear)?;
    let mut copy = Copy::new(out, &whole)?;
    copy.all(&whole, progress)?;
    let lost = lost::find(recording, tear, &copy.seen);
    let note = BTreeMap::from([
        ("by".to_owned(), crate::program::Program::this().to_string()),
        (WAS.to_owned(), recording.ending().to_string()),
        (MISSING.to_owned(), lost.to_string()),
    ]);
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
    RecoverError::Copy(crate::record::reason(&error))
}

/// Where a torn recording is torn, bytes; one that others cannot open for a damaged chunk of viewers' ends where it ends.
fn tear(recording: &Recording) -> Result<usize, RecoverError> {
    match recording.ending() {
        Ending::CutOff { at_byte, .. } | Ending::Damaged { at_byte, .. } => {
            let at = usize::try_from(*at_byte).unwrap_or(usize::MAX);
            Ok(at.min(recording.bytes.len()))
        }
        _ if recording.facts().damaged_views > 0 => Ok(recording.bytes.len()),
        ending => Err(RecoverError::Whole(ending.clone())),
    }
}

/// The bytes of a torn recording before the tear, without the chunks of viewers' that were passed over.
fn good_bytes(recording: &Recording, tear: usize) -> Result<Cow<'_, [u8]>, RecoverError> {
    let whole = &recording.bytes[..tear];
    if recording.facts().damaged_views == 0 {
        return Ok(Cow::Borrowed(whole));
    }
    let mut good = Vec::with_capacity(whole.len());
    let mut walk = Walk::new(whole).ok_or(ReadError::NotMcap)?;
    good.extend_from_slice(&whole[..walk.at]);
    while let Ok(record) = walk.peek() {
        if record.opcode != op::CHUNK || recording.is_good_chunk(walk.at) {
            good.extend_from_slice(record.whole);
        }
        walk.pass(&record);
    }
    Ok(Cow::Owned(good))
}

/// A channel and the time of the last message of it that was kept.
pub(crate) type Seen = BTreeMap<u16, (String, Option<u64>)>;

struct Copy<W: Write> {
    writer: Writer<NoSeek<W>>,
    seen: Seen,
}

impl<W: Write> Copy<W> {
    fn new(out: W, whole: &[u8]) -> Result<Self, RecoverError> {
        // As it was: the first record says who wrote the messages, the metadata who recovered them.
        let library = match records(whole)?.next() {
            Some(Ok(Record::Header(header))) => header.library,
            _ => return Err(RecoverError::Copy("it has no first record".to_owned())),
        };
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

    fn all(&mut self, whole: &[u8], progress: &mut dyn FnMut(u64)) -> Result<(), RecoverError> {
        let mut done = 0;
        for record in records(whole)? {
            let record = record.map_err(copied)?;
            if matches!(record, Record::DataEnd(_)) {
                break;
            }
            done += self.one(record)?;
            // (Unpacked bytes: roughly as many.)
            progress(done.min(whole.len() as u64));
        }
        progress(whole.len() as u64);
        Ok(())
    }

    /// Copies a record; gives its length.
    fn one(&mut self, record: Record<'_>) -> Result<u64, RecoverError> {
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
                return Ok(data.len() as u64 + 31);
            }
            Record::Attachment { header, data, .. } => {
                let length = data.len() as u64;
                writer
                    .attach(&Attachment {
                        log_time: header.log_time,
                        create_time: header.create_time,
                        name: header.name,
                        media_type: header.media_type,
                        data,
                    })
                    .map_err(copied)?;
                return Ok(length);
            }
            // Torn again after a recovery: the newer note stands for both.
            Record::Metadata(metadata) if metadata.name == METADATA => {}
            Record::Metadata(metadata) => writer.write_metadata(&metadata).map_err(copied)?,
            _ => {}
        }
        Ok(0)
    }
}

fn records(whole: &[u8]) -> Result<ChunkFlattener<'_>, RecoverError> {
    ChunkFlattener::new_with_options(whole, Options::IgnoreEndMagic.into()).map_err(copied)
}
