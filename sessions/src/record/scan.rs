//! First pass over a recording's file: header, every chunk once, ending.
//!
//! Any legal arrangement of an MCAP file is read. Attachments and metadata may be before, between and behind the
//! messages. Chunks may have any size up to a bound and any compression. Messages may be outside of chunks. Index and
//! summary may be missing.

mod gaps;
mod head;
mod pass;
mod salvage;
mod state;

use std::path::Path;
use std::sync::Arc;

use crate::record::header::SessionHeader;
use crate::record::read::{Bytes, ReadError, Recording};
use crate::record::viewers::Viewers;
use crate::record::walk::Walk;

use head::Head;
use pass::Pass;
use state::Depth;

impl Recording {
    /// Opens and checks a file. A file that is still being written is read up to its present end.
    ///
    /// # Errors
    /// The file is no recording, or has no row.
    pub fn open(path: &Path) -> Result<Self, ReadError> {
        Self::map(path, Depth::Strict)
    }

    /// Recording with every whole chunk, also behind damage, for a recovery. [`Recording::gaps`] names the places where
    /// messages are missing.
    ///
    /// # Errors
    /// The errors of [`Recording::open`].
    pub fn salvage(path: &Path) -> Result<Self, ReadError> {
        Self::map(path, Depth::Salvage)
    }

    /// The same recording with every whole chunk, also behind damage.
    ///
    /// # Errors
    /// The file has changed since it was opened.
    pub(crate) fn salvaged(&self) -> Result<Self, ReadError> {
        scan(Arc::clone(&self.bytes), Depth::Salvage)
    }

    /// Header of a recording, without a look at its messages.
    ///
    /// # Errors
    /// The file is no recording, or its header is damaged.
    pub fn header_of(path: &Path) -> Result<SessionHeader, ReadError> {
        let bytes = Self::bytes_of(path)?;
        let walk = Walk::new(&bytes).ok_or(ReadError::NotMcap)?;
        Ok(Head::read(walk)?.check()?.header)
    }

    fn map(path: &Path, depth: Depth) -> Result<Self, ReadError> {
        scan(Arc::new(Self::bytes_of(path)?), depth)
    }

    fn bytes_of(path: &Path) -> Result<Bytes, ReadError> {
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
        // SAFETY: the map is only read. A recording only grows, and growth is not visible in the map. A program that
        // overwrites the file causes damage that is found, because no result of one read is trusted in the next. A
        // program that shortens the file could end this process, as with any mapped file.
        let map = unsafe { memmap2::Mmap::map(&file) }.map_err(failed)?;
        Ok(Bytes::Mapped(map))
    }

    /// Recording from bytes in memory, as by [`Recording::open`].
    ///
    /// # Errors
    /// The errors of [`Recording::open`].
    pub fn from_bytes(bytes: Vec<u8>) -> Result<Self, ReadError> {
        scan(Arc::new(Bytes::Owned(bytes)), Depth::Strict)
    }
}

/// Reads and checks the whole file once.
fn scan(bytes: Arc<Bytes>, depth: Depth) -> Result<Recording, ReadError> {
    let mut walk = Walk::new(&bytes).ok_or(ReadError::NotMcap)?;
    let head = Head::read(walk.clone())?;
    let checked = head.check()?;
    let mut pass = Pass::new(&head, depth, checked.header.viewers);
    let ending = pass.run(&mut walk);
    if pass.state.facts.rows == 0 {
        return Err(ReadError::NoRows {
            ending: ending.to_string(),
        });
    }
    let Pass {
        pieces,
        declared,
        tail,
        state,
        ..
    } = pass;
    let viewers = Viewers::of(state.facts.viewers.as_ref(), &state.viewed.sum());
    let gaps = match depth {
        Depth::Strict => head.gaps(),
        Depth::Salvage => gaps::with_former(state.gaps, head.gaps(), state.messages),
    };
    let placed = head.placed.iter().copied().collect();
    let mut recording = Recording {
        header: checked.header,
        header_digest: checked.digest,
        migration: checked.migration,
        format: checked.format,
        signer: checked.signer,
        placed,
        pieces,
        declared,
        tail: tail.unwrap_or(bytes.len()),
        facts: state.facts,
        viewers,
        gaps,
        ending,
        bytes,
    };
    if depth == Depth::Salvage {
        gaps::forget_bridged(&mut recording)?;
    }
    Ok(recording)
}
