//! The largest value of a function over a surface, found with certainty: branch and bound.
//!
//! All distances measured here change by no more than the way gone. So around a point whose value
//! is `v` nothing within `r` is above `v + r`: cells whose bound is below the largest value found so
//! far are dropped, the others are cut in four, the most promising first.

use std::cmp::{Ordering, Reverse};
use std::collections::BinaryHeap;

use sulcus_core::math::fmax;

use crate::parallel;

/// The search ends when nothing can be above the value found by more than this share of it ...
const RELATIVE: f64 = 0.002;
/// ... or this, metres.
const ABSOLUTE: f64 = 5e-8;
/// Cells cut at a time; fixed, so that the answer does not depend on the number of threads.
const BATCH: usize = 256;

/// What is known of one cell.
pub(super) struct Examined {
    /// Value at a point of the cell that counts, if one was looked at.
    pub(super) attained: Option<f64>,
    /// No point of the cell that counts is above it; `None`: no point of the cell counts.
    pub(super) bound: Option<f64>,
}

/// The answer, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Largest {
    /// Largest value that was met.
    pub(super) attained: f64,
    /// No value is above it.
    pub(super) at_most: f64,
}

struct Open<C> {
    bound: f64,
    order: Reverse<usize>,
    cell: C,
}

impl<C> PartialEq for Open<C> {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}
impl<C> Eq for Open<C> {}
impl<C> PartialOrd for Open<C> {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}
impl<C> Ord for Open<C> {
    fn cmp(&self, other: &Self) -> Ordering {
        let bound = self.bound.total_cmp(&other.bound);
        bound.then(self.order.cmp(&other.order))
    }
}

/// The largest value over the cells `roots`. `examine` also gets the value that matters: a bound below
/// it is as good as any other. `split` also gets the bound of the cell that it cuts. `floor` is a value
/// known to be met, `budget` how many cells may be examined beyond the roots; when it runs out, `at_most`
/// says what is still possible.
pub(super) fn largest<C: Send + Sync>(
    roots: Vec<C>,
    floor: f64,
    budget: usize,
    examine: impl Fn(&C, f64) -> Examined + Sync,
    split: impl Fn(&C, f64) -> [C; 4],
) -> Largest {
    let limit = roots.len() + budget;
    let mut best = floor;
    // The highest bound of what was dropped.
    let mut dropped = floor;
    let mut open = BinaryHeap::new();
    let mut cells = roots;
    let mut examined = 0;
    loop {
        let matters = enough(best);
        let found = parallel::map(cells.len(), |k| examine(&cells[k], matters));
        for attained in found.iter().filter_map(|found| found.attained) {
            best = fmax(best, attained);
        }
        let enough = enough(best);
        for (found, cell) in found.into_iter().zip(cells.drain(..)) {
            examined += 1;
            match found.bound {
                Some(bound) if bound > enough => open.push(Open {
                    bound,
                    order: Reverse(examined),
                    cell,
                }),
                Some(bound) => dropped = fmax(dropped, bound),
                None => {}
            }
        }
        while cells.len() < 4 * BATCH && examined + cells.len() < limit {
            match open.peek() {
                Some(top) if top.bound > enough => {}
                _ => break,
            }
            if let Some(top) = open.pop() {
                cells.extend(split(&top.cell, top.bound));
            }
        }
        if cells.is_empty() {
            let left = open.peek().map_or(dropped, |top| fmax(dropped, top.bound));
            return Largest {
                attained: best,
                at_most: fmax(best, left),
            };
        }
    }
}

/// What a bound must exceed for its cell to be looked into.
fn enough(best: f64) -> f64 {
    fmax(best * (1.0 + RELATIVE), best + ABSOLUTE)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Cells are intervals (from, to) of a line.
    fn on_a_line(f: impl Fn(f64) -> f64 + Sync, counts: fn(f64) -> bool, budget: usize) -> Largest {
        largest(
            vec![(0.0, 0.5), (0.5, 1.0)],
            0.0,
            budget,
            |&(a, b), _| {
                let (middle, half) = (0.5 * (a + b), 0.5 * (b - a));
                Examined {
                    attained: counts(middle).then(|| f(middle)),
                    bound: (counts(a) || counts(b)).then(|| f(middle) + half),
                }
            },
            |&(a, b), _| {
                let at = |k: f64| a + (b - a) * 0.25 * k;
                [0.0, 1.0, 2.0, 3.0].map(|k| (at(k), at(k + 1.0)))
            },
        )
    }

    #[test]
    fn finds_a_peak_that_samples_would_miss() {
        let peak = |x: f64| 0.1 + fmax(0.0, 0.001 - (x - 0.123_456).abs());
        let found = on_a_line(peak, |_| true, 1_000_000);
        assert!(
            found.attained > 0.1005 && found.attained <= 0.101,
            "{found:?}"
        );
        assert!(
            found.at_most >= 0.101 && found.at_most < 0.1016,
            "{found:?}"
        );
    }

    #[test]
    fn counts_only_what_counts_and_owns_up_when_the_budget_ends() {
        let slope = |x: f64| x;
        let half = on_a_line(slope, |x| x <= 0.7, 1_000_000);
        assert!((half.attained - 0.7).abs() < 0.0036 && half.at_most >= 0.7);
        let cut = on_a_line(|_| 0.25, |_| true, 8);
        assert_eq!(cut.attained, 0.25);
        assert!(cut.at_most > 0.27, "{cut:?}");
    }
}
