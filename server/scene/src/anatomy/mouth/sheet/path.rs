//! Path of one column over the sheet: rim, free and attached gingiva, mucosa, then vestibule and lip, or the floor.

use std::f64::consts::PI;

use sulcus_core::Vec3;
use sulcus_core::math::{fclamp, fmax, fmin};

use super::floor;
use super::ridge::Ridge;
use super::strip::{Column, Start};
use super::{Mark, Mouth, Part, sizes};
use crate::mesh::implicit::{bell, ramp};

/// Rows from the margin to the mucogingival line.
pub(super) const GINGIVA: usize = 12;
/// Rows from there down the wall, round the vestibule and along lip or cheek.
pub(super) const WALL: usize = 3;
const ROUND: usize = 6;
const LIP: usize = 5;
/// Rows from the lingual wall to the middle of the floor.
const FLOOR: usize = 7;
/// Number of points of a column: facial and lingual.
pub(super) const POINTS: [usize; 2] =
    [GINGIVA + 1 + WALL + ROUND + LIP, GINGIVA + 1 + WALL + FLOOR];

/// Radius of the bottom of the vestibule, mm. Chosen.
const RADIUS: f64 = 2.2;
/// Rise of lip and of cheek outwards, radians, and their lengths, mm: drawn away by a finger and a mirror (chosen).
const RISE: [f64; 2] = [0.30, 0.62];
const LENGTH: [f64; 2] = [9.0, 10.0];
/// Radius of the lip's rim, its turn, radians, and the length beyond the rim, mm.
const RIM: f64 = 4.0;
const TURN: f64 = 2.0;
const BEYOND: f64 = 7.0;
/// Places from the midline at which the lip ends and the cheek begins, as numbers of contacts.
const CORNER: [usize; 2] = [2, 5];
/// Widening of the outer wall beside molars and elsewhere, mm: the buccal shelf. Chosen.
const SHELF: [f64; 2] = [0.6, 4.0];

/// Points of a column with their marks, world, mm.
pub(super) fn path(mouth: &Mouth<'_>, column: &Column, side: usize) -> Vec<(Vec3, Mark)> {
    let way = [1.0, -1.0][side];
    let from = place(mouth, &column.start, 0.0);
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
        let at = place(mouth, &column.start, below);
        if row == 0 {
            points.push((
                sunk(mouth, &column.start),
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
        outside(mouth, column, (from.z, line), &mark, &mut points);
    } else {
        inside(mouth, column, (from.z, line), &mark, &mut points);
    }
    points
}

/// Point of the tooth's surface, or under a papilla's tip, `below` mm under the start of a column.
fn place(mouth: &Mouth<'_>, start: &Start, below: f64) -> Vec3 {
    match *start {
        Start::Margin { cell, around, z } => {
            let cell = &mouth.cells[cell];
            let groove = cell.surface(around, z) - cell.tooth.sections.radius(around, z);
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
fn sunk(mouth: &Mouth<'_>, start: &Start) -> Vec3 {
    match *start {
        Start::Margin { cell, around, z } => margin_point(mouth, cell, around, z),
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

type Marker<'a> = &'a dyn Fn(Part, f64, f64, f64) -> Mark;

/// Wall below the mucogingival line, bottom of the vestibule, lip or cheek.
fn outside(
    mouth: &Mouth<'_>,
    column: &Column,
    (top, line): (f64, f64),
    mark: Marker<'_>,
    points: &mut Vec<(Vec3, Mark)>,
) {
    let (s, knots) = (column.low, &mouth.line.knots);
    let cheek = ramp(s.abs(), knots[CORNER[0]], knots[CORNER[1]]);
    let shelf = ramp(s.abs(), knots[4], knots[6]);
    let [bottom, frenum] = mouth.levels.vestibule(s);
    let bottom = fmin(bottom, line - RADIUS - 0.25);
    // A frenum is a fin from the wall to the lip: the bottom rises and narrows, the lip stays.
    let frenum = fmin(frenum, line - bottom - RADIUS - 0.2).max(0.0);
    let (radius, start) = (
        RADIUS - 0.25 * frenum,
        bottom + frenum + RADIUS - 0.25 * frenum,
    );
    let widening = SHELF[0] + (SHELF[1] - SHELF[0]) * shelf;
    let d_of = |z: f64, s: f64| {
        let down = fclamp((line - z) / (line - bottom), 0.0, 1.0);
        mouth.faces.at(0, s, z) + widening * down * down
    };
    let mut put = |d: f64, z: f64, part: Part, share: f64, dark: f64| {
        points.push((mouth.line.at(s, d, z), mark(part, top - z, share, dark)));
    };
    for k in 1..=WALL {
        let share = k as f64 / WALL as f64;
        let z = line + (start - line) * share;
        put(d_of(z, s), z, Part::Mucosa, share, 0.0);
    }
    let rise = RISE[0] + (RISE[1] - RISE[0]) * cheek;
    let centre = d_of(start, s) + radius;
    let turn = 0.5 * PI + rise;
    for k in 1..=ROUND {
        let angle = PI + turn * k as f64 / ROUND as f64;
        let (d, z) = (
            centre + radius * libm::cos(angle),
            start + radius * libm::sin(angle),
        );
        put(d, z, Part::Mucosa, 1.0 + k as f64 / ROUND as f64, 0.0);
    }
    let angle = PI + turn;
    let (radius, start) = (RADIUS, bottom + RADIUS);
    // The lip does not follow each root.
    let spread = (-4..=4).map(|k| d_of(start, s + f64::from(k)) / 9.0);
    let centre = spread.sum::<f64>() + radius;
    let (d, z) = (
        centre + radius * libm::cos(angle),
        start + radius * libm::sin(angle),
    );
    let length = LENGTH[0] + (LENGTH[1] - LENGTH[0]) * cheek;
    let (d, z) = (d + length * libm::cos(rise), z + length * libm::sin(rise));
    // The rim curves from the rise over the top and down; its centre lies below.
    let rim = [d + RIM * libm::sin(rise), z - RIM * libm::cos(rise)];
    put(
        d - 0.5 * length * libm::cos(rise),
        z - 0.5 * length * libm::sin(rise),
        Part::Lip,
        0.25,
        0.0,
    );
    put(d, z, Part::Lip, 0.5, 0.0);
    for k in 1..LIP - 2 {
        let angle = 0.5 * PI + rise - TURN * k as f64 / (LIP - 3) as f64;
        let share = k as f64 / (LIP - 3) as f64;
        let (d, z) = (
            rim[0] + RIM * libm::cos(angle),
            rim[1] + RIM * libm::sin(angle),
        );
        put(
            d,
            z,
            Part::Lip,
            0.5 + 0.4 * share,
            0.6 * ramp(share, 0.55, 1.0),
        );
    }
    let angle = 0.5 * PI + rise - TURN;
    let (d, z) = (
        rim[0] + RIM * libm::cos(angle),
        rim[1] + RIM * libm::sin(angle),
    );
    let (c, sine) = (libm::sin(angle), -libm::cos(angle));
    put(d + BEYOND * c, z + BEYOND * sine, Part::Lip, 1.0, 1.0);
}

/// Wall on the tongue's side, then the floor up to the middle of the mouth.
fn inside(
    mouth: &Mouth<'_>,
    column: &Column,
    (top, line): (f64, f64),
    mark: Marker<'_>,
    points: &mut Vec<(Vec3, Mark)>,
) {
    let (s, knots) = (column.low, &mouth.line.knots);
    let back = ramp(s.abs(), knots[4], knots[6]);
    let margin = mouth.levels.margin(1, s);
    let groove = fmin(floor::GROOVE, line - 1.0);
    let wall = |z: f64| {
        // In front the wall slopes towards the tongue; behind it retreats under the mylohyoid ridge.
        let slope = 0.3 * (1.0 - back) * (line - z);
        let ridge = 0.6 * bell(margin - z - 8.0, 2.5);
        let under = 3.0 * ramp(margin - z, 8.5, 12.5);
        mouth.faces.at(1, s, z) + slope + back * (ridge - under)
    };
    for k in 1..=WALL {
        let share = k as f64 / WALL as f64;
        let z = line + (groove - line) * share;
        let at = mouth.line.at(s, -wall(z), z);
        points.push((at, mark(Part::Mucosa, top - z, share, 0.0)));
    }
    let foot = mouth.line.at(s, -wall(groove), groove);
    let middle = floor::spine(mouth.line.at(s, 0.0, 0.0).x, mouth.line.at(0.0, 0.0, 0.0).x);
    for k in 1..=FLOOR {
        // Denser near the jaw.
        let share = libm::pow(k as f64 / FLOOR as f64, 1.2);
        let (x, y) = if k == FLOOR {
            (middle, 0.0)
        } else {
            (foot.x + (middle - foot.x) * share, foot.y * (1.0 - share))
        };
        let z = floor::height(x, y);
        let z = z + (groove - z) * (1.0 - ramp(share, 0.0, 0.2));
        points.push((Vec3::new(x, y, z), mark(Part::Floor, top - z, share, 0.0)));
    }
}
