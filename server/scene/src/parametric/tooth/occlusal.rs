//! Pieces of a chewing surface as a height field: cusps with their ridges, marginal ridges, grooves, pits.

use sulcus_core::math::{fclamp, fmin};

use super::super::blend::{bell, smooth_max};

/// A cusp: a pyramid with rounded edges, which are its ridges. One runs towards the middle of the tooth (the triangular
/// ridge), the opposite one down the outer face, two along the edge of the crown.
pub(super) struct Cusp {
    /// Tip, x, y, z, mm.
    pub tip: [f64; 3],
    /// Where the triangular ridge points to, x, y.
    pub towards: [f64; 2],
    /// Slopes (fall over run) along the triangular ridge, outwards, and along the edge on the mesial and the distal side.
    pub slopes: [f64; 4],
    /// Radius of the tip and of the ridges, mm.
    pub blunt: f64,
}

/// Exponent of the pyramid: 1 is sharp-edged, 2 a cone.
const PYRAMID: f64 = 1.45;

impl Cusp {
    pub fn height(&self, x: f64, y: f64, relief: f64) -> f64 {
        let [tx, ty, tz] = self.tip;
        let (ax, ay) = (self.towards[0] - tx, self.towards[1] - ty);
        let length = (ax * ax + ay * ay).sqrt();
        let (ax, ay) = (ax / length, ay / length);
        let (dx, dy) = (x - tx, y - ty);
        let inward = dx * ax + dy * ay;
        // Across the ridge, positive mesially.
        let mut across = dx * ay - dy * ax;
        if ay < 0.0 {
            across = -across;
        }
        let [inner, outer, mesial, distal] = self.slopes;
        let soft = |s: f64| (s * s + self.blunt * self.blunt).sqrt() - self.blunt;
        let a = soft(inward) * if inward > 0.0 { inner } else { outer };
        let b = soft(across) * if across > 0.0 { mesial } else { distal };
        let fall = libm::pow(
            libm::pow(a, PYRAMID) + libm::pow(b, PYRAMID),
            1.0 / PYRAMID,
        );
        tz - relief * fall
    }
}

/// The highest of several cusps, with valleys of width `k` between them.
pub(super) fn cusps(all: &[Cusp], x: f64, y: f64, relief: f64, k: f64) -> f64 {
    let mut height = all[0].height(x, y, relief);
    for cusp in &all[1..] {
        height = smooth_max(height, cusp.height(x, y, relief), k);
    }
    height
}

/// A marginal ridge: a rounded bar between two points (x, y, z).
pub(super) fn bar(a: [f64; 3], b: [f64; 3], slope: f64, x: f64, y: f64) -> f64 {
    let (d, t) = to_segment([a[0], a[1]], [b[0], b[1]], x, y);
    a[2] + (b[2] - a[2]) * t - slope * ((d * d + 0.16).sqrt() - 0.4)
}

/// A groove along a chain of points: its depth here, mm.
pub(super) fn groove(points: &[[f64; 2]], depth: f64, width: f64, x: f64, y: f64) -> f64 {
    let mut d = f64::INFINITY;
    for pair in points.windows(2) {
        d = fmin(d, to_segment(pair[0], pair[1], x, y).0);
    }
    depth * bell(d, width)
}

/// A pit: its depth here, mm.
pub(super) fn pit(at: [f64; 2], depth: f64, width: f64, x: f64, y: f64) -> f64 {
    let (dx, dy) = (x - at[0], y - at[1]);
    depth * bell((dx * dx + dy * dy).sqrt(), width)
}

/// Distance to a segment, and where along it the nearest point lies, 0 to 1.
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
