//! Floor of the mouth: a height over the plan, with sublingual folds, caruncles and the frenulum of the tongue.

use sulcus_core::math::{fclamp, fmin};

use crate::mesh::implicit::{bell, ramp};

/// Height of the groove between jaw and floor, world, mm: 12 below the lingual margins (chosen).
pub(super) const GROOVE: f64 = -10.0;
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
pub(super) fn spine(x: f64, front: f64) -> f64 {
    SPINE[0] - SPINE[1] * (front - x)
}

/// Height of the floor, world, mm.
pub(super) fn height(x: f64, y: f64) -> f64 {
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
