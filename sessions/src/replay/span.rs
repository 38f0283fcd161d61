//! Part of a session.

use serde::Serialize;

use super::error::ReplayError;
use crate::record::message::Message;
use crate::record::read::Recording;

/// Requested part of a session, in seconds of session time. Session time is the number of the tick times the scene's
/// seconds per tick, so skipped ticks count.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Span {
    /// Start; `None` for the first row.
    pub from_s: Option<f64>,
    /// End, inclusive; `None` for the last row.
    pub to_s: Option<f64>,
}

/// Ticks of a [`Span`] in a recording.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Part {
    /// Tick of the starting snapshot, the last one before the part.
    pub snapshot_tick: u64,
    /// First tick of the part. The ticks between the snapshot and the part are run and compared, too.
    pub from_tick: u64,
    /// Last tick of the part.
    pub to_tick: u64,
}

impl Part {
    /// Whether the row of `tick` is run.
    pub(crate) fn runs(&self, tick: u64) -> bool {
        tick > self.snapshot_tick && tick <= self.to_tick
    }

    /// Whether the snapshot of `tick` is compared or starts the replay.
    pub(crate) fn looks_at(&self, tick: u64) -> bool {
        (self.snapshot_tick..=self.to_tick).contains(&tick)
    }

    /// Whether `tick` belongs to the requested part.
    pub fn contains(&self, tick: u64) -> bool {
        (self.from_tick..=self.to_tick).contains(&tick)
    }
}

/// Tolerance of a time around a tick, in ticks.
const HAIR: f64 = 1e-6;

impl Span {
    /// Whether the span is the whole session.
    pub fn is_all(&self) -> bool {
        *self == Self::default()
    }

    /// Ticks of the span in `recording`, at `tick_s` seconds per tick.
    ///
    /// # Errors
    /// A number is NaN, the part is empty or outside of the session, or the file has changed.
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
                    format!("at least {least} s, the start of the part"),
                );
            }
            to_tick = ((to / tick_s + HAIR).floor() as u64).min(last);
        }
        if from_tick > to_tick {
            let expected = "a part with a tick".to_owned();
            return wrong("to", self.to_s.unwrap_or(ends), expected);
        }
        // The whole session starts from the first snapshot, and compares every other one.
        let before = self.from_s.map_or(0, |_| from_tick);
        Ok(Part {
            snapshot_tick: snapshot_before(recording, before)?,
            from_tick,
            to_tick,
        })
    }
}

/// Tick of the last snapshot before `tick`, else of the first snapshot.
fn snapshot_before(recording: &Recording, tick: u64) -> Result<u64, ReplayError> {
    let mut found = None;
    for message in recording.messages() {
        match message? {
            Message::Snapshot { tick: of, .. } if found.is_none() || of < tick => found = Some(of),
            Message::Row(row) if row.tick >= tick => break,
            _ => {}
        }
    }
    // In a valid recording the first snapshot precedes the first row.
    Ok(found.unwrap_or_default())
}
