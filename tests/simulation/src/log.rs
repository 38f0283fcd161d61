//! Events of a run: their hash, and the newest ones in words.

use std::collections::VecDeque;

use crate::faults::MS;

/// Time of the newest events that are kept in words, nanoseconds.
const KEPT_NS: u64 = 1000 * MS;
/// Largest number of events in words.
const MOST: usize = 400;

/// Events of one session.
pub struct Log {
    hasher: blake3::Hasher,
    newest: VecDeque<(u64, String)>,
}

impl Log {
    /// Log without events.
    pub fn new() -> Self {
        Self {
            hasher: blake3::Hasher::new(),
            newest: VecDeque::new(),
        }
    }

    /// Adds an event with its virtual time, nanoseconds, and its bytes to the hash.
    pub fn add(&mut self, at_ns: u64, kind: &str, bytes: &[u8]) {
        self.hasher.update(&at_ns.to_le_bytes());
        self.hasher.update(kind.as_bytes());
        self.hasher.update(&(bytes.len() as u64).to_le_bytes());
        self.hasher.update(bytes);
    }

    /// Adds an event in words.
    pub fn say(&mut self, at_ns: u64, text: String) {
        self.add(at_ns, "event", text.as_bytes());
        while self.newest.len() >= MOST
            || self
                .newest
                .front()
                .is_some_and(|(then, _)| then + KEPT_NS < at_ns)
        {
            self.newest.pop_front();
        }
        self.newest.push_back((at_ns, text));
    }

    /// Hash of all events so far.
    pub fn hash(&self) -> [u8; 32] {
        *self.hasher.finalize().as_bytes()
    }

    /// Lines of the newest second of events.
    pub fn lines(&self) -> Vec<String> {
        let line = |(at_ns, text): &(u64, String)| format!("{:.6} s  {text}", *at_ns as f64 / 1e9);
        self.newest.iter().map(line).collect()
    }
}

impl Default for Log {
    fn default() -> Self {
        Self::new()
    }
}
