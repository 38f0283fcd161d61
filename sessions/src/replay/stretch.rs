//! Stretches between the gaps of a recovered recording. Each stretch is replayed from its own snapshot.

use serde::Serialize;

use crate::record::gap::Gap;
use crate::record::message::Message;
use crate::record::row::Row;
use crate::record::signature::Signed;

/// Stretch of rows without a gap.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Stretch {
    /// First tick with a row.
    pub from_tick: u64,
    /// Last tick with a row.
    pub to_tick: u64,
    /// Tick of the starting snapshot; `None` without a snapshot, and then the stretch is not run.
    pub snapshot_tick: Option<u64>,
    /// Ticks run.
    pub ticks: u64,
    /// Rows before the snapshot, which are not run.
    pub not_run: u64,
    /// Whether every tick that was run is identical; false if no tick was run.
    pub identical: bool,
    /// First tick that differs.
    pub first_divergent_tick: Option<u64>,
    /// First and last tick of each signed part of the stretch.
    pub signed: Vec<(u64, u64)>,
}

impl std::fmt::Display for Stretch {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "ticks {} to {}: ", self.from_tick, self.to_tick)?;
        match (self.snapshot_tick, self.first_divergent_tick) {
            (None, _) => f.write_str("not run, no snapshot")?,
            (Some(_), None) if self.ticks == 0 => {
                f.write_str("not run, the snapshot is at the end")?
            }
            (Some(of), None) => write!(
                f,
                "identical, {} ticks from the snapshot of tick {of}",
                self.ticks
            )?,
            (Some(of), Some(tick)) => write!(
                f,
                "DIFFERS first at tick {tick}, {} ticks from the snapshot of tick {of}",
                self.ticks
            )?,
        }
        if self.not_run > 0 && self.snapshot_tick.is_some() {
            write!(f, ", {} before it not run", self.not_run)?;
        }
        match self.signed.as_slice() {
            [] => f.write_str("; no signed part"),
            parts => {
                let parts: Vec<String> = parts
                    .iter()
                    .map(|(from, to)| format!("{from} to {to}"))
                    .collect();
                write!(f, "; signed: {}", parts.join(", "))
            }
        }
    }
}

/// Stretches so far.
#[derive(Default)]
pub(super) struct Stretches {
    done: Vec<Stretch>,
    now: Stretch,
}

impl Stretches {
    /// Begins the next stretch.
    pub fn next(&mut self) {
        let before = std::mem::take(&mut self.now);
        if before.to_tick > 0 {
            self.done.push(before);
        }
    }

    pub fn row(&mut self, row: &Row, run: bool) {
        let now = &mut self.now;
        if now.to_tick == 0 {
            now.from_tick = row.tick;
        }
        now.to_tick = row.tick;
        if run {
            now.ticks += 1;
        } else {
            now.not_run += 1;
        }
    }

    pub fn begins_with(&mut self, snapshot_tick: u64) {
        self.now.snapshot_tick = Some(snapshot_tick);
    }

    pub fn differs(&mut self, tick: u64) {
        self.now.first_divergent_tick.get_or_insert(tick);
    }

    pub fn done(mut self, signed: &[Signed]) -> Vec<Stretch> {
        self.next();
        for stretch in &mut self.done {
            stretch.identical = stretch.ticks > 0 && stretch.first_divergent_tick.is_none();
            let parts = signed.iter().map(|signed| {
                (
                    stretch.from_tick.max(signed.after_tick + 1),
                    stretch.to_tick.min(signed.to_tick),
                )
            });
            stretch.signed = parts.filter(|(from, to)| from <= to).collect();
        }
        self.done
    }
}

/// Positions of the gaps among the messages.
pub(super) struct Gaps<'a> {
    gaps: std::iter::Peekable<std::slice::Iter<'a, Gap>>,
    messages: u64,
}

impl<'a> Gaps<'a> {
    pub fn new(gaps: &'a [Gap]) -> Self {
        Self {
            gaps: gaps.iter().peekable(),
            messages: 0,
        }
    }

    /// Whether a gap is right before this message.
    pub fn before(&mut self, _message: &Message) -> bool {
        let mut found = false;
        while self
            .gaps
            .next_if(|gap| gap.messages <= self.messages)
            .is_some()
        {
            found = true;
        }
        self.messages += 1;
        found
    }
}
