//! The molars: the first with five cusps, the second with four and a cross of grooves, closer roots.

use super::super::blend::{bell, ramp, smooth_max};
use super::occlusal::{Cusp, bar, cusps, groove, pit};
use super::root::{Roots, Tube};
use super::section::{Spot, Walls};
use super::{Form, Size};

/// Mesiobuccal, distobuccal, distal, mesiolingual, distolingual cusp.
pub(super) static FIRST: Form = Form {
    usual: Size { mesiodistal: 11.0, buccolingual: 10.5, crown: 7.5, root: 14.0 },
    drawn: Size { mesiodistal: 11.0, buccolingual: 10.5, crown: 7.5, root: 14.0 },
    grid: 0.28,
    walls: Walls {
        z: [-9.0, -7.0, -5.0, -3.0, -1.2, 0.0, 1.0, 2.4, 3.6, 4.8, 6.2, 8.5],
        mesial: [3.6, 3.8, 4.0, 4.15, 4.25, 4.30, 4.40, 4.95, 5.32, 5.45, 5.15, 4.1],
        distal: [-3.5, -3.7, -3.9, -4.1, -4.22, -4.30, -4.48, -4.98, -5.28, -5.36, -4.9, -3.7],
        buccal: [3.0, 3.2, 3.5, 3.9, 4.2, 4.40, 4.90, 5.12, 4.95, 4.55, 3.95, 2.7],
        lingual: [-3.0, -3.2, -3.5, -3.9, -4.2, -4.38, -4.62, -4.98, -5.15, -5.10, -4.7, -3.6],
        widest: [0.0, 0.0, 0.0, 0.0, 0.0, 0.05, 0.1, 0.15, 0.2, 0.2, 0.2, 0.1],
        crest: [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.1, 0.2, 0.3, 0.3, 0.3, 0.2],
        flat: [2.2, 2.5],
        round: [2.2, 2.0, 2.05],
        apex: 1.5,
        cej: [1.0, 0.6, 0.1],
    },
    edge: 0.7,
    chewing: |x, y, relief| {
        let mut height = cusps(&FIRST_CUSPS, x, y, relief, 0.3);
        height = smooth_max(height, bar([4.35, 2.4, 6.2], [4.2, -2.5, 6.2], 0.9, x, y), 0.4);
        height = smooth_max(height, bar([-4.45, 1.0, 5.9], [-3.9, -2.4, 5.9], 0.9, x, y), 0.4);
        let central = [[3.0, -0.1], [1.1, 0.25], [-0.35, -0.25], [-1.9, 0.2], [-3.2, -0.4]];
        height
            - groove(&central, 0.25, 0.32, x, y)
            - groove(&[[1.1, 0.25], [1.15, 2.5], [1.1, 5.5]], 0.25, 0.32, x, y)
            - groove(&[[-1.9, 0.2], [-2.5, 2.3], [-2.8, 5.0]], 0.22, 0.32, x, y)
            - groove(&[[-0.35, -0.25], [0.3, -2.5], [0.35, -5.5]], 0.25, 0.32, x, y)
            - pit([-0.35, -0.2], 0.25, 0.6, x, y)
            - pit([3.0, -0.1], 0.2, 0.5, x, y)
            - pit([-3.2, -0.45], 0.15, 0.5, x, y)
    },
    carving: |spot| {
        let p = &spot.p;
        let (buccal, lingual) = (ramp(spot.v, 0.2, 0.8), ramp(-spot.v, 0.2, 0.8));
        0.40 * bell(p.x - 1.1, 0.5) * ramp(p.z, 2.4, 5.6) * buccal
            + 0.34 * bell(p.x + 2.7, 0.48) * ramp(p.z, 3.2, 5.8) * buccal
            + 0.32 * bell(p.x - 0.35, 0.48) * ramp(p.z, 4.0, 6.2) * lingual
            + flutes(spot)
    },
    roots: Some(Roots {
        mesial: Tube {
            x: [2.1, 2.75, 2.75, 1.75],
            depth: [0.8, 5.0, 9.4, 13.1],
            half: [2.05, 1.85, 1.45, 0.9],
            stretch: [1.7, 2.0, 1.9, 1.5],
            groove: 0.34,
        },
        distal: Tube {
            x: [-2.0, -2.75, -3.2, -3.4],
            depth: [0.8, 5.0, 9.0, 12.4],
            half: [2.1, 1.85, 1.4, 0.9],
            stretch: [1.65, 1.75, 1.55, 1.3],
            groove: 0.14,
        },
        roof: [3.0, 3.75],
        reach: 4.0,
        arch: 1.0,
    }),
};

static FIRST_CUSPS: [Cusp; 5] = [
    Cusp { tip: [3.0, 2.75, 7.15], towards: [1.6, 0.0], slopes: [0.80, 0.7, 0.5, 0.55], blunt: 0.4 },
    Cusp { tip: [-0.7, 2.95, 7.05], towards: [-0.4, 0.0], slopes: [0.78, 0.7, 0.5, 0.5], blunt: 0.4 },
    Cusp { tip: [-3.75, 1.55, 6.55], towards: [-2.0, 0.2], slopes: [0.70, 0.7, 0.5, 0.5], blunt: 0.4 },
    Cusp { tip: [2.8, -3.0, 7.6], towards: [1.2, 0.1], slopes: [0.86, 0.8, 0.55, 0.6], blunt: 0.3 },
    Cusp { tip: [-2.1, -3.05, 7.4], towards: [-0.8, -0.1], slopes: [0.86, 0.8, 0.6, 0.55], blunt: 0.3 },
];

/// Mesiobuccal, distobuccal, mesiolingual, distolingual cusp.
pub(super) static SECOND: Form = Form {
    usual: Size { mesiodistal: 10.5, buccolingual: 10.0, crown: 7.0, root: 13.0 },
    drawn: Size { mesiodistal: 10.5, buccolingual: 10.0, crown: 7.0, root: 13.0 },
    grid: 0.27,
    walls: Walls {
        z: [-9.0, -7.0, -5.0, -3.0, -1.2, 0.0, 1.0, 2.3, 3.4, 4.5, 5.8, 8.0],
        mesial: [3.1, 3.3, 3.5, 3.65, 3.78, 3.85, 3.98, 4.60, 5.02, 5.20, 4.9, 3.9],
        distal: [-3.1, -3.3, -3.5, -3.65, -3.78, -3.88, -4.08, -4.62, -4.98, -5.10, -4.7, -3.6],
        buccal: [3.0, 3.2, 3.5, 3.95, 4.25, 4.40, 4.70, 4.88, 4.72, 4.35, 3.8, 2.6],
        lingual: [-3.0, -3.2, -3.5, -3.95, -4.25, -4.38, -4.52, -4.75, -4.88, -4.82, -4.4, -3.3],
        widest: [0.0, 0.0, 0.0, 0.0, 0.0, 0.05, 0.1, 0.15, 0.15, 0.15, 0.15, 0.1],
        crest: [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.05, 0.1, 0.15, 0.15, 0.15, 0.1],
        flat: [2.2, 2.5],
        round: [2.2, 2.05, 2.05],
        apex: 1.5,
        cej: [1.0, 0.6, 0.1],
    },
    edge: 0.7,
    chewing: |x, y, relief| {
        let mut height = cusps(&SECOND_CUSPS, x, y, relief, 0.3);
        height = smooth_max(height, bar([4.1, 2.3, 5.8], [4.0, -2.4, 5.8], 0.9, x, y), 0.4);
        height = smooth_max(height, bar([-4.05, 2.1, 5.5], [-3.8, -2.3, 5.5], 0.9, x, y), 0.4);
        height
            - groove(&[[2.9, 0.0], [0.0, -0.1], [-2.9, 0.0]], 0.25, 0.32, x, y)
            - groove(&[[0.05, 5.0], [0.0, -0.1], [0.05, -5.0]], 0.25, 0.32, x, y)
            - pit([0.0, -0.1], 0.25, 0.6, x, y)
            - pit([2.85, 0.0], 0.2, 0.5, x, y)
            - pit([-2.85, 0.0], 0.18, 0.5, x, y)
    },
    carving: |spot| {
        let p = &spot.p;
        let (buccal, lingual) = (ramp(spot.v, 0.2, 0.8), ramp(-spot.v, 0.2, 0.8));
        0.38 * bell(p.x - 0.05, 0.5) * ramp(p.z, 2.4, 5.2) * buccal
            + 0.32 * bell(p.x - 0.05, 0.48) * ramp(p.z, 3.6, 5.6) * lingual
            + flutes(spot)
    },
    roots: Some(Roots {
        mesial: Tube {
            x: [1.75, 2.15, 1.95, 1.0],
            depth: [0.8, 5.0, 9.0, 12.1],
            half: [1.9, 1.65, 1.3, 0.9],
            stretch: [1.8, 2.15, 1.95, 1.5],
            groove: 0.28,
        },
        distal: Tube {
            x: [-1.7, -2.2, -2.45, -2.5],
            depth: [0.8, 5.0, 8.6, 11.5],
            half: [1.9, 1.62, 1.25, 0.85],
            stretch: [1.75, 1.95, 1.7, 1.35],
            groove: 0.12,
        },
        roof: [3.1, 3.85],
        reach: 4.0,
        arch: 1.0,
    }),
};

static SECOND_CUSPS: [Cusp; 4] = [
    Cusp { tip: [2.45, 2.65, 6.85], towards: [1.0, 0.0], slopes: [0.78, 0.7, 0.5, 0.55], blunt: 0.4 },
    Cusp { tip: [-2.3, 2.6, 6.7], towards: [-1.0, 0.0], slopes: [0.78, 0.7, 0.55, 0.5], blunt: 0.4 },
    Cusp { tip: [2.3, -2.85, 7.1], towards: [1.0, -0.1], slopes: [0.84, 0.8, 0.55, 0.6], blunt: 0.3 },
    Cusp { tip: [-2.25, -2.8, 6.9], towards: [-0.9, -0.1], slopes: [0.82, 0.8, 0.6, 0.55], blunt: 0.3 },
];

/// The trunk is fluted towards the furcation, deeper buccally.
fn flutes(spot: &Spot) -> f64 {
    let (buccal, lingual) = (ramp(spot.v, 0.2, 0.8), ramp(-spot.v, 0.2, 0.8));
    (0.75 * buccal + 0.6 * lingual) * bell(spot.p.x, 1.1) * ramp(-spot.p.z, 0.3, 3.2)
}
