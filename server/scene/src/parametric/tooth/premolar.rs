//! The premolars: the first almost a canine with a small lingual cusp, the second a small molar with three cusps.

use super::super::blend::{bell, ramp, smooth_max};
use super::occlusal::{Cusp, bar, cusps, groove, pit};
use super::section::{Spot, Walls};
use super::{Form, Size};

/// The large buccal cusp stands over the root, the crown leans lingually.
pub(super) static FIRST: Form = Form {
    usual: Size { mesiodistal: 7.0, buccolingual: 7.5, crown: 8.5, root: 14.0 },
    drawn: Size { mesiodistal: 7.0, buccolingual: 7.5, crown: 8.5, root: 14.0 },
    grid: 0.25,
    walls: Walls {
        z: [-12.9, -10.5, -7.0, -3.5, -1.0, 0.2, 1.5, 3.0, 4.5, 5.8, 7.2, 9.0],
        mesial: [0.40, 1.20, 1.90, 2.25, 2.38, 2.40, 2.48, 2.88, 3.26, 3.38, 3.10, 2.3],
        distal: [-1.05, -1.55, -2.02, -2.28, -2.40, -2.44, -2.62, -3.05, -3.36, -3.42, -3.05, -2.1],
        buccal: [0.85, 1.70, 2.55, 3.05, 3.18, 3.28, 3.48, 3.42, 3.05, 2.55, 1.95, 1.1],
        lingual: [-1.05, -1.90, -2.65, -3.08, -3.15, -3.22, -3.42, -3.72, -3.90, -3.72, -3.2, -2.5],
        widest: [-0.1, -0.1, -0.1, 0.0, 0.1, 0.2, 0.25, 0.3, 0.3, 0.3, 0.3, 0.3],
        crest: [-0.3, -0.15, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        flat: [2.0, 2.1],
        round: [2.2, 2.0, 1.85],
        apex: 1.1,
        cej: [1.0, 0.6, 0.1],
    },
    edge: 0.5,
    chewing: |x, y, relief| {
        let mut height = cusps(&FIRST_CUSPS, x, y, relief, 0.35);
        height = smooth_max(height, bar([2.85, 0.7, 6.0], [1.9, -2.5, 4.75], 0.9, x, y), 0.35);
        height = smooth_max(height, bar([-2.85, 0.7, 6.1], [-1.7, -2.6, 5.1], 0.9, x, y), 0.35);
        height
            - groove(&[[1.75, -0.7], [2.0, -2.0], [2.2, -3.2]], 0.30, 0.32, x, y)
            - pit([1.7, -0.7], 0.28, 0.5, x, y)
            - pit([-1.75, -0.8], 0.32, 0.55, x, y)
    },
    carving: |spot| {
        let p = &spot.p;
        // The mesiolingual groove runs over the edge.
        let over = 0.28 * bell(p.x - 2.05, 0.45) * ramp(-spot.v, 0.3, 0.7) * ramp(p.z, 2.6, 4.6);
        over + lobes(spot, 8.5) + sides(spot)
    },
    roots: None,
};

static FIRST_CUSPS: [Cusp; 2] = [
    Cusp { tip: [0.15, 0.75, 8.5], towards: [0.0, -2.9], slopes: [0.80, 0.9, 0.55, 0.58], blunt: 0.35 },
    Cusp { tip: [-0.1, -2.85, 5.75], towards: [0.0, 0.5], slopes: [0.35, 0.6, 0.45, 0.42], blunt: 0.3 },
];

/// Two lingual cusps, the mesial one larger; the grooves meet in a Y.
pub(super) static SECOND: Form = Form {
    usual: Size { mesiodistal: 7.0, buccolingual: 8.0, crown: 8.0, root: 14.5 },
    drawn: Size { mesiodistal: 7.0, buccolingual: 8.0, crown: 8.0, root: 14.5 },
    grid: 0.26,
    walls: Walls {
        z: [-13.3, -10.8, -7.2, -3.6, -1.0, 0.2, 1.4, 2.8, 4.2, 5.4, 6.8, 8.6],
        mesial: [0.40, 1.25, 1.95, 2.28, 2.38, 2.40, 2.50, 2.90, 3.26, 3.38, 3.15, 2.5],
        distal: [-1.10, -1.60, -2.06, -2.30, -2.40, -2.44, -2.62, -3.05, -3.36, -3.42, -3.10, -2.4],
        buccal: [0.95, 1.90, 2.80, 3.28, 3.40, 3.50, 3.74, 3.72, 3.45, 3.08, 2.6, 1.8],
        lingual: [-1.15, -2.05, -2.90, -3.30, -3.40, -3.48, -3.70, -3.92, -4.02, -3.92, -3.45, -2.6],
        widest: [-0.1, -0.1, -0.1, 0.0, 0.05, 0.1, 0.15, 0.2, 0.2, 0.2, 0.2, 0.2],
        crest: [-0.3, -0.15, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        flat: [2.0, 2.4],
        round: [2.2, 2.0, 2.05],
        apex: 1.15,
        cej: [1.0, 0.6, 0.1],
    },
    edge: 0.5,
    chewing: |x, y, relief| {
        let mut height = cusps(&SECOND_CUSPS, x, y, relief, 0.3);
        height = smooth_max(height, bar([2.75, 1.6, 6.3], [2.5, -2.3, 6.0], 0.9, x, y), 0.35);
        height = smooth_max(height, bar([-2.75, 1.5, 6.1], [-2.5, -2.2, 5.8], 0.9, x, y), 0.35);
        height
            - groove(&[[1.9, -0.1], [-0.4, -0.45], [-1.9, -0.1]], 0.26, 0.3, x, y)
            - groove(&[[-0.4, -0.45], [-0.5, -2.2], [-0.55, -4.0]], 0.26, 0.3, x, y)
            - pit([1.8, -0.1], 0.2, 0.45, x, y)
            - pit([-0.4, -0.5], 0.2, 0.45, x, y)
            - pit([-1.8, -0.1], 0.2, 0.45, x, y)
    },
    carving: |spot| {
        let p = &spot.p;
        let over = 0.25 * bell(p.x + 0.55, 0.42) * ramp(-spot.v, 0.3, 0.7) * ramp(p.z, 4.2, 6.2);
        over + lobes(spot, 8.0) + sides(spot)
    },
    roots: None,
};

static SECOND_CUSPS: [Cusp; 3] = [
    Cusp { tip: [0.1, 1.9, 8.0], towards: [-0.2, -0.8], slopes: [0.82, 0.8, 0.50, 0.52], blunt: 0.35 },
    Cusp { tip: [1.0, -2.6, 7.3], towards: [0.5, 0.3], slopes: [0.72, 0.8, 0.50, 0.60], blunt: 0.3 },
    Cusp { tip: [-1.7, -2.5, 6.9], towards: [-1.0, 0.2], slopes: [0.62, 0.8, 0.60, 0.50], blunt: 0.3 },
];

/// The buccal ridge stands out between two shallow depressions.
fn lobes(spot: &Spot, height: f64) -> f64 {
    let z = spot.p.z / height;
    0.13 * ramp(spot.v, 0.1, 0.7)
        * (bell(spot.u - 0.5, 0.2) + bell(spot.u + 0.5, 0.2))
        * ramp(z, 0.35, 0.75)
}

/// Shallow grooves down the sides of the root.
fn sides(spot: &Spot) -> f64 {
    let p = &spot.p;
    let side = ramp(-p.z, 0.5, 4.0) * (1.0 - ramp(-p.z, 9.0, 12.5));
    let depth = if spot.u > 0.0 { 0.14 } else { 0.24 };
    depth * ramp(spot.u.abs(), 0.3, 0.8) * bell(p.y, 1.0) * side
}
