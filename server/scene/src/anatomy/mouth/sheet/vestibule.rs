//! Facial side below the mucogingival line: wall, bottom of the vestibule, lip or cheek.

use std::f64::consts::PI;

use sulcus_core::Vec3;
use sulcus_core::math::{fclamp, fmax, fmin};

use super::path::{LIP, Marker, ROUND, WALL};
use super::strip::Column;
use super::{Mark, Mouth, Part};
use crate::mesh::implicit::ramp;

/// Radius of the bottom of the vestibule, mm. Chosen.
const RADIUS: f64 = 2.2;
/// Rise of lip and of cheek outwards, radians, and their lengths, mm: drawn away by a finger and a mirror (chosen).
const RISE: [f64; 2] = [0.30, 0.62];
const LENGTH: [f64; 2] = [9.0, 10.0];
/// Radius of the lip's rim, its turn, radians, and the length beyond the rim, mm.
const RIM: f64 = 4.0;
const TURN: f64 = 2.0;
const BEYOND: f64 = 7.0;
/// Distance along the line over which lip and cheek are smooth, mm to each side, and hollow of the cheek as a share of
/// its length. Chosen.
const SPREAD: i32 = 10;
const HOLLOW: f64 = 0.09;
/// Places from the midline at which the lip ends and the cheek begins, as numbers of contacts.
const CORNER: [usize; 2] = [2, 5];
/// Widening of the outer wall beside molars and elsewhere, mm: the buccal shelf. Chosen.
const SHELF: [f64; 2] = [0.6, 4.0];

/// Wall below the mucogingival line, bottom of the vestibule, lip or cheek.
pub(super) fn outside(
    mouth: &Mouth<'_>,
    column: &Column,
    (top, line): (f64, f64),
    mark: Marker<'_>,
    points: &mut Vec<(Vec3, Mark)>,
) {
    let (s, knots) = (column.low, &mouth.line.knots);
    let cheek = ramp(s.abs(), knots[CORNER[0]], knots[CORNER[1]]);
    let shelf = |s: f64| ramp(s.abs(), knots[4], knots[6]);
    let frenum = mouth.levels.vestibule(s)[1];
    // Lip and cheek follow no root and no single tooth's height. A weight that falls to both sides leaves no kink.
    let weight = |k: i32| f64::from(SPREAD - k.abs()) / f64::from(SPREAD * SPREAD);
    let spread = |of: &dyn Fn(f64) -> f64| -> f64 {
        let beside = (1 - SPREAD..SPREAD).map(|k| weight(k) * of(s + f64::from(k)));
        beside.sum()
    };
    let level = spread(&|s| mouth.levels.vestibule(s)[0]);
    let bottom = fmin(level, line - RADIUS - 0.25);
    // A frenum is a fin from the wall to the lip: the bottom rises and narrows, the lip stays.
    let frenum = fmax(fmin(frenum, line - bottom - RADIUS - 0.2), 0.0);
    let (radius, start) = (
        RADIUS - 0.25 * frenum,
        bottom + frenum + RADIUS - 0.25 * frenum,
    );
    let d_of = |z: f64, s: f64| {
        let down = fclamp((line - z) / (line - bottom), 0.0, 1.0);
        let widening = SHELF[0] + (SHELF[1] - SHELF[0]) * shelf(s);
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
    let (radius, start) = (RADIUS, level + RADIUS);
    let centre = spread(&|s| d_of(start, s)) + radius;
    let (d, z) = (
        centre + radius * libm::cos(angle),
        start + radius * libm::sin(angle),
    );
    let length = LENGTH[0] + (LENGTH[1] - LENGTH[0]) * cheek;
    let (d, z) = (d + length * libm::cos(rise), z + length * libm::sin(rise));
    // The rim curves from the rise over the top and down; its centre lies below.
    let rim = [d + RIM * libm::sin(rise), z - RIM * libm::cos(rise)];
    let hollow = HOLLOW * length;
    put(
        d - 0.5 * length * libm::cos(rise) + hollow * libm::sin(rise),
        z - 0.5 * length * libm::sin(rise) - hollow * libm::cos(rise),
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
