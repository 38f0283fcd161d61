//! Crest of the tissue where no tooth stands: healed ridges and the retromolar pads.

use sulcus_core::Vec3;
use sulcus_core::math::{fclamp, fmax};

use super::cell::Cell;
use super::face::Faces;
use super::line::{BEHIND, Line, SIDE};
use crate::mesh::implicit::through;

/// Height of a healed ridge over the junction of the missing tooth, and rise towards the neighbours, mm, as simulated.
const HEALED: f64 = -2.0;
const SADDLE: f64 = 0.8;
/// Share of the way to the papilla of a neighbouring tooth that a ridge climbs at its end. Chosen.
const CLIMBS: f64 = 0.6;
/// Places behind the last tooth and heights of the pad over that tooth's junction, mm: half of the crown's height on
/// the pad, then up into the fold to the upper jaw. Chosen.
const PAD: [[f64; 5]; 2] = [[0.0, 3.0, 7.0, 12.0, BEHIND], [1.6, 2.0, 3.4, 5.0, 8.0]];

/// Half width of the cap over the crest, and height of the rounding from crest to faces, mm. Chosen.
const CAP: f64 = 1.8;
const ROUND: f64 = 3.2;

/// Crest by place.
pub(super) struct Ridge {
    /// Heights at the ends of each place, world, mm, and the height in its middle.
    cells: Vec<[f64; 3]>,
    bounds: Vec<f64>,
    /// Middle between the faces, mm from the line, at each bound and in each middle.
    middles: Vec<f64>,
    behind: f64,
}

impl Ridge {
    /// Ridge of all places.
    pub fn new(line: &Line, cells: &[Cell<'_>], faces: &Faces) -> Self {
        let of = |cell: &Cell<'_>| {
            let base = cell.level(1.0, 0.0) + HEALED;
            [base + SADDLE, base, base + SADDLE]
        };
        let mut heights: Vec<[f64; 3]> = cells.iter().map(of).collect();
        // Neighbouring ridges meet at one height. Beside a tooth the ridge climbs towards the papilla.
        for k in 1..heights.len() {
            let beside = |k: usize, end: usize| {
                let papilla = cells[k].papilla(end);
                papilla.map(|[_, margin]| cells[k].level_of_end(end, margin))
            };
            let papillae = [
                beside(k - 1, 1 - cells[k - 1].low_end()),
                beside(k, cells[k].low_end()),
            ];
            let own = [heights[k - 1][2], heights[k][0]];
            let mean = match papillae {
                [None, None] => 0.5 * (own[0] + own[1]),
                [Some(papilla), _] => own[1] + CLIMBS * (papilla - own[1]),
                [None, Some(papilla)] => own[0] + CLIMBS * (papilla - own[0]),
            };
            (heights[k - 1][2], heights[k][0]) = (mean, mean);
        }
        let bounds: Vec<f64> = (0..=cells.len()).map(|k| line.knot(k + 1)).collect();
        let middles = (0..=2 * cells.len())
            .map(|k| {
                let s = 0.5 * (bounds[k / 2] + bounds[k.div_ceil(2)]);
                0.5 * (faces.at(0, s, -3.0) - faces.at(1, s, -3.0))
            })
            .collect();
        Self {
            behind: cells[2 * SIDE - 1].level(1.0, 0.0),
            cells: heights,
            bounds,
            middles,
        }
    }

    /// Height of the crest, world, mm.
    pub fn crest(&self, s: f64) -> f64 {
        let last = self.bounds[self.bounds.len() - 1];
        let behind = s.abs() - last;
        if behind >= 0.0 {
            return self.behind + through::<5>(&PAD[0], &PAD[1], behind);
        }
        let (k, share) = self.at(s);
        let [low, middle, high] = self.cells[k];
        let along = 2.0 * share - 1.0;
        let end = if along < 0.0 { low } else { high };
        let ridge = middle + (end - middle) * libm::pow(along.abs(), 2.6);
        // Up to the pad behind the last place.
        let pad = self.behind + PAD[1][0];
        let rise = fmax(1.0 - (last - s.abs()) / 3.0, 0.0);
        ridge + (pad - ridge) * rise * rise
    }

    /// Point of the rounded crest at a share of the way from its middle to the facial (1) or lingual (-1) end.
    pub fn cap(&self, line: &Line, faces: &Faces, s: f64, share: f64) -> Vec3 {
        let (middle, top) = (self.middle(s), self.crest(s));
        let drop = |share: f64| {
            let half = half(faces, s, middle, top, share);
            let out = fclamp(CAP * share / half, -1.0, 1.0);
            ROUND * (1.0 - fmax(1.0 - out * out, 0.0).sqrt())
        };
        line.at(s, middle + CAP * share, top - drop(share))
    }

    /// Share of the way from an end of the cap to the outer face at a depth below that end, 0 to 1. `rest` is the whole
    /// way, mm: an ellipse from the middle of the crest.
    pub fn ellipse(rest: f64, below: f64) -> f64 {
        let whole = CAP + rest;
        let out = fclamp(CAP / whole, 0.0, 1.0);
        let drop = ROUND * (1.0 - (1.0 - out * out).sqrt());
        let up = 1.0 - fclamp((below + drop) / ROUND, 0.0, 1.0);
        let at = whole * fmax(1.0 - up * up, 0.0).sqrt();
        fclamp((at - CAP) / fmax(rest, 1e-9), 0.0, 1.0)
    }

    /// Middle between the faces, mm from the line.
    pub fn middle(&self, s: f64) -> f64 {
        let last = self.bounds[self.bounds.len() - 1];
        if s.abs() >= last {
            let ends = self.middles.len() - 1;
            let at = self.middles[if s < 0.0 { 0 } else { ends }];
            return at * fmax(1.0 - (s.abs() - last) / 6.0, 0.0);
        }
        let (k, share) = self.at(s);
        let (j, f) = if share < 0.5 {
            (2 * k, 2.0 * share)
        } else {
            (2 * k + 1, 2.0 * share - 1.0)
        };
        self.middles[j] + (self.middles[j + 1] - self.middles[j]) * f
    }

    fn at(&self, s: f64) -> (usize, f64) {
        let n = self.cells.len();
        let k = (0..n).find(|k| s < self.bounds[k + 1]).unwrap_or(n - 1);
        let (a, b) = (self.bounds[k], self.bounds[k + 1]);
        (k, fclamp((s - a) / (b - a), 0.0, 1.0))
    }
}

/// Distance from the middle of the crest to the face on a share's side, mm.
fn half(faces: &Faces, s: f64, middle: f64, top: f64, share: f64) -> f64 {
    let whole = if share < 0.0 {
        faces.at(1, s, top) + middle
    } else {
        faces.at(0, s, top) - middle
    };
    fmax(whole, CAP)
}
