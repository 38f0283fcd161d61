//! How often things happened.

use super::KINDS;
use super::sight::View;
use crate::record::occurrence::Occurrence;

/// Counts of a session.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Tally {
    counts: [u64; KINDS.len()],
    /// Times that the tilt became wrong.
    pub wrong_angles: u64,
    /// Times that sight was evaluated.
    pub looks: u64,
    /// Of them the target was visible.
    pub visible: u64,
    free: f64,
    free_past_mirror: f64,
}

impl Tally {
    pub(super) fn count(&mut self, said: &[Occurrence]) {
        for one in said {
            if let Some(k) = KINDS.iter().position(|kind| *kind == one.kind) {
                self.counts[k] += 1;
            }
            self.wrong_angles += u64::from(one.kind == KINDS[2] && one.data["right"] == false);
        }
    }

    pub(super) fn seen(&mut self, view: &View, visible: bool) {
        self.looks += 1;
        self.visible += u64::from(visible);
        self.free += view.free;
        self.free_past_mirror += view.free_past_mirror;
    }

    /// Kinds and how many of each, in the order of [`KINDS`].
    pub fn counts(&self) -> impl Iterator<Item = (&'static str, u64)> + '_ {
        KINDS.into_iter().zip(self.counts)
    }

    /// How many of a kind.
    pub fn of(&self, kind: &str) -> u64 {
        let found = self.counts().find(|(name, _)| *name == kind);
        found.map_or(0, |(_, count)| count)
    }

    /// Mean share of the target that the tongue left free, and that tongue and mirror did; none where there was no target.
    pub fn mean_free(&self) -> Option<(f64, f64)> {
        let n = self.looks as f64;
        (self.looks > 0).then(|| (self.free / n, self.free_past_mirror / n))
    }

    /// Share of the time in which the target was visible.
    pub fn visible_share(&self) -> Option<f64> {
        (self.looks > 0).then(|| self.visible as f64 / self.looks as f64)
    }
}
