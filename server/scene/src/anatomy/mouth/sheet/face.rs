//! Outer faces of the soft tissue on the jaw: distance from the line of the arch by place and height.
//!
//! A face is a smooth curve through the middles of the roots with their wall, as simulated, less a furrow between
//! neighbours. A root that stands out farther lifts the face over itself.

use std::f64::consts::{FRAC_PI_2, PI};

use sulcus_core::math::{fclamp, fmax};

use super::cell::Cell;
use super::line::{BEHIND, Line, SIDE};
use super::sizes;
use crate::mesh::implicit::{ramp, smooth_max, through};
use crate::parallel;

/// Heights of the tables in the world, mm, and distance between rows.
const LOW: f64 = -20.0;
const HIGH: f64 = 11.0;
const ROW: f64 = 0.5;
/// Distance between columns of the tables, mm.
const STEP: f64 = 0.4;
/// Angles of a tooth's outline on a side.
const ANGLES: usize = 21;
/// Height over the tooth's origin below which a simulated face is vertical, mm.
const STRAIGHT: f64 = -5.0;
/// Height over the tooth's origin above which the crown's bulge does not lift the face, mm. Chosen.
const NECK: f64 = 0.3;
/// Share of the narrowing below the neck that tissue fills. Chosen.
const FILLED: f64 = 0.6;
/// Least thickness of tissue over a root, mm, and rounding where a root lifts the face, mm. Chosen.
const LEAST: f64 = 0.7;
const ROUND: f64 = 0.6;
/// Thinning of a ridge without its tooth, mm. Chosen.
const RESORBED: f64 = 0.7;
/// Half width of the retromolar pad 0, 3, 7 and 12 mm behind the last tooth and at the end, mm: a pear (chosen).
const PAD: [[f64; 5]; 2] = [[0.0, 3.0, 7.0, 12.0, BEHIND], [4.8, 4.6, 5.2, 5.0, 4.6]];

/// Faces towards the lip (0) and towards the tongue (1).
pub(super) struct Faces {
    half: f64,
    columns: usize,
    /// Distances by side, row and column, mm.
    table: [Vec<Vec<f64>>; 2],
}

impl Faces {
    /// Faces of the mouth.
    pub fn new(line: &Line, cells: &[Cell<'_>]) -> Self {
        let half = line.half();
        let columns = (2.0 * half / STEP) as usize + 2;
        let rows = ((HIGH - LOW) / ROW) as usize + 1;
        let made = parallel::map(rows, |row| {
            let z = LOW + ROW * row as f64;
            [0, 1].map(|side| row_of(line, cells, side, z, columns))
        });
        let table = [0, 1].map(|side| made.iter().map(|row| row[side].clone()).collect());
        Self {
            half,
            columns,
            table,
        }
    }

    /// Distance of a face from the line at a place and a height in the world, mm.
    pub fn at(&self, side: usize, s: f64, z: f64) -> f64 {
        let rows = &self.table[side];
        let row = fclamp((z - LOW) / ROW, 0.0, (rows.len() - 1) as f64);
        let column = fclamp((s + self.half) / STEP, 0.0, (self.columns - 1) as f64);
        let (k, j) = (
            (row as usize).min(rows.len() - 2),
            (column as usize).min(self.columns - 2),
        );
        let (f, g) = (row - k as f64, column - j as f64);
        let on = |row: &[f64]| row[j] + (row[j + 1] - row[j]) * g;
        let (a, b) = (on(&rows[k]), on(&rows[k + 1]));
        a + (b - a) * f
    }
}

/// Outline of a tooth on a side at a height: places along the line and distances from the line, and the place and
/// distance of the middle.
struct Outline {
    points: Vec<[f64; 2]>,
    middle: [f64; 2],
    wall: f64,
    above: f64,
}

fn outline(line: &Line, cell: &Cell<'_>, side: usize, z: f64) -> Outline {
    let way = [1.0, -1.0][side];
    // Half of the waist below the crown is filled.
    let radius = |turn: f64, height: f64| {
        let of = |z: f64| cell.tooth.sections.radius(turn, z);
        let (neck, there) = (of(NECK), of(fclamp(height, STRAIGHT, NECK)));
        there + FILLED * fmax(neck - there, 0.0)
    };
    let point = |turn: f64| {
        let height = cell.height_at(turn, z, |height| radius(turn, height));
        let at = cell.world(turn, radius(turn, height), height);
        let [s, d] = line.of(&at);
        ([s, way * d], height)
    };
    let points: Vec<[f64; 2]> = (0..ANGLES)
        .map(|k| point(way * (0.15 + (PI - 0.3) * k as f64 / (ANGLES - 1) as f64)).0)
        .collect();
    let ([s, d], height) = point(way * FRAC_PI_2);
    // A level section of a leaning wall is thicker than the wall.
    let thick = sizes::WALL + sizes::THICKENING * fmax(-height, 0.0);
    let thick = thick / cell.tooth.frame.axis.z;
    let lost = if cell.visible.is_some() {
        0.0
    } else {
        RESORBED
    };
    Outline {
        points,
        middle: [s, d - lost],
        wall: thick,
        above: height,
    }
}

fn row_of(line: &Line, cells: &[Cell<'_>], side: usize, z: f64, columns: usize) -> Vec<f64> {
    let outlines: Vec<Outline> = cells
        .iter()
        .map(|cell| outline(line, cell, side, z))
        .collect();
    let knots: [f64; 2 * SIDE] = std::array::from_fn(|k| outlines[k].middle[0]);
    let reach: [f64; 2 * SIDE] = std::array::from_fn(|k| outlines[k].middle[1] + outlines[k].wall);
    let half = line.half();
    (0..columns)
        .map(|column| {
            let s = -half + STEP * column as f64;
            let curve = through(&knots, &reach, s);
            let behind = s.abs() - line.knots[SIDE];
            if behind > 0.0 {
                let pad = through::<5>(&PAD[0], &PAD[1], behind);
                // The pad widens downwards to the breadth of the jaw.
                let low = ramp(3.0 - z, 0.0, 12.0);
                let pad = pad + low * fmax(curve - pad, 0.0);
                return curve + (pad - curve) * ramp(behind, -0.5, 4.0);
            }
            let k = (0..2 * SIDE)
                .find(|k| s < line.knot(k + 2))
                .unwrap_or(2 * SIDE - 1);
            let face = curve - furrow(line, cells, k, side, s, &outlines);
            let near = k.saturating_sub(1)..(k + 2).min(2 * SIDE);
            near.fold(face, |face, k| match over(&outlines[k].points, s) {
                Some(d) if cells[k].visible.is_some() => smooth_max(face, d + LEAST, ROUND),
                _ => face,
            })
        })
        .collect()
}

/// Depth of the furrow beside a root, mm: nothing over the root's middle, the whole relief between neighbours.
fn furrow(
    line: &Line,
    cells: &[Cell<'_>],
    k: usize,
    side: usize,
    s: f64,
    outlines: &[Outline],
) -> f64 {
    let (low, high) = (line.knot(k + 1), line.knot(k + 2));
    let middle = 0.5 * (low + high);
    let aside = fclamp((s - middle).abs() / (0.5 * (high - low)), 0.0, 1.0);
    let fades = sizes::FADES.map(|below| below - sizes::HEALTHY);
    let of = |k: usize| {
        let share = 1.0 - ramp(-outlines[k].above, fades[0], fades[1]);
        sizes::RELIEF[cells[k].kind()] * [1.0, 0.6][side] * share
    };
    let beside = if s < middle {
        k.saturating_sub(1)
    } else {
        (k + 1).min(cells.len() - 1)
    };
    0.5 * (of(k) + of(beside)) * ramp(aside, 0.0, 1.0)
}

/// Distance of an outline at a place along the line: the farthest of its pieces.
fn over(points: &[[f64; 2]], s: f64) -> Option<f64> {
    let mut farthest: Option<f64> = None;
    for pair in points.windows(2) {
        let ([a, da], [b, db]) = (pair[0], pair[1]);
        if (a - s) * (b - s) > 0.0 || a == b {
            continue;
        }
        let d = da + (db - da) * (s - a) / (b - a);
        if farthest.is_none_or(|farthest| d > farthest) {
            farthest = Some(d);
        }
    }
    farthest
}
