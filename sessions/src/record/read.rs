//! Reading a recording: strict, bounded, never a panic, and what a crash left is still read.

use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use serde::Serialize;
use sulcus_core::scene::SCENE_VERSION;
use sulcus_core::{Scene, SceneError};
use sulcus_program::PathText;

use crate::record::format::Migration;
use crate::record::gap::Gap;
use crate::record::header::SessionHeader;
use crate::record::key::PublicKey;
use crate::record::message::Message;
use crate::record::program::Program;
use crate::record::scan;
use crate::record::scan::Depth;
use crate::record::statement::SessionEnd;
use crate::record::verify::Signature;
use crate::record::viewers::Viewers;

/// Why a file is not a recording that can be read.
#[derive(Debug, thiserror::Error)]
pub enum ReadError {
    /// The system refused.
    #[error("cannot read `{}`: {source}", path.shown())]
    Io {
        /// Which file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// It does not begin as an MCAP file does.
    #[error("not an MCAP file: it does not begin with the MCAP magic bytes")]
    NotMcap,
    /// An MCAP file of somebody else's.
    #[error("not a Sulcus recording: the MCAP file has no metadata `sulcus`")]
    NotSulcus,
    /// Nothing can be said about a recording without its header.
    #[error("recording ends inside its header, after {at} bytes: nothing in it can be used")]
    HeaderCut {
        /// Length of what is whole.
        at: u64,
    },
    /// Another version of the layout.
    #[error("recording has format version `{found}`, this program reads {expected}: {advice}")]
    Version {
        /// Version found.
        found: String,
        /// Versions that are read.
        expected: String,
        /// What the version is, and what to do.
        advice: String,
    },
    /// The header is there, and wrong.
    #[error("recording's header is damaged: {what}")]
    Header {
        /// What is wrong.
        what: String,
    },
    /// Nothing to replay.
    #[error("recording has no rows: it ended before its first tick was written ({ending})")]
    NoRows {
        /// How it ended, in words.
        ending: String,
    },
    /// The file is not what it was when it was opened.
    #[error("recording changed while it was being read: {what}")]
    Changed {
        /// What is wrong now.
        what: String,
    },
    /// The scene is of another version of the core.
    #[error(
        "recording's scene has version {found}, this program ({}) reads {SCENE_VERSION}: replay it with the program that recorded it, {recorded_by}",
        Program::this()
    )]
    SceneVersion {
        /// Who could.
        recorded_by: Box<Program>,
        /// Version found.
        found: u16,
    },
    /// The scene cannot be used.
    #[error(
        "recording's scene cannot be used by this program ({}), recorded by {recorded_by}: {source}",
        Program::this()
    )]
    Scene {
        /// Who could.
        recorded_by: Box<Program>,
        /// What is wrong.
        source: Box<SceneError>,
    },
}

/// How a recording ends.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Ending {
    /// With the station's last statement and everything an MCAP file ends with.
    Finished,
    /// Somewhere: the program was killed, or the machine stopped. What is before is whole.
    CutOff {
        /// Length of what is whole.
        at_byte: u64,
        /// What is missing.
        why: String,
    },
    /// Properly, but without the station's last statement, or with gaps: what a torn or damaged file held was written anew
    /// ([`crate::recover()`]).
    Recovered {
        /// How the torn file ended.
        was: String,
        /// What was missing.
        missing: String,
    },
    /// With bytes that are wrong. What is before is whole; what is after is not read.
    Damaged {
        /// Where the wrong bytes begin.
        at_byte: u64,
        /// What is wrong.
        why: String,
    },
}

impl std::fmt::Display for Ending {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Finished => f.write_str("finished"),
            Self::CutOff { at_byte, why } => write!(f, "cut off after {at_byte} bytes: {why}"),
            // A file's own words may hold anything, also what a terminal obeys.
            Self::Recovered { was, missing } => write!(
                f,
                "recovered from one that was {}; missing: {}",
                was.escape_debug(),
                missing.escape_debug()
            ),
            Self::Damaged { at_byte, why } => write!(f, "damaged at byte {at_byte}: {why}"),
        }
    }
}

/// What a first pass over the file found.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Facts {
    /// Rows.
    pub rows: u64,
    /// Snapshots.
    pub snapshots: u64,
    /// Lines in the log, but for the hash over what viewers read.
    pub events: u64,
    /// Signed statements.
    pub signatures: u64,
    /// First and last tick that have a row.
    pub ticks: Option<(u64, u64)>,
    /// Time of the first and last row, nanoseconds since the Unix epoch.
    pub times_unix_ns: Option<(u64, u64)>,
    /// What the recording program said at the end; not verified here.
    pub end: Option<SessionEnd>,
    /// Chunks of what viewers read that cannot be unpacked, and were passed over.
    pub damaged_views: u64,
    /// What the log says of all that viewers read.
    pub(crate) viewers: Option<crate::record::viewers::Sum>,
}

/// A recording's bytes, mapped or in memory.
pub(crate) enum Bytes {
    Mapped(memmap2::Mmap),
    Owned(Vec<u8>),
}

impl std::ops::Deref for Bytes {
    type Target = [u8];
    fn deref(&self) -> &[u8] {
        match self {
            Self::Mapped(map) => map,
            Self::Owned(bytes) => bytes,
        }
    }
}

/// A recording whose structure was checked from end to end; its messages are unpacked as they are
/// read, so that an hour takes no more memory than a second.
pub struct Recording {
    pub(crate) bytes: Arc<Bytes>,
    pub(crate) header: SessionHeader,
    pub(crate) header_digest: [u8; 32],
    pub(crate) migration: Option<Migration>,
    pub(crate) signer: PublicKey,
    /// Where the attachments and the metadata of the header begin.
    pub(crate) placed: Vec<usize>,
    /// Chunks, and stretches of records outside of chunks.
    pub(crate) pieces: Vec<Range<usize>>,
    /// Schemas and channels that the file's summary alone still names.
    pub(crate) declared: Vec<Range<usize>>,
    /// Where what is read of the file ends.
    pub(crate) tail: usize,
    pub(crate) facts: Facts,
    pub(crate) viewers: Viewers,
    pub(crate) gaps: Vec<Gap>,
    pub(crate) ending: Ending,
}

impl std::fmt::Debug for Recording {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Recording")
            .field("facts", &self.facts)
            .field("ending", &self.ending)
            .finish_non_exhaustive()
    }
}

impl Recording {
    /// Opens and checks a file. One that is still being written may be opened: it is read as far as
    /// it had come.
    ///
    /// # Errors
    /// When it is no recording, or holds no row.
    pub fn open(path: &Path) -> Result<Self, ReadError> {
        Self::map(path, Depth::Strict)
    }

    /// As [`Recording::open`], and every chunk that is whole behind damage is read, too: for a recovery.
    /// [`Recording::gaps`] says where something is missing.
    ///
    /// # Errors
    /// As [`Recording::open`].
    pub fn salvage(path: &Path) -> Result<Self, ReadError> {
        Self::map(path, Depth::Salvage)
    }

    /// This recording, with every chunk that is whole behind damage.
    ///
    /// # Errors
    /// When the file changes meanwhile.
    pub(crate) fn salvaged(&self) -> Result<Self, ReadError> {
        scan::scan(Arc::clone(&self.bytes), Depth::Salvage)
    }

    fn map(path: &Path, depth: Depth) -> Result<Self, ReadError> {
        let failed = |source| ReadError::Io {
            path: path.to_owned(),
            source,
        };
        let file = std::fs::File::open(path).map_err(failed)?;
        let metadata = file.metadata().map_err(failed)?;
        if metadata.is_dir() {
            return Err(failed(std::io::ErrorKind::IsADirectory.into()));
        }
        if metadata.len() == 0 {
            return Err(ReadError::NotMcap);
        }
        // SAFETY: the map is only read. A recording only ever grows, and growth is not seen; a
        // program that overwrote it meanwhile would be noticed as damage, since nothing is trusted
        // across two reads. (One that shortened it could end this process, as with any mapped file.)
        let map = unsafe { memmap2::Mmap::map(&file) }.map_err(failed)?;
        scan::scan(Arc::new(Bytes::Mapped(map)), depth)
    }

    /// As [`Recording::open`], from memory.
    ///
    /// # Errors
    /// As [`Recording::open`].
    pub fn from_bytes(bytes: Vec<u8>) -> Result<Self, ReadError> {
        scan::scan(Arc::new(Bytes::Owned(bytes)), Depth::Strict)
    }

    /// As [`Recording::salvage`], from memory.
    ///
    /// # Errors
    /// As [`Recording::open`].
    pub fn salvage_bytes(bytes: Vec<u8>) -> Result<Self, ReadError> {
        scan::scan(Arc::new(Bytes::Owned(bytes)), Depth::Salvage)
    }

    /// What is constant in the session.
    pub fn header(&self) -> &SessionHeader {
        &self.header
    }

    /// What is made of it, where it is of a former version of the format.
    pub fn migration(&self) -> Option<Migration> {
        self.migration
    }

    /// The compiled scene, validated.
    ///
    /// # Errors
    /// When its bytes are not a scene of this version.
    pub fn scene(&self) -> Result<Scene, ReadError> {
        let recorded_by = || Box::new(Program::of(&self.header));
        Scene::from_bytes(&self.header.scene).map_err(|source| match source {
            SceneError::Version { found } => ReadError::SceneVersion {
                recorded_by: recorded_by(),
                found,
            },
            source => ReadError::Scene {
                recorded_by: recorded_by(),
                source: Box::new(source),
            },
        })
    }

    /// The key that the recording says it was signed with. Whether it was is for
    /// [`crate::verify()`] to find; whether that key is to be trusted, only its reader knows.
    pub fn signer(&self) -> PublicKey {
        self.signer
    }

    /// Counts and spans.
    pub fn facts(&self) -> &Facts {
        &self.facts
    }

    /// Whether a chunk that was found good begins at this byte; one of viewers' that was passed over is not.
    pub(crate) fn is_good_chunk(&self, at: usize) -> bool {
        let begins = |piece: &Range<usize>| piece.start;
        self.pieces.binary_search_by_key(&at, begins).is_ok()
    }

    /// Whether what viewers read of it is what was recorded.
    /// (A hash in a log that is not what was signed says nothing.)
    pub fn viewers_by(&self, signature: &Signature) -> Viewers {
        match (self.viewers, signature) {
            (Viewers::AsSigned, Signature::Invalid { .. }) => Viewers::NotSigned,
            // A part of it may be missing with the rest.
            (Viewers::Changed, _) if !self.gaps.is_empty() => Viewers::NotSigned,
            (viewers, _) => viewers,
        }
    }

    /// Where a part of the exact record is missing: in what was recovered of a damaged file.
    pub fn gaps(&self) -> &[Gap] {
        &self.gaps
    }

    /// How it ends.
    pub fn ending(&self) -> &Ending {
        &self.ending
    }

    /// Length of the file, bytes.
    pub fn len(&self) -> u64 {
        self.bytes.len() as u64
    }

    /// Never: a recording has at least one row.
    pub fn is_empty(&self) -> bool {
        false
    }

    /// All messages in the order in which they were written.
    pub fn messages(&self) -> Messages<'_> {
        Messages {
            recording: self,
            next_piece: 0,
            topics: self.declared_topics(),
            unpacked: Vec::new().into_iter(),
        }
    }
}

impl Recording {
    /// Channels that are known before the first piece is read.
    fn declared_topics(&self) -> scan::Topics {
        let mut topics = scan::Topics::new();
        for range in &self.declared {
            // Found good by the scan; of bytes that changed meanwhile, the message that names the channel is found wrong.
            let _ = scan::unpack(&self.bytes[range.clone()], &mut topics, None);
        }
        topics
    }
}

/// Iterator over a recording's messages; unpacks one chunk at a time.
pub struct Messages<'a> {
    recording: &'a Recording,
    next_piece: usize,
    topics: scan::Topics,
    unpacked: std::vec::IntoIter<Message>,
}

impl Iterator for Messages<'_> {
    type Item = Result<Message, ReadError>;

    fn next(&mut self) -> Option<Self::Item> {
        loop {
            if let Some(message) = self.unpacked.next() {
                return Some(Ok(message));
            }
            let range = self.recording.pieces.get(self.next_piece)?.clone();
            self.next_piece += 1;
            match scan::unpack(&self.recording.bytes[range], &mut self.topics, None) {
                Ok(messages) => self.unpacked = messages.into_iter(),
                Err(what) => {
                    self.next_piece = self.recording.pieces.len();
                    return Some(Err(ReadError::Changed { what }));
                }
            }
        }
    }
}
