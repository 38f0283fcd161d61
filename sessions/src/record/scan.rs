//! The first pass over a recording: its header, then every chunk once, then how it ends.
//!
//! Any legal arrangement of an MCAP file is read: attachments and metadata before, between and behind the messages, chunks of
//! any size up to a bound and of any compression, messages outside of chunks, with or without index and summary.

mod head;
mod pass;
mod salvage;
mod unpack;

use std::sync::Arc;

use crate::record::read::{Bytes, ReadError, Recording};
use crate::record::viewers::Viewers;
use crate::record::walk::Walk;

pub(crate) use unpack::{Topics, unpack};

use head::Head;
use pass::Pass;

/// How far a file is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Depth {
    /// Up to the first damage.
    Strict,
    /// Every whole chunk, behind any damage too: for a recovery.
    Salvage,
}

/// Reads and checks everything once.
pub(crate) fn scan(bytes: Arc<Bytes>, depth: Depth) -> Result<Recording, ReadError> {
    let mut walk = Walk::new(&bytes).ok_or(ReadError::NotMcap)?;
    let head = Head::read(walk.clone())?;
    let checked = head.check()?;
    let mut pass = Pass::new(&head, depth);
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
        Depth::Salvage => salvage::with_former(state.gaps, head.gaps(), state.messages),
    };
    let placed = head.placed.iter().copied().collect();
    let mut recording = Recording {
        header: checked.header,
        header_digest: checked.digest,
        migration: checked.migration,
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
        salvage::forget_bridged_gaps(&mut recording)?;
    }
    Ok(recording)
}
