//! Branch and bound: the largest value of a function over a surface, with a proven upper bound.
//!
//! Both distances of this module change by no more than the distance moved. If a point has the value `v`, no point
//! within `r` exceeds `v + r`.
//!
//! Cells whose bound is below the largest value found so far are dropped. The others are cut in four, the highest
//! bound first.
//!
//! Users: `max` and `max_at_most` in the table and the JSON of `sulcus-server tree`.

use std::cmp::{Ordering, Reverse};
use std::collections::BinaryHeap;

use sulcus_core::math::fmax;

use crate::parallel;

/// Largest difference between the value found and the bound at the end of the search, as a share of the value.
const RELATIVE: f64 = 0.002;
/// The same as a length, metres. The larger of both counts.
const ABSOLUTE: f64 = 5e-8;
/// Cells cut at a time. The number is fixed, so the result does not depend on the number of threads.
const BATCH: usize = 256;

/// Result of the examination of one cell.
pub(super) struct Examined {
    /// Value at a counting point of the cell, if one was examined.
    pub(super) attained: Option<f64>,
    /// Upper bound over the counting points of the cell; `None` if no point counts.
    pub(super) bound: Option<f64>,
}

/// Result of a search, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Largest {
    /// Largest value found.
    pub(super) attained: f64,
    /// Upper bound of all values.
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

/// Returns the largest value over the cells `roots`.
///
/// - `examine` also receives the smallest bound of interest. A lower bound need not be exact.
/// - `split` also receives the bound of the cell that it cuts.
/// - `floor` is a value known to occur.
/// - `budget` is the number of cells that may be examined beyond the roots. If it is used up, `at_most` is the
///   remaining bound.
pub(super) fn largest<C: Send + Sync>(
    roots: Vec<C>,
    floor: f64,
    budget: usize,
    examine: impl Fn(&C, f64) -> Examined + Sync,
    split: impl Fn(&C, f64) -> [C; 4],
) -> Largest {
    let limit = roots.len() + budget;
    let mut best = floor;
    // Highest bound of the dropped cells.
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

/// Returns the bound above which a cell must be examined.
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
