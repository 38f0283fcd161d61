//! Path of one column over the sheet: rim, free and attached gingiva, mucosa, then vestibule and lip, or the floor.

use sulcus_core::Vec3;
use sulcus_core::math::{fclamp, fmax, fmin};

use super::ridge::Ridge;
use super::strip::{Column, Start};
use super::{Mark, Mouth, Part, sizes};
use super::{floor, vestibule};
use crate::mesh::implicit::ramp;

/// Rows from the margin to the mucogingival line.
pub(super) const GINGIVA: usize = 12;
/// Rows from there down the wall, round the vestibule and along lip or cheek.
pub(super) const WALL: usize = 3;
pub(super) const ROUND: usize = 6;
pub(super) const LIP: usize = 5;
/// Rows from the lingual wall to the middle of the floor.
pub(super) const FLOOR: usize = 7;
/// Number of points of a column: facial and lingual.
pub(super) const POINTS: [usize; 2] =
    [GINGIVA + 1 + WALL + ROUND + LIP, GINGIVA + 1 + WALL + FLOOR];

/// Points of a column with their marks, world, mm.
pub(super) fn path(mouth: &Mouth<'_>, column: &Column, side: usize) -> Vec<(Vec3, Mark)> {
    let way = [1.0, -1.0][side];
    let surface = surface(mouth, &column.start);
    let from = place(mouth, &column.start, surface, 0.0);
    let line = fmin(
        mouth.levels.mucogingival(side, column.low),
        from.z - sizes::LEAST,
    );
    let whole = from.z - line;
    let mut points = Vec::with_capacity(POINTS[side]);
    let mark = |part: Part, below: f64, share: f64, dark: f64| Mark {
        part,
        lingual: side == 1,
        below,
        share,
        papilla: column.papilla,
        inflammation: column.inflammation,
        is_ridge: matches!(column.start, Start::Crest(_)),
        s: column.low,
        dark: fmax(dark, behind(mouth, column.low)),
    };
    let face = |s: f64, z: f64| mouth.line.at(s, way * mouth.faces.at(side, s, z), z);
    let first = face(column.top, from.z) - from;
    let reach = (first.x * first.x + first.y * first.y).sqrt();
    for row in 0..=GINGIVA {
        let below = depth(&column.start, whole, row);
        let share = below / whole;
        let at = place(mouth, &column.start, surface, below);
        if row == 0 {
            points.push((
                sunk(mouth, &column.start, surface),
                mark(Part::Gingiva, 0.0, 0.0, 0.0),
            ));
            continue;
        }
        let s = along(column, below);
        let away = face(s, at.z) - at;
        let length = fmax((away.x * away.x + away.y * away.y).sqrt(), 1e-9);
        let out = Vec3::new(away.x, away.y, 0.0) / length;
        let grown = length * thickness(&column.start, reach, below) + rim(column, below);
        points.push((at + out * grown, mark(Part::Gingiva, below, share, 0.0)));
    }
    if side == 0 {
        vestibule::outside(mouth, column, (from.z, line), &mark, &mut points);
    } else {
        floor::inside(mouth, column, (from.z, line), &mark, &mut points);
    }
    points
}

/// Distance of the tooth's surface from its axis at the start of a column, mm. The search takes longer than all other
/// steps of a column.
fn surface(mouth: &Mouth<'_>, start: &Start) -> f64 {
    match *start {
        Start::Margin { cell, around, z } => mouth.cells[cell].surface(around, z),
        Start::Papilla(_) | Start::Crest(_) => 0.0,
    }
}

/// Point of the tooth's surface, or under a papilla's tip, `below` mm under the start of a column.
fn place(mouth: &Mouth<'_>, start: &Start, surface: f64, below: f64) -> Vec3 {
    match *start {
        Start::Margin { cell, around, z } => {
            let cell = &mouth.cells[cell];
            let groove = surface - cell.tooth.sections.radius(around, z);
            // Down the leaning tooth, as far below the margin.
            let below = below / cell.tooth.frame.axis.z;
            let r = cell.tooth.sections.radius(around, z - below);
            cell.world(
                around,
                r + groove * (1.0 - ramp(below, 0.0, 1.0)),
                z - below,
            )
        }
        Start::Papilla(at) | Start::Crest(at) => at - Vec3::z() * below,
    }
}

/// First point of a column. At a margin it lies inside the tooth, so that no light passes.
fn sunk(mouth: &Mouth<'_>, start: &Start, surface: f64) -> Vec3 {
    match *start {
        Start::Margin { cell, around, z } => {
            mouth.cells[cell].world(around, surface - sizes::SUNK, z)
        }
        Start::Papilla(at) | Start::Crest(at) => at,
    }
}

/// Point of the first row at a margin.
pub(super) fn margin_point(mouth: &Mouth<'_>, cell: usize, around: f64, z: f64) -> Vec3 {
    let cell = &mouth.cells[cell];
    cell.world(around, cell.surface(around, z) - sizes::SUNK, z)
}

/// Depth of a row under the start of its column, mm. Rows are denser near the margin.
fn depth(start: &Start, whole: f64, row: usize) -> f64 {
    let exponent = if matches!(start, Start::Crest(_)) {
        1.6
    } else {
        1.4
    };
    match row {
        0 => 0.0,
        1 => 0.02,
        _ => whole * libm::pow((row - 1) as f64 / (GINGIVA - 1) as f64, exponent),
    }
}

/// Place along the line at a depth: columns spread evenly below the papillae.
fn along(column: &Column, below: f64) -> f64 {
    column.top + (column.low - column.top) * ramp(below, 0.0, 4.0)
}

/// Share of the way from the tooth to the outer face at a depth, 0 to 1. `reach` is that way at the margin, mm.
fn thickness(start: &Start, reach: f64, below: f64) -> f64 {
    if matches!(start, Start::Crest(_)) {
        return Ridge::ellipse(reach, below);
    }
    let whole = fclamp(1.5 * reach, 1.6, 4.5);
    1.0 - libm::pow(1.0 - fclamp(below / whole, 0.0, 1.0), 1.6)
}

/// Thickness added by the round margin and by swelling, mm.
fn rim(column: &Column, below: f64) -> f64 {
    if matches!(column.start, Start::Crest(_)) {
        return 0.0;
    }
    let [radius, swelling] = sizes::swollen(column.inflammation);
    let up = 1.0 - fclamp(below / radius, 0.0, 1.0);
    let round = fmax(1.0 - up * up, 0.0).sqrt();
    let swelling = swelling * (1.0 + 0.25 * column.papilla);
    round * (sizes::RIM + swelling) * (1.0 - ramp(below, 0.8, 3.2))
}

/// Share of darkness behind the last tooth, 0 to 1: tissue fades into the dark of the throat.
fn behind(mouth: &Mouth<'_>, s: f64) -> f64 {
    let end = mouth.line.knots[super::line::SIDE];
    ramp(s.abs() - end, 7.0, super::line::BEHIND)
}

/// Makes the mark of a point: part, depth under the margin, share of the part, darkness.
pub(super) type Marker<'a> = &'a dyn Fn(Part, f64, f64, f64) -> Mark;
