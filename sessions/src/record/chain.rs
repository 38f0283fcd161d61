//! Chain of hashes over the exact record.
//!
//! A hash alone proves nothing, because an editor could run the simulation again and rewrite all hashes. So the station
//! signs the head of the chain every ten seconds and at the end.

use crate::record::statement::Statement;

/// Kind of the message that a link of the chain covers. The kind is part of the hashed bytes, so a message of one kind
/// cannot replace a message of another kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Link {
    Row = 1,
    Snapshot = 2,
    Event = 3,
}

/// Running head, `head = blake3(head || kind || inner bytes)`. The first head is the digest of the header.
#[derive(Clone, Debug)]
pub(crate) struct Chain {
    head: [u8; 32],
    rows: u64,
    tick: u64,
}

impl Chain {
    pub fn new(header_digest: [u8; 32]) -> Self {
        Self {
            head: header_digest,
            rows: 0,
            tick: 0,
        }
    }

    /// Chain that continues from a stated head.
    pub fn from_statement(says: &Statement) -> Self {
        Self {
            head: says.head,
            rows: says.rows,
            tick: says.tick,
        }
    }

    /// Adds a message. `tick` is the tick of a row or snapshot; without a tick the chain keeps the last one.
    pub fn add(&mut self, link: Link, tick: Option<u64>, message: &[u8]) {
        let mut hasher = blake3::Hasher::new();
        hasher
            .update(&self.head)
            .update(&[link as u8])
            .update(message);
        self.head = *hasher.finalize().as_bytes();
        self.tick = tick.unwrap_or(self.tick);
        self.rows += u64::from(link == Link::Row);
    }

    pub fn rows(&self) -> u64 {
        self.rows
    }

    pub fn tick(&self) -> u64 {
        self.tick
    }

    pub fn head(&self) -> &[u8; 32] {
        &self.head
    }
}
