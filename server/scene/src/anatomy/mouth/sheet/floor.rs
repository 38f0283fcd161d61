//! Lingual side below the mucogingival line, and the floor of the mouth: a height over the plan, with sublingual folds,
//! caruncles and the frenulum of the tongue.

use sulcus_core::Vec3;
use sulcus_core::math::{fclamp, fmin};

use super::path::{FLOOR, Marker, WALL};
use super::strip::Column;
use super::{Mark, Mouth, Part};
use crate::mesh::implicit::{bell, ramp};

/// Height of the groove between jaw and floor, world, mm: 12 below the lingual margins (chosen).
const GROOVE: f64 = -10.0;
/// Height of the floor between the folds, world, mm. The tongue's underside at rest lies 2 mm lower behind its tip, so
/// that no gap opens between both. Chosen.
const LEVEL: f64 = -11.3;
/// Line of a sublingual fold on the left, x and y, mm: from the caruncle beside the frenulum to the second premolar.
const FOLD: [[f64; 2]; 3] = [[16.0, 2.4], [10.0, 7.5], [-3.0, 13.0]];
/// Height and half width of a fold, mm. Chosen.
const RAISED: [f64; 2] = [2.6, 3.0];
/// Height and half width of a caruncle, mm. Chosen.
const CARUNCLE: [f64; 2] = [0.7, 1.9];
/// Frenulum: half width, height, and places between which it rises backwards to the tongue, mm. Chosen.
const FRENULUM: [f64; 4] = [0.9, 4.5, 19.0, 11.0];
/// Front end of the middle line, and its length for each mm of the arch's depth.
const SPINE: [f64; 2] = [11.5, 0.72];

/// Place x of the middle line, mm, for a column at `x` of an arch that begins at `front`.
fn spine(x: f64, front: f64) -> f64 {
    SPINE[0] - SPINE[1] * (front - x)
}

/// Height of the floor, world, mm.
fn height(x: f64, y: f64) -> f64 {
    let y = y.abs();
    let off = FOLD.windows(2).fold(f64::INFINITY, |nearest, pair| {
        let ([ax, ay], [bx, by]) = (pair[0], pair[1]);
        let (dx, dy) = (bx - ax, by - ay);
        let t = fclamp(
            ((x - ax) * dx + (y - ay) * dy) / (dx * dx + dy * dy),
            0.0,
            1.0,
        );
        let (ex, ey) = (x - ax - t * dx, y - ay - t * dy);
        fmin(nearest, (ex * ex + ey * ey).sqrt())
    });
    let fold =
        RAISED[0] * bell(off, RAISED[1]) * ramp(x, -12.0, 0.0) * (1.0 - 0.5 * ramp(x, 13.0, 19.0));
    let (ex, ey) = (x - FOLD[0][0], y - FOLD[0][1]);
    let caruncle = CARUNCLE[0] * bell((ex * ex + ey * ey).sqrt(), CARUNCLE[1]);
    let [half, most, from, to] = FRENULUM;
    let frenulum = most * bell(y, half) * ramp(from - x, 0.0, from - to) * ramp(x, 0.0, to);
    LEVEL + fold + caruncle + frenulum
}

/// Wall on the tongue's side, then the floor up to the middle of the mouth.
pub(super) fn inside(
    mouth: &Mouth<'_>,
    column: &Column,
    (top, line): (f64, f64),
    mark: Marker<'_>,
    points: &mut Vec<(Vec3, Mark)>,
) {
    let (s, knots) = (column.low, &mouth.line.knots);
    let back = ramp(s.abs(), knots[4], knots[6]);
    let margin = mouth.levels.margin(1, s);
    let groove = fmin(GROOVE, line - 1.0);
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
    let middle = spine(mouth.line.at(s, 0.0, 0.0).x, mouth.line.at(0.0, 0.0, 0.0).x);
    for k in 1..=FLOOR {
        // Denser near the jaw.
        let share = libm::pow(k as f64 / FLOOR as f64, 1.2);
        let (x, y) = if k == FLOOR {
            (middle, 0.0)
        } else {
            (foot.x + (middle - foot.x) * share, foot.y * (1.0 - share))
        };
        let z = height(x, y);
        let z = z + (groove - z) * (1.0 - ramp(share, 0.0, 0.2));
        points.push((Vec3::new(x, y, z), mark(Part::Floor, top - z, share, 0.0)));
    }
}
