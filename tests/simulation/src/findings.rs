//! Broken invariants of a session, beside the events that led to the first one.

use crate::invariants::{Broken, Watch};
use crate::known::known;
use crate::log::Log;
use crate::seen::Seen;

/// Largest number of broken invariants that a run keeps.
const MOST: usize = 20;

/// Log of a session, its watch, and the broken invariants so far.
pub struct Findings {
    /// Events.
    pub log: Log,
    watch: Watch,
    /// Broken invariants with their virtual times, nanoseconds; without the known faults.
    pub broken: Vec<(u64, Broken)>,
    /// First case of each known fault.
    pub known: Vec<(u64, Broken)>,
    /// Events of the second before the first broken invariant.
    lines: Option<Vec<String>>,
}

impl Findings {
    /// No findings yet.
    pub fn new(watch: Watch) -> Self {
        Self {
            log: Log::new(),
            watch,
            broken: Vec::new(),
            known: Vec::new(),
            lines: None,
        }
    }

    /// Shows an observation at `now_ns` of virtual time to the invariants.
    pub fn see(&mut self, now_ns: u64, seen: &Seen) {
        for broken in self.watch.see(now_ns, seen) {
            self.fail(now_ns, broken);
        }
    }

    /// Enters a broken invariant.
    pub fn fail(&mut self, now_ns: u64, broken: Broken) {
        if known(broken.number).is_some() {
            if self
                .known
                .iter()
                .all(|(_, before)| before.number != broken.number)
            {
                self.known.push((now_ns, broken));
            }
            return;
        }
        let text = format!("invariant {} is broken: {}", broken.number, broken.text);
        self.log.say(now_ns, text);
        if self.lines.is_none() {
            self.lines = Some(self.log.lines());
        }
        if self.broken.len() < MOST {
            self.broken.push((now_ns, broken));
        }
    }

    /// Events of the second before the first broken invariant, or before the end.
    pub fn lines(&self) -> Vec<String> {
        self.lines.clone().unwrap_or_else(|| self.log.lines())
    }
}
