//! The incisors: a shovel with a straight edge on a root that is flat from the sides.

use super::form::{Fissures, Form, Size};
use super::section::{Spot, Walls};
use crate::mesh::implicit::{bell, ramp, smooth_min};

/// Almost symmetric; its contacts lie close to the edge.
pub(super) static CENTRAL: Form = Form {
    usual: Size {
        mesiodistal: 5.0,
        buccolingual: 6.0,
        crown: 9.0,
        root: 12.5,
    },
    drawn: Size {
        mesiodistal: 5.034,
        buccolingual: 5.89,
        crown: 9.013,
        root: 12.494,
    },
    grid: 0.18,
    walls: Walls {
        z: [
            -11.3, -9.5, -6.5, -3.5, -1.0, 0.2, 1.6, 3.0, 5.0, 7.0, 8.2, 9.3,
        ],
        mesial: [
            0.62, 1.00, 1.36, 1.56, 1.66, 1.68, 1.68, 1.74, 2.05, 2.33, 2.42, 2.40,
        ],
        distal: [
            -0.82, -1.12, -1.40, -1.58, -1.66, -1.68, -1.69, -1.80, -2.10, -2.34, -2.40, -2.34,
        ],
        buccal: [
            0.98, 1.50, 2.15, 2.45, 2.55, 2.62, 2.72, 2.52, 1.78, 0.92, 0.40, -0.08,
        ],
        lingual: [
            -1.18, -1.70, -2.32, -2.60, -2.68, -2.75, -2.95, -2.72, -1.98, -1.32, -0.98, -0.74,
        ],
        widest: [
            -0.1, -0.1, -0.1, -0.05, 0.1, 0.15, 0.2, 0.15, 0.1, -0.1, -0.25, -0.35,
        ],
        crest: [
            -0.1, -0.05, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0,
        ],
        flat: [2.0, 2.6],
        round: [2.3, 2.0, 2.0],
        taper: 0.0,
        apex: 1.2,
        cej: [3.0, 2.2, 0.2],
    },
    fissures: &Fissures::NONE,
    edge: 0.45,
    chewing: |x, y, _| 9.0 + 0.12 * (y + 0.4) - 0.03 * x * x * 0.2,
    carving: |spot| blade(spot, 9.0),
    roots: None,
};

/// Wider, its edge falls and turns lingually towards its distal corner, which is rounder.
pub(super) static LATERAL: Form = Form {
    usual: Size {
        mesiodistal: 5.5,
        buccolingual: 6.5,
        crown: 9.5,
        root: 14.0,
    },
    drawn: Size {
        mesiodistal: 5.539,
        buccolingual: 6.419,
        crown: 9.502,
        root: 13.99,
    },
    grid: 0.195,
    walls: Walls {
        z: [
            -12.6, -10.5, -7.2, -3.8, -1.0, 0.2, 1.6, 3.0, 5.0, 7.0, 8.4, 9.8,
        ],
        mesial: [
            0.52, 1.02, 1.50, 1.74, 1.88, 1.90, 1.90, 1.95, 2.25, 2.55, 2.66, 2.62,
        ],
        distal: [
            -1.0, -1.30, -1.60, -1.80, -1.90, -1.92, -1.96, -2.12, -2.45, -2.66, -2.58, -2.30,
        ],
        buccal: [
            1.05, 1.60, 2.30, 2.65, 2.80, 2.86, 2.98, 2.80, 2.08, 1.15, 0.55, -0.05,
        ],
        lingual: [
            -1.28, -1.85, -2.55, -2.85, -2.95, -3.02, -3.22, -3.0, -2.18, -1.42, -1.04, -0.76,
        ],
        widest: [
            -0.1, -0.1, -0.1, -0.05, 0.1, 0.15, 0.2, 0.15, 0.1, -0.05, -0.2, -0.35,
        ],
        crest: [-0.2, -0.1, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        flat: [2.0, 2.6],
        round: [2.3, 2.0, 2.0],
        taper: 0.0,
        apex: 1.4,
        cej: [3.0, 2.2, 0.2],
    },
    fissures: &Fissures::NONE,
    edge: 0.45,
    chewing: |x, y, _| {
        let corner = ramp(-x, 0.6, 3.0);
        9.5 + 0.12 * (y + 0.4) + 0.03 * (x - 2.5) - 0.55 * corner * corner
    },
    carving: |spot| blade(spot, 9.5),
    roots: None,
};

/// The lingual fossa between marginal ridges above the cingulum, and traces of the lobes on the labial face.
///
/// Grooves run down the root's sides; the distal one is deeper.
fn blade(spot: &Spot, height: f64) -> f64 {
    let (p, z) = (&spot.p, spot.p.z / height);
    let lingual = ramp(-spot.v, 0.1, 0.8);
    let fossa =
        0.20 * lingual * bell(spot.u, 0.55) * ramp(z, 0.38, 0.6) * (1.0 - ramp(z, 0.8, 0.98));
    let labial = ramp(spot.v, 0.1, 0.8);
    let lobes = 0.07
        * labial
        * (bell(spot.u - 0.34, 0.16) + bell(spot.u + 0.34, 0.16))
        * ramp(z, 0.5, 0.85);
    let side = smooth_min(ramp(-p.z, -0.5, 3.5), 1.0 - ramp(-p.z, 8.0, 11.5), 0.2);
    let depth = if spot.u > 0.0 { 0.16 } else { 0.26 };
    let groove = depth * ramp(spot.u.abs(), 0.3, 0.8) * bell(p.y, 0.9) * side;
    fossa + lobes + groove
}
