//! A part of a session.

use serde::Serialize;

use super::ReplayError;
use crate::record::message::Message;
use crate::record::read::Recording;

/// From when to when, in seconds of session time: a tick's number times the scene's seconds per tick, so that skipped
/// ticks count.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Span {
    /// Begins here; `None`: at the first row.
    pub from_s: Option<f64>,
    /// Ends here, this moment included; `None`: at the last row.
    pub to_s: Option<f64>,
}

/// What a [`Span`] is in a recording.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Part {
    /// The replay begins with the state after this tick: the last snapshot before the part.
    pub snapshot_tick: u64,
    /// First tick of the part. What lies between the snapshot and it is run, and compared, too.
    pub from_tick: u64,
    /// Last tick of the part.
    pub to_tick: u64,
}

impl Part {
    /// Whether the row of `tick` is run.
    pub(crate) fn runs(&self, tick: u64) -> bool {
        tick > self.snapshot_tick && tick <= self.to_tick
    }

    /// Whether the snapshot of `tick` is begun with or compared.
    pub(crate) fn looks_at(&self, tick: u64) -> bool {
        (self.snapshot_tick..=self.to_tick).contains(&tick)
    }

    /// Whether `tick` belongs to what was asked for.
    pub fn contains(&self, tick: u64) -> bool {
        (self.from_tick..=self.to_tick).contains(&tick)
    }
}

/// A moment that is a hair off a tick's own is meant to be that tick's.
const HAIR: f64 = 1e-6;

impl Span {
    /// Whether it is the whole session.
    pub fn is_all(&self) -> bool {
        *self == Self::default()
    }

    /// The part of `recording` that it is, at `tick_s` seconds per tick.
    ///
    /// # Errors
    /// When a number is none, the part is empty, or lies outside of the session; or the file changed meanwhile.
    pub fn part(&self, recording: &Recording, tick_s: f64) -> Result<Part, ReplayError> {
        let (first, last) = recording.facts().ticks.unwrap_or_default();
        let wrong = |field, found, expected: String| {
            Err(ReplayError::Span {
                field,
                found,
                expected,
            })
        };
        let (begins, ends) = (first as f64 * tick_s, last as f64 * tick_s);
        let (mut from_tick, mut to_tick) = (first, last);
        if let Some(from) = self.from_s {
            if !(0.0..=ends).contains(&from) {
                return wrong("from", from, format!("0 to {ends} s, the session's end"));
            }
            from_tick = ((from / tick_s - HAIR).ceil() as u64).max(first);
        }
        if let Some(to) = self.to_s {
            let least = self.from_s.unwrap_or(begins);
            let least = if begins > least { begins } else { least };
            if !(to >= least && to.is_finite()) {
                return wrong(
                    "to",
                    to,
                    format!("at least {least} s, where the part begins"),
                );
            }
            to_tick = ((to / tick_s + HAIR).floor() as u64).min(last);
        }
        if from_tick > to_tick {
            let expected = "a part that holds a tick".to_owned();
            return wrong("to", self.to_s.unwrap_or(ends), expected);
        }
        // All of it begins with the very first snapshot, and compares every other.
        let before = self.from_s.map_or(0, |_| from_tick);
        Ok(Part {
            snapshot_tick: snapshot_before(recording, before)?,
            from_tick,
            to_tick,
        })
    }
}

/// Tick of the last snapshot before `tick`; the first snapshot where there is none.
fn snapshot_before(recording: &Recording, tick: u64) -> Result<u64, ReplayError> {
    let mut found = None;
    for message in recording.messages() {
        match message? {
            Message::Snapshot { tick: of, .. } if found.is_none() || of < tick => found = Some(of),
            Message::Row(row) if row.tick >= tick => break,
            _ => {}
        }
    }
    // A recording's first row never comes before its first snapshot.
    Ok(found.unwrap_or_default())
}
