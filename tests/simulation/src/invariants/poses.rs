//! Epochs, poses and presence of the tools: invariants 8, 9 and 14.

use crate::seen::{Tick, Used};

use super::Found;
use super::bounds::Bounds;

/// Poses and epochs so far.
#[derive(Default)]
pub(super) struct Poses {
    /// Present epoch and its begin, nanoseconds.
    epoch: Option<(u32, u64)>,
    /// Epoch of the newest lost connection. Only a later pose brings the tools back.
    lost: Option<u32>,
    /// Epoch in which a pause ended last, and time of the end, nanoseconds.
    ended: Option<(u32, u64)>,
    /// Pose of the newest tick that had one.
    held: Option<Used>,
}

impl Poses {
    /// Present epoch, if one has begun.
    pub(super) fn epoch(&self) -> Option<u32> {
        self.epoch.map(|(epoch, _)| epoch)
    }

    /// Begins an epoch: a connection, or the end of a pause.
    pub(super) fn begin(&mut self, epoch: u32, at_ns: u64, found: &mut Found) {
        found.must(self.epoch().is_none_or(|before| epoch > before), 14, || {
            format!("epoch {epoch} after epoch {:?}", self.epoch())
        });
        self.epoch = Some((epoch, at_ns));
    }

    /// Takes the loss of a connection.
    pub(super) fn lose(&mut self) {
        self.lost = self.epoch();
    }

    /// Takes the end of a pause. `Command::Resume`: a new session epoch begins.
    pub(super) fn end_pause(&mut self, at_ns: u64) {
        self.ended = self.epoch().map(|epoch| (epoch, at_ns));
    }

    /// Judges pose and tools of a tick.
    pub(super) fn tick(&mut self, bounds: &Bounds, at_ns: u64, tick: &Tick, found: &mut Found) {
        let number = tick.tick;
        for (tool, _) in tick
            .present
            .iter()
            .enumerate()
            .filter(|(_, is_present)| **is_present)
        {
            found.must(tool < bounds.facts.tools, 9, || {
                format!(
                    "tick {number}: tool {tool} is present; the scene has {} tools",
                    bounds.facts.tools
                )
            });
            let is_back = tick
                .used
                .is_some_and(|used| self.lost.is_none_or(|lost| used.epoch > lost));
            found.must(is_back, 9, || {
                format!(
                    "tick {number}: tool {tool} is present with pose {:?}; lost connection: epoch {:?}",
                    tick.used, self.lost
                )
            });
        }
        let Some(used) = tick.used else { return };
        found.must(
            used.measured_ns <= used.arrived_ns && used.arrived_ns <= at_ns,
            8,
            || format!("tick {number} at {at_ns} ns: a pose from the future, {used:?}"),
        );
        // A missing pose is an old pose with a growing age. It may stand over the end of a pause.
        if self.held != Some(used) {
            self.take_up(number, used, found);
        }
        self.held = Some(used);
    }

    /// Judges a pose that the tick is the first to use.
    ///
    /// The server drops poses of another epoch on arrival. A pose that came before an epoch may stand in it.
    fn take_up(&self, tick: u64, used: Used, found: &mut Found) {
        let is_present = self.epoch.is_some_and(|(epoch, begin_ns)| {
            used.epoch == epoch || used.epoch < epoch && used.arrived_ns <= begin_ns
        });
        found.must(is_present, 8, || {
            format!(
                "tick {tick}: {used:?}; epoch and its begin: {:?}",
                self.epoch
            )
        });
        let is_later = self
            .ended
            .is_none_or(|(epoch, end_ns)| used.epoch > epoch || used.arrived_ns <= end_ns);
        found.must(is_later, 14, || {
            format!(
                "tick {tick}: {used:?}; epoch and time of an ended pause: {:?}",
                self.ended
            )
        });
        if let Some(held) = self.held.filter(|held| held.epoch == used.epoch) {
            found.must(used.number > held.number, 8, || {
                format!(
                    "tick {tick}: pose {} after pose {} of epoch {}",
                    used.number, held.number, used.epoch
                )
            });
        }
    }
}
