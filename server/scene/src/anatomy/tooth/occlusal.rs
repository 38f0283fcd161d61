//! Pieces of a chewing surface as a height field: cusps with their ridges, marginal ridges, grooves, pits.

use sulcus_core::math::{fclamp, fmax, fmin};

use crate::mesh::implicit::{bell, ramp, smooth_max};

/// A cusp: a lobe that falls from its tip on all sides, least along its ridges.
///
/// The triangular ridge runs towards the middle of the tooth and has a round back. Two ridges run along the edge of
/// the crown.
pub(super) struct Cusp {
    /// Tip, x, y, z, mm.
    pub tip: [f64; 3],
    /// End of the triangular ridge, x, y, mm.
    pub towards: [f64; 2],
    /// Slopes (fall over run) along the triangular ridge, outwards, and along the edge on the mesial and the distal
    /// side.
    pub slopes: [f64; 4],
    /// Radius of the tip, mm.
    pub blunt: f64,
}

/// Exponent of the lobes' sections: 1 is a sharp pyramid, 2 a cone.
const PYRAMID: f64 = 1.5;
/// Growth of the radius of the triangular ridge towards its foot, mm per mm, and the slope of its sides.
const RIDGE: (f64, f64) = (0.5, 0.9);

impl Cusp {
    pub fn height(&self, x: f64, y: f64, relief: f64) -> f64 {
        let [tx, ty, tz] = self.tip;
        let (ax, ay) = (self.towards[0] - tx, self.towards[1] - ty);
        let length = (ax * ax + ay * ay).sqrt();
        let (ax, ay) = (ax / length, ay / length);
        let (dx, dy) = (x - tx, y - ty);
        let inward = dx * ax + dy * ay;
        // Along the edge, positive mesially.
        let mut across = dx * ay - dy * ax;
        if ay < 0.0 {
            across = -across;
        }
        let soft = |s: f64, blunt: f64| (s * s + blunt * blunt).sqrt() - blunt;
        let [inner, outer, mesial, distal] = self.slopes;
        let inside = ramp(inward, -0.2, 2.2);
        // The profile along the ridge is convex too.
        let a = soft(inward, self.blunt)
            * if inward > 0.0 {
                inner * (0.82 + 0.12 * inward)
            } else {
                outer
            };
        let b = soft(across, self.blunt + RIDGE.0 * 2.2 * inside)
            * (if across > 0.0 { mesial } else { distal } + RIDGE.1 * inside);
        let fall = libm::pow(libm::pow(a, PYRAMID) + libm::pow(b, PYRAMID), 1.0 / PYRAMID);
        tz - relief * fall
    }
}

/// Returns the highest of several cusps, with valleys of width `k` between them.
pub(super) fn cusps(all: &[Cusp], x: f64, y: f64, relief: f64, k: f64) -> f64 {
    let mut height = all[0].height(x, y, relief);
    for cusp in &all[1..] {
        height = smooth_max(height, cusp.height(x, y, relief), k);
    }
    height
}

/// Returns a marginal ridge: a rounded bar along a chain of points (x, y, z).
pub(super) fn marginal(points: &[[f64; 3]], slope: f64, x: f64, y: f64) -> f64 {
    let mut height = f64::NEG_INFINITY;
    for pair in points.windows(2) {
        let (a, b) = (pair[0], pair[1]);
        let (d, t) = to_segment([a[0], a[1]], [b[0], b[1]], x, y);
        let back = (d * d + BACK * BACK).sqrt() - BACK;
        height = fmax(height, a[2] + (b[2] - a[2]) * t - slope * back);
    }
    height
}

/// Radius of the back of a marginal ridge, mm.
const BACK: f64 = 0.6;

/// Returns the depth of a groove along a chain of points, mm.
pub(super) fn groove(points: &[[f64; 2]], depth: f64, width: f64, x: f64, y: f64) -> f64 {
    let mut d = f64::INFINITY;
    for pair in points.windows(2) {
        d = fmin(d, to_segment(pair[0], pair[1], x, y).0);
    }
    depth * bell(d, width)
}

/// Returns the depth of a supplementary groove beside a ridge. It is straight and fades towards its second end.
pub(super) fn branch(ends: [[f64; 2]; 2], x: f64, y: f64) -> f64 {
    let (d, along) = to_segment(ends[0], ends[1], x, y);
    0.15 * (1.0 - ramp(along, 0.1, 1.0)) * bell(d, 0.36)
}

/// Returns the deepest of the grooves that meet at a place.
pub(super) fn deepest(depths: &[f64]) -> f64 {
    depths
        .iter()
        .fold(0.0, |deepest, depth| fmax(deepest, *depth))
}

/// Returns the depth of a pit, mm.
pub(super) fn pit(at: [f64; 2], depth: f64, width: f64, x: f64, y: f64) -> f64 {
    let (dx, dy) = (x - at[0], y - at[1]);
    depth * bell((dx * dx + dy * dy).sqrt(), width)
}

/// Returns the distance to a segment, and the place of the nearest point along it, 0 to 1.
fn to_segment(a: [f64; 2], b: [f64; 2], x: f64, y: f64) -> (f64, f64) {
    let (bx, by) = (b[0] - a[0], b[1] - a[1]);
    let t = fclamp(
        ((x - a[0]) * bx + (y - a[1]) * by) / (bx * bx + by * by),
        0.0,
        1.0,
    );
    let (dx, dy) = (x - a[0] - t * bx, y - a[1] - t * by);
    ((dx * dx + dy * dy).sqrt(), t)
}
