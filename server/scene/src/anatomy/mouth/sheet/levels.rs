//! Heights of the mucogingival line and of the bottom of the vestibule along the arch.

use std::f64::consts::{FRAC_PI_2, PI};

use super::cell::{Cell, around};
use super::line::{Line, SIDE};
use super::sizes;
use crate::mesh::implicit::{bell, ramp, through};

/// Share of the margin's scallop that the mucogingival line follows.
const SCALLOP: f64 = 0.5;
/// Angle from the middle of a tooth's end at which its papilla is measured, radians.
const PAPILLA: f64 = 0.5;
/// Width of the firm tissue on the retromolar pad, mm. Chosen.
const PAD: f64 = 5.0;
/// Frena: place from the midline as the number of a contact, rise of the vestibule's bottom and half width, mm. Chosen:
/// a thin fin at the midline, broad bands beside the first premolars.
const FRENA: [(usize, f64, f64); 2] = [(0, 4.0, 1.1), (4, 2.6, 2.2)];

/// Heights along the arch, world, mm.
pub(super) struct Levels {
    middles: [f64; 2 * SIDE],
    bounds: Vec<f64>,
    /// Mucogingival line by side, in the middles and at the bounds.
    line: [(Vec<f64>, Vec<f64>); 2],
    bottom: [f64; 2 * SIDE],
    /// Healthy margins of both sides in the middles.
    margins: [[f64; 2 * SIDE]; 2],
    frena: Vec<(f64, f64, f64)>,
}

impl Levels {
    /// Heights of the mouth.
    pub fn new(line: &Line, cells: &[Cell<'_>]) -> Self {
        let bounds: Vec<f64> = (0..=cells.len()).map(|k| line.knot(k + 1)).collect();
        let margins = [1.0, -1.0].map(|way| {
            let of = |cell: &Cell<'_>| {
                cell.level(way, cell.tooth.shape.cej(way * FRAC_PI_2) + sizes::HEALTHY)
            };
            std::array::from_fn(|k| of(&cells[k]))
        });
        let lines = [0, 1].map(|side| {
            let widths = [sizes::FACIAL, sizes::LINGUAL][side];
            let margins: &[f64; 2 * SIDE] = &margins[side];
            let middles: Vec<f64> = (0..cells.len())
                .map(|k| margins[k] - widths[cells[k].kind()] * cells[k].tooth.frame.axis.z)
                .collect();
            let amplitude = |k: usize, end: usize| {
                let turn = around(end, [1.0, -1.0][side], PAPILLA);
                let papilla = cells[k].tooth.shape.cej(turn) - sizes::HEALTHY_PROXIMAL;
                cells[k].level_at(turn, papilla) - margins[k]
            };
            let at_bounds = (0..=cells.len())
                .map(|k| {
                    let before = (k > 0).then(|| (k - 1, 1 - cells[k - 1].low_end()));
                    let after = (k < cells.len()).then(|| (k, cells[k].low_end()));
                    let both: Vec<f64> = before
                        .into_iter()
                        .chain(after)
                        .map(|(k, end)| middles[k] + SCALLOP * amplitude(k, end))
                        .collect();
                    both.iter().sum::<f64>() / both.len() as f64
                })
                .collect();
            (middles, at_bounds)
        });
        let frena = FRENA.iter().flat_map(|(knot, rise, width)| {
            let s = line.knots[*knot];
            let both = [(s, *rise, *width), (-s, *rise, *width)];
            both.into_iter().take(if *knot == 0 { 1 } else { 2 })
        });
        Self {
            middles: std::array::from_fn(|k| 0.5 * (bounds[k] + bounds[k + 1])),
            bottom: std::array::from_fn(|k| margins[0][k] - sizes::VESTIBULE[cells[k].kind()]),
            line: lines,
            margins,
            frena: frena.collect(),
            bounds,
        }
    }

    /// Height of the mucogingival line of a healthy mouth on a side (0 facial, 1 lingual).
    pub fn mucogingival(&self, side: usize, s: f64) -> f64 {
        let (middles, at_bounds) = &self.line[side];
        let n = middles.len();
        let end = at_bounds[if s < 0.0 { 0 } else { n }];
        if s <= self.bounds[0] || s >= self.bounds[n] {
            let behind = s.abs() - self.bounds[n];
            return end + ramp(behind, 0.0, 9.0) * (end + PAD - end) * 0.3;
        }
        let k = (0..n).find(|k| s < self.bounds[k + 1]).unwrap_or(n - 1);
        let (bound, to) = if s < self.middles[k] {
            (k, self.bounds[k])
        } else {
            (k + 1, self.bounds[k + 1])
        };
        let share = (s - self.middles[k]) / (to - self.middles[k]);
        // A wave, level in the middles and at the bounds.
        let wave = 0.5 - 0.5 * libm::cos(PI * share);
        middles[k] + (at_bounds[bound] - middles[k]) * wave
    }

    /// Height of the bottom of the vestibule, and its rise over a frenum, mm.
    pub fn vestibule(&self, s: f64) -> [f64; 2] {
        let bottom = through(&self.middles, &self.bottom, s);
        let rises = self
            .frena
            .iter()
            .map(|(at, most, width)| most * bell(s - at, *width));
        [bottom, rises.sum()]
    }

    /// Height of a healthy margin on a side.
    pub fn margin(&self, side: usize, s: f64) -> f64 {
        through(&self.middles, &self.margins[side], s)
    }
}
