//! The premolars: the first almost a canine with a small lingual cusp, the second a small molar with three cusps.

use super::form::{Fissures, Form, Size};
use super::occlusal::{Cusp, branch, cusps, deepest, groove, marginal, pit};
use super::section::{Spot, Walls};
use crate::mesh::implicit::{bell, ramp, smooth_max};

/// The large buccal cusp stands over the root, the crown leans lingually.
pub(super) static FIRST: Form = Form {
    usual: Size {
        mesiodistal: 7.0,
        buccolingual: 7.5,
        crown: 8.5,
        root: 14.0,
    },
    drawn: Size {
        mesiodistal: 7.039,
        buccolingual: 7.609,
        crown: 8.498,
        root: 13.98,
    },
    grid: 0.22,
    walls: Walls {
        z: [
            -12.5, -10.5, -7.0, -3.5, -1.0, 0.2, 1.5, 3.0, 4.5, 5.8, 7.2, 9.0,
        ],
        mesial: [
            0.70, 1.25, 1.90, 2.25, 2.38, 2.40, 2.48, 2.88, 3.26, 3.38, 3.10, 2.3,
        ],
        distal: [
            -1.22, -1.58, -2.02, -2.28, -2.40, -2.44, -2.62, -3.05, -3.36, -3.42, -3.05, -2.1,
        ],
        buccal: [
            1.12, 1.75, 2.55, 3.05, 3.18, 3.28, 3.48, 3.42, 3.05, 2.55, 1.95, 1.1,
        ],
        lingual: [
            -1.32, -1.95, -2.65, -3.08, -3.15, -3.22, -3.42, -3.72, -3.90, -3.72, -3.2, -2.5,
        ],
        widest: [
            -0.1, -0.1, -0.1, 0.0, 0.1, 0.2, 0.25, 0.3, 0.3, 0.3, 0.3, 0.3,
        ],
        crest: [
            -0.3, -0.15, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0,
        ],
        flat: [2.0, 2.1],
        round: [2.2, 2.0, 1.85],
        taper: 0.0,
        apex: 1.5,
        cej: [1.0, 0.6, 0.1],
    },
    fissures: &FIRST_FISSURES,
    edge: 0.5,
    chewing: |x, y, relief| {
        let mut height = cusps(&FIRST_CUSPS, x, y, relief, 0.35);
        height = smooth_max(
            height,
            marginal(
                &[[2.4, 0.8, 6.5], [2.75, -0.3, 5.6], [2.0, -2.1, 4.8]],
                0.8,
                x,
                y,
            ),
            0.45,
        );
        height = smooth_max(
            height,
            marginal(
                &[[-2.4, 0.8, 6.5], [-2.75, -0.3, 5.75], [-1.8, -2.1, 5.1]],
                0.8,
                x,
                y,
            ),
            0.45,
        );
        // Developmental grooves, supplementary ones beside the triangular ridges, and pits.
        height
            - deepest(&[
                -branch(FIRST_FISSURES.branches[0], x, y),
                groove(FIRST_FISSURES.main[0], 0.22, 0.38, x, y),
                groove(FIRST_FISSURES.main[1], 0.10, 0.38, x, y),
                branch(FIRST_FISSURES.branches[1], x, y),
                branch(FIRST_FISSURES.branches[2], x, y),
            ])
            - deepest(&[
                pit([1.6, -0.7], 0.12, 0.5, x, y),
                pit([-1.62, -0.8], 0.14, 0.5, x, y),
            ])
    },
    carving: |spot| {
        let p = &spot.p;
        // The mesiolingual groove runs over the edge.
        let over = 0.28 * bell(p.x - 2.05, 0.45) * ramp(-spot.v, 0.3, 0.7) * ramp(p.z, 2.6, 4.6);
        over + lobes(spot, 8.5) + sides(spot)
    },
    roots: None,
};

static FIRST_FISSURES: Fissures = Fissures {
    main: &[
        &[[1.6, -0.8], [1.9, -2.0], [2.1, -3.2]],
        &[
            [1.6, -0.8],
            [0.9, -1.5],
            [-0.1, -1.75],
            [-1.0, -1.5],
            [-1.6, -0.9],
        ],
    ],
    branches: &[
        [[1.6, -0.8], [1.5, 0.5]],
        [[-1.6, -0.8], [-1.5, 0.5]],
        [[-1.6, -0.8], [-1.2, -2.0]],
    ],
};

static FIRST_CUSPS: [Cusp; 2] = [
    Cusp {
        tip: [0.15, 0.75, 8.5],
        towards: [0.0, -1.7],
        slopes: [1.14, 0.6, 0.55, 0.58],
        blunt: 0.5,
    },
    Cusp {
        tip: [-0.15, -2.8, 6.25],
        towards: [0.0, -1.0],
        slopes: [0.62, 0.4, 0.5, 0.48],
        blunt: 0.5,
    },
];

/// Two lingual cusps, the mesial one larger; the grooves meet in a Y.
pub(super) static SECOND: Form = Form {
    usual: Size {
        mesiodistal: 7.0,
        buccolingual: 8.0,
        crown: 8.0,
        root: 14.5,
    },
    drawn: Size {
        mesiodistal: 7.034,
        buccolingual: 8.001,
        crown: 7.983,
        root: 14.485,
    },
    grid: 0.23,
    walls: Walls {
        z: [
            -12.9, -10.8, -7.2, -3.6, -1.0, 0.2, 1.4, 2.8, 4.2, 5.4, 6.8, 8.6,
        ],
        mesial: [
            0.70, 1.28, 1.95, 2.28, 2.38, 2.40, 2.50, 2.90, 3.26, 3.38, 3.15, 2.5,
        ],
        distal: [
            -1.26, -1.62, -2.06, -2.30, -2.40, -2.44, -2.62, -3.05, -3.36, -3.42, -3.10, -2.4,
        ],
        buccal: [
            1.25, 1.92, 2.80, 3.28, 3.40, 3.50, 3.74, 3.72, 3.45, 3.08, 2.6, 1.8,
        ],
        lingual: [
            -1.45, -2.1, -2.90, -3.30, -3.40, -3.48, -3.70, -3.92, -4.02, -3.92, -3.45, -2.6,
        ],
        widest: [
            -0.1, -0.1, -0.1, 0.0, 0.05, 0.1, 0.15, 0.2, 0.2, 0.2, 0.2, 0.2,
        ],
        crest: [
            -0.3, -0.15, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0,
        ],
        flat: [2.0, 2.2],
        round: [2.2, 1.9, 1.9],
        taper: 0.0,
        apex: 1.6,
        cej: [1.0, 0.6, 0.1],
    },
    fissures: &SECOND_FISSURES,
    edge: 0.5,
    chewing: |x, y, relief| {
        let mut height = cusps(&SECOND_CUSPS, x, y, relief, 0.35);
        height = smooth_max(
            height,
            marginal(
                &[
                    [2.3, 1.5, 6.6],
                    [2.75, 0.3, 6.2],
                    [2.65, -1.2, 6.2],
                    [2.0, -2.5, 6.6],
                ],
                0.8,
                x,
                y,
            ),
            0.45,
        );
        height = smooth_max(
            height,
            marginal(
                &[
                    [-2.3, 1.5, 6.5],
                    [-2.75, 0.3, 6.0],
                    [-2.65, -1.1, 6.0],
                    [-2.2, -2.2, 6.3],
                ],
                0.8,
                x,
                y,
            ),
            0.45,
        );
        // Developmental grooves, supplementary ones beside the triangular ridges, and pits.
        height
            - deepest(&[
                groove(SECOND_FISSURES.main[0], 0.18, 0.38, x, y),
                groove(SECOND_FISSURES.main[1], 0.22, 0.38, x, y),
                branch(SECOND_FISSURES.branches[0], x, y),
                branch(SECOND_FISSURES.branches[1], x, y),
                branch(SECOND_FISSURES.branches[2], x, y),
            ])
            - deepest(&[
                pit([1.8, 0.1], 0.14, 0.45, x, y),
                pit([-0.4, -0.5], 0.12, 0.45, x, y),
                pit([-1.8, 0.05], 0.14, 0.45, x, y),
            ])
    },
    carving: |spot| {
        let p = &spot.p;
        let over = 0.25 * bell(p.x + 0.55, 0.42) * ramp(-spot.v, 0.3, 0.7) * ramp(p.z, 4.2, 6.2);
        over + lobes(spot, 8.0) + sides(spot)
    },
    roots: None,
};

static SECOND_FISSURES: Fissures = Fissures {
    main: &[
        &[
            [1.8, 0.1],
            [0.9, -0.05],
            [0.2, -0.35],
            [-0.4, -0.5],
            [-1.0, -0.25],
            [-1.8, 0.05],
        ],
        &[[-0.4, -0.5], [-0.45, -1.4], [-0.6, -2.3], [-0.6, -4.0]],
    ],
    branches: &[
        [[1.8, 0.1], [2.1, 1.3]],
        [[1.8, 0.1], [2.1, -1.3]],
        [[-1.8, 0.05], [-2.05, 1.2]],
    ],
};

static SECOND_CUSPS: [Cusp; 3] = [
    Cusp {
        tip: [0.1, 1.9, 8.0],
        towards: [-0.1, -0.5],
        slopes: [0.95, 0.5, 0.50, 0.52],
        blunt: 0.5,
    },
    Cusp {
        tip: [1.1, -2.65, 7.3],
        towards: [0.6, -0.3],
        slopes: [0.78, 0.45, 0.50, 0.60],
        blunt: 0.5,
    },
    Cusp {
        tip: [-1.75, -2.5, 6.9],
        towards: [-1.1, -0.3],
        slopes: [0.66, 0.45, 0.60, 0.50],
        blunt: 0.5,
    },
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
