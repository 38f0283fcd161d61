//! Fairing of the papillae: the faces between two margins become a smooth film, as of soap, over the gap.

use sulcus_core::Vec3;
use sulcus_core::math::fmax;

use super::path::{GINGIVA, WALL};
use super::strip::Strip;
use super::{Mark, Mouth};
use crate::mesh::implicit::ramp;

/// Rounds of the relaxation, and share of the way in each.
const ROUNDS: usize = 60;
const WAY: f64 = 0.7;
/// Depths between which the fairing ends, mm.
const ENDS: [f64; 2] = [5.0, 8.0];

/// Rounds of the final smoothing of all points below the margin, and share of the way in each.
const SOFT: usize = 24;
const GENTLE: f64 = 0.45;

/// Moves the points of a side's columns towards lip or tongue until each lies between its neighbours. Margins stay.
pub(super) fn relax(mouth: &Mouth<'_>, strip: &Strip, points: &mut [Vec<(Vec3, Mark)>]) {
    let film = |c: usize, mark: &Mark| {
        WAY * strip.columns[c].film * (1.0 - ramp(mark.below, ENDS[0], ENDS[1]))
    };
    let out: Vec<Vec3> = strip
        .columns
        .iter()
        .map(|column| mouth.line.at(column.low, 1.0, 0.0) - mouth.line.at(column.low, 0.0, 0.0))
        .collect();
    rounds(ROUNDS, &out, points, 2..=GINGIVA, film);
    // Swelling and relief are broader than this smoothing reaches.
    rounds(SOFT, &out, points, 3..=GINGIVA + WALL + 2, |_, _| GENTLE);
}

/// Moves the points of some rows, each a share of the way to the mean of its neighbours.
fn rounds(
    count: usize,
    out: &[Vec3],
    points: &mut [Vec<(Vec3, Mark)>],
    rows: std::ops::RangeInclusive<usize>,
    share: impl Fn(usize, &Mark) -> f64,
) {
    let moving: Vec<(usize, usize, f64)> = (1..points.len() - 1)
        .flat_map(|c| rows.clone().map(move |row| (c, row)))
        .map(|(c, row)| (c, row, share(c, &points[c][row].1)))
        .filter(|(_, _, share)| *share > 0.0)
        .collect();
    for _ in 0..count {
        for &(c, row, share) in &moving {
            let at = points[c][row].0;
            let beside = [
                points[c - 1][row].0,
                points[c + 1][row].0,
                points[c][row - 1].0,
                points[c][row + 1].0,
            ];
            let (mut sum, mut weights) = (0.0, 0.0);
            for other in beside {
                let weight = 1.0 / fmax((other - at).norm(), 0.05);
                sum += weight * (other - at).dot(&out[c]);
                weights += weight;
            }
            points[c][row].0 += out[c] * (share * sum / weights);
        }
    }
}
