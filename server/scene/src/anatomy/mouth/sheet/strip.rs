//! Columns of one side of the sheet, from the right end to the left one.

use sulcus_core::Vec3;

use super::Mouth;
use super::cell::Cell;
use super::gap::arc_angle;
use crate::mesh::implicit::ramp;

/// Columns of a side between two neighbours, by tooth from the midline backwards: about 0.35 mm apart at the margin.
const COLUMNS: [usize; 7] = [15, 16, 18, 18, 18, 25, 24];
/// Columns of a retromolar pad.
pub(super) const PAD: usize = 10;
/// Length that a turn of a radian counts for, mm: columns are denser where a margin is bent.
const DENSER: f64 = 0.9;
/// Samples of a margin for columns at equal lengths.
const FINE: usize = 160;

/// Uppermost point of a column.
#[derive(Clone, Copy)]
pub(super) enum Start {
    /// Point of a margin: place, angle, and height over the tooth's origin, mm.
    Margin { cell: usize, around: f64, z: f64 },
    /// Tip of a papilla, world, mm.
    Papilla(Vec3),
    /// End of the cap over the crest of a ridge, world, mm.
    Crest(Vec3),
}

/// Column from its uppermost point to the end of the sheet.
pub(super) struct Column {
    pub start: Start,
    /// Place along the line at the top and far below, mm.
    pub top: f64,
    pub low: f64,
    /// Nearness to a gap: 0 in the middle of a tooth, 1 at the papilla.
    pub papilla: f64,
    /// Share of the film between two margins: 0 over the middle of a root, 1 beside it.
    pub film: f64,
    /// Inflammation, 0 to 1.
    pub inflammation: f64,
}

/// Columns of a side, and the numbers of the columns in the gaps.
pub(super) struct Strip {
    pub columns: Vec<Column>,
    pub gaps: Vec<usize>,
}

/// Columns of a side (0 facial, 1 lingual).
pub(super) fn strip(mouth: &Mouth<'_>, side: usize) -> Strip {
    let (mut columns, mut gaps) = (Vec::new(), Vec::new());
    let ends = [mouth.gaps[0].s, mouth.gaps[mouth.cells.len()].s];
    let way = [1.0, -1.0][side];
    let crest = |s: f64| Column {
        start: Start::Crest(mouth.ridge.cap(&mouth.line, &mouth.faces, s, way)),
        top: s,
        low: s,
        papilla: 0.0,
        film: 0.0,
        inflammation: 0.0,
    };
    let half = mouth.line.half();
    let pad = |k: usize, end: f64| end + (end.signum() * half - end) * k as f64 / PAD as f64;
    columns.extend((1..=PAD).rev().map(|k| crest(pad(k, ends[0]))));
    for k in 0..=mouth.cells.len() {
        gaps.push(columns.len());
        columns.push(in_gap(mouth, k, side));
        let Some(cell) = mouth.cells.get(k) else {
            break;
        };
        let count = COLUMNS[cell.kind()];
        let (from, to) = (mouth.gaps[k].s, mouth.gaps[k + 1].s);
        let low = |j: usize| from + (to - from) * (j + 1) as f64 / (count + 1) as f64;
        if cell.visible.is_none() {
            columns.extend((0..count).map(|j| crest(low(j))));
            continue;
        }
        for (j, around) in angles(cell, side, count).into_iter().enumerate() {
            let z = cell.margin(around);
            let at = cell.world(around, cell.surface(around, z), z);
            let aside = (2.0 * (low(j) - from) / (to - from) - 1.0).abs();
            columns.push(Column {
                start: Start::Margin { cell: k, around, z },
                top: mouth.line.of(&at)[0],
                low: low(j),
                papilla: ramp(aside, 0.45, 0.95),
                film: ramp(aside, 0.12, 0.5),
                inflammation: shared(mouth, k, low(j)),
            });
        }
    }
    columns.extend((1..=PAD).map(|k| crest(pad(k, ends[1]))));
    Strip { columns, gaps }
}

fn in_gap(mouth: &Mouth<'_>, k: usize, side: usize) -> Column {
    let gap = &mouth.gaps[k];
    let tip = gap.saddle[if side == 0 { 0 } else { gap.saddle.len() - 1 }];
    let beside = [k.checked_sub(1), Some(k)].map(|c| c.and_then(|c| mouth.cells.get(c)));
    let teeth = beside
        .iter()
        .flatten()
        .filter(|cell| cell.visible.is_some());
    let own: Vec<f64> = teeth.map(|cell| cell.inflammation()).collect();
    let is_between_teeth = own.len() == 2;
    Column {
        start: if is_between_teeth {
            Start::Papilla(tip)
        } else {
            Start::Crest(tip)
        },
        top: gap.s,
        low: gap.s,
        papilla: if is_between_teeth { 1.0 } else { 0.0 },
        film: if is_between_teeth { 1.0 } else { 0.0 },
        inflammation: own.iter().sum::<f64>() / own.len().max(1) as f64,
    }
}

/// Inflammation at a place beside tooth `k`: papillae have the mean of both neighbours.
fn shared(mouth: &Mouth<'_>, k: usize, s: f64) -> f64 {
    let own = mouth.cells[k].inflammation();
    let (from, to) = (mouth.gaps[k].s, mouth.gaps[k + 1].s);
    let (near, other) = if s < 0.5 * (from + to) {
        (s - from, k.checked_sub(1))
    } else {
        (to - s, Some(k + 1))
    };
    let other = other
        .and_then(|k| mouth.cells.get(k))
        .filter(|cell| cell.visible.is_some());
    let other = other.map_or(own, |cell| cell.inflammation());
    let share = 0.5 * (1.0 - ramp(near, 0.0, 1.6));
    own + (other - own) * share
}

/// Angle between two directions, radians; small angles only.
fn angle(a: &Vec3, b: &Vec3) -> f64 {
    a.cross(b).norm() / (a.norm() * b.norm()).max(1e-12)
}

/// Angles at equal lengths along a tooth's margin on a side, from smaller to larger `s`, both peaks included.
fn angles(cell: &Cell<'_>, side: usize, count: usize) -> Vec<f64> {
    let way = [1.0, -1.0][side];
    let low = cell.low_end();
    let from = arc_angle(cell, low, way);
    let to = arc_angle(cell, 1 - low, way);
    let turn = |k: usize| from + (to - from) * k as f64 / FINE as f64;
    let point = |k: usize| {
        let z = cell.margin(turn(k));
        cell.world(turn(k), cell.tooth.sections.radius(turn(k), z), z)
    };
    let mut length = vec![0.0];
    for k in 1..=FINE {
        let step = point(k) - point(k - 1);
        let turned = if k > 1 {
            angle(&(point(k - 1) - point(k - 2)), &step)
        } else {
            0.0
        };
        length.push(length[k - 1] + step.norm() + DENSER * turned);
    }
    let mut at = 0;
    (0..count)
        .map(|j| {
            if j + 1 == count {
                return to;
            }
            let wanted = length[FINE] * j as f64 / (count - 1) as f64;
            while at + 1 < FINE && length[at + 1] < wanted {
                at += 1;
            }
            let share = (wanted - length[at]) / (length[at + 1] - length[at]).max(1e-9);
            from + (to - from) * (at as f64 + share) / FINE as f64
        })
        .collect()
}
