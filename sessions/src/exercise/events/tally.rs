//! Counts of events.

use super::kinds::{ANGLE, KINDS};
use super::sight::View;
use crate::record::occurrence::Occurrence;

/// Counts of a session.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Tally {
    counts: [u64; KINDS.len()],
    /// Number of times that the tilt became wrong.
    pub wrong_angles: u64,
    /// Number of evaluations of sight.
    pub looks: u64,
    /// Number of evaluations with a visible target.
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
            self.wrong_angles += u64::from(one.kind == ANGLE && one.data["right"] == false);
        }
    }

    pub(super) fn seen(&mut self, view: &View, visible: bool) {
        self.looks += 1;
        self.visible += u64::from(visible);
        self.free += view.free;
        self.free_past_mirror += view.free_past_mirror;
    }

    /// Kinds with their counts, in the order of [`KINDS`].
    pub fn counts(&self) -> impl Iterator<Item = (&'static str, u64)> + '_ {
        KINDS.into_iter().zip(self.counts)
    }

    /// Mean share of the target that the tongue leaves free, and that tongue and mirror leave free; `None` without a
    /// target.
    pub fn mean_free(&self) -> Option<(f64, f64)> {
        let n = self.looks as f64;
        (self.looks > 0).then(|| (self.free / n, self.free_past_mirror / n))
    }

    /// Share of the time with a visible target; `None` without a target.
    pub fn visible_share(&self) -> Option<f64> {
        (self.looks > 0).then(|| self.visible as f64 / self.looks as f64)
    }
}
