//! Recording: header, facts and messages of a file that `crate::record::scan` has read.

mod ending;
mod error;

use std::ops::Range;
use std::sync::Arc;

use sulcus_core::{Scene, SceneError};

use crate::record::format::Migration;
use crate::record::gap::Gap;
use crate::record::header::SessionHeader;
use crate::record::key::PublicKey;
use crate::record::message::Message;
use crate::record::program::Program;
use crate::record::signature::Signature;
use crate::record::statement::SessionEnd;
use crate::record::unpack::{Topics, unpack};
use crate::record::viewers::{Said, Viewers};

pub use ending::Ending;
pub use error::ReadError;

/// Facts of a recording, from a first pass over the file.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Facts {
    /// Number of rows.
    pub rows: u64,
    /// Number of samples of devices in the rows.
    pub device_samples: u64,
    /// Number of snapshots.
    pub snapshots: u64,
    /// Number of lines in the log, without the hash over the channels for viewers.
    pub events: u64,
    /// Number of signed statements.
    pub signatures: u64,
    /// First and last tick with a row.
    pub ticks: Option<(u64, u64)>,
    /// Time of the first and last row, nanoseconds since the Unix epoch.
    pub times_unix_ns: Option<(u64, u64)>,
    /// Counters of the recording program at the end of the session; not verified here.
    pub end: Option<SessionEnd>,
    /// Reason why the ticks at the hand and those of the station are not the same, one sentence; `None`: they are, or
    /// the station ticked.
    pub diverged: Option<String>,
    /// Damaged chunks of the channels for viewers, which were skipped.
    pub damaged_views: u64,
    /// Hashes over the channels for viewers in the log.
    pub(crate) viewers: Option<Said>,
}

/// Bytes of a recording, mapped or in memory.
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

/// Recording whose structure was checked from end to end. Messages are unpacked when they are read, so an hour takes no
/// more memory than a second.
pub struct Recording {
    pub(crate) bytes: Arc<Bytes>,
    pub(crate) header: SessionHeader,
    pub(crate) header_digest: [u8; 32],
    pub(crate) migration: Option<Migration>,
    pub(crate) format: u32,
    pub(crate) signer: PublicKey,
    /// First bytes of the header's attachments and metadata.
    pub(crate) placed: Vec<usize>,
    /// Chunks, and stretches of records outside of chunks.
    pub(crate) pieces: Vec<Range<usize>>,
    /// Schemas and channels that only the file's summary contains.
    pub(crate) declared: Vec<Range<usize>>,
    /// End of the part of the file that is read.
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
    /// Constant data of the session.
    pub fn header(&self) -> &SessionHeader {
        &self.header
    }

    /// Migration of a recording of a former version of the format.
    pub fn migration(&self) -> Option<Migration> {
        self.migration
    }

    /// Version of the format in the header.
    pub fn format(&self) -> u32 {
        self.format
    }

    /// BLAKE3 of all bytes of the file.
    pub fn blake3(&self) -> [u8; 32] {
        *blake3::hash(&self.bytes).as_bytes()
    }

    /// Scene of the session: the compiled scene with the couplings of the header, validated.
    ///
    /// # Errors
    /// The bytes are no scene of this version, or the couplings do not fit the scene.
    pub fn scene(&self) -> Result<Scene, ReadError> {
        let recorded_by = || Box::new(Program::of(&self.header));
        let compiled = Scene::from_bytes(&self.header.scene);
        let scene = match self.header.couplings.as_slice() {
            [] => compiled,
            couplings => compiled.and_then(|scene| scene.with_couplings(couplings)),
        };
        scene.map_err(|source| match source {
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

    /// Public key that the recording names as its signer. [`crate::verify()`] checks the signatures. Whether the key is
    /// trusted, only the reader of the recording knows.
    pub fn signer(&self) -> PublicKey {
        self.signer
    }

    /// Counts and spans of the recording.
    pub fn facts(&self) -> &Facts {
        &self.facts
    }

    /// Whether a valid chunk begins at this byte. A skipped chunk of the channels for viewers is not valid.
    pub(crate) fn is_good_chunk(&self, at: usize) -> bool {
        let begins = |piece: &Range<usize>| piece.start;
        self.pieces.binary_search_by_key(&at, begins).is_ok()
    }

    /// State of the channels for viewers. With an invalid signature the hash in the log proves nothing.
    pub fn viewers_by(&self, signature: &Signature) -> Viewers {
        match (self.viewers, signature) {
            (Viewers::AsSigned | Viewers::OnDemand, Signature::Invalid { .. }) => {
                Viewers::NotSigned
            }
            // A part of the channels may be missing in a gap.
            (Viewers::Changed, _) if !self.gaps.is_empty() => Viewers::NotSigned,
            (viewers, _) => viewers,
        }
    }

    /// Places where a part of the exact record is missing, in a recovered recording.
    pub fn gaps(&self) -> &[Gap] {
        &self.gaps
    }

    /// Ending of the file.
    pub fn ending(&self) -> &Ending {
        &self.ending
    }

    /// Length of the file, bytes.
    pub fn len(&self) -> u64 {
        self.bytes.len() as u64
    }

    /// Always false: a recording has at least one row.
    pub fn is_empty(&self) -> bool {
        false
    }

    /// All messages in the order of writing.
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
    fn declared_topics(&self) -> Topics {
        let mut topics = Topics::new();
        for range in &self.declared {
            // The scan has checked these bytes. If they have changed since, unpacking of the messages fails.
            let _ = unpack(&self.bytes[range.clone()], &mut topics, None);
        }
        topics
    }
}

/// Iterator over the messages of a recording. Unpacks one chunk at a time.
pub struct Messages<'a> {
    recording: &'a Recording,
    next_piece: usize,
    topics: Topics,
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
            match unpack(&self.recording.bytes[range], &mut self.topics, None) {
                Ok(messages) => self.unpacked = messages.into_iter(),
                Err(what) => {
                    self.next_piece = self.recording.pieces.len();
                    return Some(Err(ReadError::Changed { what }));
                }
            }
        }
    }
}
