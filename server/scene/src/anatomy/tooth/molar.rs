//! The molars: the first with five cusps, the second with four and a cross of grooves, closer roots.

use super::form::{Fissures, Form, Size};
use super::occlusal::{Cusp, branch, cusps, deepest, groove, marginal, pit};
use super::root::{Roots, Tube};
use super::section::{Spot, Walls};
use crate::mesh::implicit::{bell, ramp, smooth_max};

/// Mesiobuccal, distobuccal, distal, mesiolingual, distolingual cusp.
pub(super) static FIRST: Form = Form {
    usual: Size {
        mesiodistal: 11.0,
        buccolingual: 10.5,
        crown: 7.5,
        root: 14.0,
    },
    drawn: Size {
        mesiodistal: 11.04,
        buccolingual: 10.492,
        crown: 7.431,
        root: 13.78,
    },
    grid: 0.28,
    walls: Walls {
        z: [
            -9.0, -7.0, -5.0, -3.0, -1.2, 0.0, 1.0, 2.4, 3.6, 4.8, 6.2, 8.5,
        ],
        mesial: [
            3.6, 3.8, 4.0, 4.15, 4.25, 4.30, 4.38, 4.80, 5.24, 5.45, 5.05, 4.0,
        ],
        distal: [
            -3.5, -3.7, -3.9, -4.1, -4.22, -4.30, -4.40, -4.80, -5.20, -5.36, -4.85, -3.6,
        ],
        buccal: [
            3.0, 3.2, 3.5, 3.95, 4.24, 4.40, 4.90, 5.12, 4.95, 4.55, 3.85, 2.4,
        ],
        lingual: [
            -3.0, -3.2, -3.5, -3.95, -4.24, -4.38, -4.62, -4.98, -5.15, -5.05, -4.5, -3.0,
        ],
        widest: [
            0.0, 0.0, 0.0, 0.0, 0.0, 0.02, 0.05, 0.05, 0.05, 0.05, 0.05, 0.05,
        ],
        crest: [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.1, 0.2, 0.3, 0.3, 0.3, 0.2],
        flat: [2.6, 2.5],
        round: [2.4, 1.72, 1.85],
        taper: 0.13,
        apex: 1.5,
        cej: [1.0, 0.6, 0.1],
    },
    fissures: &FIRST_FISSURES,
    edge: 0.7,
    chewing: |x, y, relief| {
        let mut height = cusps(&FIRST_CUSPS, x, y, relief, 0.45);
        // The fossa has a floor. A fissure as deep as the cones would cut is no solid on any grid used here.
        height = smooth_max(height, 7.2 - 2.45 * relief, 0.5);
        height = smooth_max(
            height,
            marginal(
                &[
                    [3.9, 2.3, 6.4],
                    [4.5, 0.9, 6.1],
                    [4.45, -1.1, 6.1],
                    [3.8, -2.7, 6.6],
                ],
                0.8,
                x,
                y,
            ),
            0.6,
        );
        height = smooth_max(
            height,
            marginal(
                &[[-4.4, 0.9, 5.9], [-4.45, -0.9, 5.7], [-3.5, -2.6, 6.3]],
                0.8,
                x,
                y,
            ),
            0.6,
        );
        // Developmental grooves, supplementary ones beside the triangular ridges, and pits.
        height
            - deepest(&[
                groove(FIRST_FISSURES.main[0], 0.2, 0.42, x, y),
                groove(FIRST_FISSURES.main[1], 0.22, 0.42, x, y),
                groove(FIRST_FISSURES.main[2], 0.18, 0.42, x, y),
                groove(FIRST_FISSURES.main[3], 0.22, 0.42, x, y),
                branch(FIRST_FISSURES.branches[0], x, y),
                branch(FIRST_FISSURES.branches[1], x, y),
                branch(FIRST_FISSURES.branches[2], x, y),
                branch(FIRST_FISSURES.branches[3], x, y),
                branch(FIRST_FISSURES.branches[4], x, y),
                branch(FIRST_FISSURES.branches[5], x, y),
                branch(FIRST_FISSURES.branches[6], x, y),
            ])
            - deepest(&[
                pit([-0.4, -0.2], 0.16, 0.6, x, y),
                pit([3.0, -0.1], 0.16, 0.55, x, y),
                pit([-3.2, -0.4], 0.12, 0.5, x, y),
            ])
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
            x: [2.1, 2.85, 2.85, 2.1],
            depth: [0.8, 5.0, 9.0, 12.2],
            half: [2.05, 1.85, 1.5, 1.05],
            stretch: [1.8, 2.0, 1.9, 1.6],
            apex: 1.6,
            groove: 0.34,
        },
        distal: Tube {
            x: [-2.0, -2.85, -3.5, -3.8],
            depth: [0.8, 5.0, 8.6, 11.5],
            half: [2.1, 1.85, 1.45, 1.05],
            stretch: [1.76, 1.9, 1.65, 1.4],
            apex: 1.6,
            groove: 0.14,
        },
        roof: [3.25, 4.05],
        reach: 4.0,
        arch: 1.0,
    }),
};

static FIRST_FISSURES: Fissures = Fissures {
    main: &[
        &[
            [3.0, -0.1],
            [2.2, 0.2],
            [1.15, 0.1],
            [0.3, -0.25],
            [-0.4, -0.2],
            [-1.2, 0.15],
            [-1.95, 0.15],
            [-3.2, -0.4],
        ],
        &[[1.15, 0.1], [1.3, 1.3], [1.15, 2.5], [1.1, 5.5]],
        &[[-1.95, 0.15], [-2.3, 1.3], [-2.6, 2.3], [-2.8, 5.0]],
        &[[-0.4, -0.2], [0.0, -1.3], [0.35, -2.5], [0.35, -5.5]],
    ],
    branches: &[
        [[3.0, -0.1], [3.7, 1.6]],
        [[3.0, -0.1], [3.65, -1.8]],
        [[1.25, 1.2], [2.1, 2.2]],
        [[-1.2, 0.15], [-1.6, 1.9]],
        [[0.0, -1.2], [1.2, -2.3]],
        [[-0.2, -0.9], [-1.0, -2.3]],
        [[-3.2, -0.4], [-3.1, -1.9]],
    ],
};

static FIRST_CUSPS: [Cusp; 5] = [
    Cusp {
        tip: [3.05, 2.8, 7.15],
        towards: [1.7, 0.0],
        slopes: [0.80, 0.45, 0.5, 0.55],
        blunt: 0.6,
    },
    Cusp {
        tip: [-0.7, 3.0, 7.05],
        towards: [-0.45, 0.0],
        slopes: [0.78, 0.45, 0.5, 0.5],
        blunt: 0.6,
    },
    Cusp {
        tip: [-3.8, 1.55, 6.55],
        towards: [-2.2, 0.1],
        slopes: [0.70, 0.45, 0.5, 0.5],
        blunt: 0.6,
    },
    Cusp {
        tip: [2.85, -3.1, 7.6],
        towards: [1.3, 0.0],
        slopes: [0.88, 0.45, 0.55, 0.6],
        blunt: 0.5,
    },
    Cusp {
        tip: [-2.15, -3.15, 7.4],
        towards: [-1.0, 0.0],
        slopes: [0.86, 0.45, 0.6, 0.55],
        blunt: 0.5,
    },
];

/// Mesiobuccal, distobuccal, mesiolingual, distolingual cusp.
pub(super) static SECOND: Form = Form {
    usual: Size {
        mesiodistal: 10.5,
        buccolingual: 10.0,
        crown: 7.0,
        root: 13.0,
    },
    drawn: Size {
        mesiodistal: 10.494,
        buccolingual: 9.978,
        crown: 7.014,
        root: 12.895,
    },
    grid: 0.27,
    walls: Walls {
        z: [
            -9.0, -7.0, -5.0, -3.0, -1.2, 0.0, 1.0, 2.3, 3.4, 4.5, 5.8, 8.0,
        ],
        mesial: [
            3.1, 3.3, 3.5, 3.65, 3.78, 3.85, 3.96, 4.45, 4.94, 5.20, 4.8, 3.8,
        ],
        distal: [
            -3.1, -3.3, -3.5, -3.65, -3.78, -3.88, -4.0, -4.45, -4.90, -5.10, -4.65, -3.5,
        ],
        buccal: [
            3.0, 3.2, 3.6, 4.05, 4.27, 4.40, 4.70, 4.88, 4.72, 4.35, 3.7, 2.3,
        ],
        lingual: [
            -3.0, -3.2, -3.6, -4.05, -4.27, -4.38, -4.52, -4.75, -4.88, -4.78, -4.25, -2.9,
        ],
        widest: [
            0.0, 0.0, 0.0, 0.0, 0.0, 0.02, 0.05, 0.05, 0.05, 0.05, 0.05, 0.05,
        ],
        crest: [
            0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.05, 0.1, 0.15, 0.15, 0.15, 0.1,
        ],
        flat: [2.6, 2.5],
        round: [2.4, 1.72, 1.85],
        taper: 0.13,
        apex: 1.5,
        cej: [1.0, 0.6, 0.1],
    },
    fissures: &SECOND_FISSURES,
    edge: 0.7,
    chewing: |x, y, relief| {
        let mut height = cusps(&SECOND_CUSPS, x, y, relief, 0.45);
        height = smooth_max(
            height,
            marginal(
                &[
                    [3.5, 2.3, 6.0],
                    [4.15, 0.8, 5.7],
                    [4.1, -0.9, 5.7],
                    [3.4, -2.5, 6.1],
                ],
                0.8,
                x,
                y,
            ),
            0.6,
        );
        height = smooth_max(
            height,
            marginal(
                &[
                    [-3.4, 2.2, 5.8],
                    [-4.1, 0.8, 5.45],
                    [-4.0, -0.9, 5.45],
                    [-3.3, -2.4, 5.9],
                ],
                0.8,
                x,
                y,
            ),
            0.6,
        );
        // Developmental grooves, supplementary ones beside the triangular ridges, and pits.
        height
            - deepest(&[
                groove(SECOND_FISSURES.main[0], 0.2, 0.42, x, y),
                groove(SECOND_FISSURES.main[1], 0.2, 0.42, x, y),
                groove(SECOND_FISSURES.main[2], 0.2, 0.42, x, y),
                branch(SECOND_FISSURES.branches[0], x, y),
                branch(SECOND_FISSURES.branches[1], x, y),
                branch(SECOND_FISSURES.branches[2], x, y),
                branch(SECOND_FISSURES.branches[3], x, y),
                branch(SECOND_FISSURES.branches[4], x, y),
                branch(SECOND_FISSURES.branches[5], x, y),
                branch(SECOND_FISSURES.branches[6], x, y),
                branch(SECOND_FISSURES.branches[7], x, y),
            ])
            - deepest(&[
                pit([0.0, -0.1], 0.16, 0.6, x, y),
                pit([2.85, 0.0], 0.16, 0.55, x, y),
                pit([-2.85, 0.0], 0.14, 0.5, x, y),
            ])
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
            x: [1.75, 2.15, 1.9, 1.1],
            depth: [0.8, 5.0, 8.6, 11.4],
            half: [1.9, 1.65, 1.35, 0.98],
            stretch: [1.92, 2.2, 2.0, 1.6],
            apex: 1.5,
            groove: 0.28,
        },
        distal: Tube {
            x: [-1.7, -2.2, -2.45, -2.5],
            depth: [0.8, 5.0, 8.2, 10.7],
            half: [1.9, 1.62, 1.25, 0.85],
            stretch: [1.9, 2.05, 1.8, 1.4],
            apex: 1.5,
            groove: 0.12,
        },
        roof: [3.2, 4.0],
        reach: 4.0,
        arch: 1.0,
    }),
};

static SECOND_FISSURES: Fissures = Fissures {
    main: &[
        &[
            [2.85, 0.0],
            [1.9, 0.2],
            [0.9, 0.15],
            [0.0, -0.1],
            [-1.0, 0.1],
            [-1.9, 0.15],
            [-2.85, 0.0],
        ],
        &[[0.15, 5.0], [0.1, 2.6], [-0.12, 1.2], [0.0, -0.1]],
        &[[0.0, -0.1], [0.2, -1.3], [0.1, -2.6], [0.05, -5.0]],
    ],
    branches: &[
        [[2.85, 0.0], [3.4, 1.6]],
        [[2.85, 0.0], [3.35, -1.7]],
        [[-2.85, 0.0], [-3.3, 1.5]],
        [[-2.85, 0.0], [-3.2, -1.6]],
        [[-0.1, 1.1], [1.0, 2.2]],
        [[-0.1, 1.1], [-1.1, 2.2]],
        [[0.2, -1.2], [1.1, -2.3]],
        [[0.15, -1.0], [-1.0, -2.2]],
    ],
};

static SECOND_CUSPS: [Cusp; 4] = [
    Cusp {
        tip: [2.5, 2.7, 6.85],
        towards: [1.1, 0.0],
        slopes: [0.80, 0.45, 0.5, 0.55],
        blunt: 0.6,
    },
    Cusp {
        tip: [-2.35, 2.65, 6.7],
        towards: [-1.1, 0.0],
        slopes: [0.78, 0.45, 0.55, 0.5],
        blunt: 0.6,
    },
    Cusp {
        tip: [2.35, -2.9, 7.1],
        towards: [1.0, 0.0],
        slopes: [0.86, 0.45, 0.55, 0.6],
        blunt: 0.5,
    },
    Cusp {
        tip: [-2.3, -2.85, 6.9],
        towards: [-0.9, 0.0],
        slopes: [0.84, 0.45, 0.6, 0.55],
        blunt: 0.5,
    },
];

/// The trunk is fluted towards the furcation, deeper buccally.
fn flutes(spot: &Spot) -> f64 {
    let (buccal, lingual) = (ramp(spot.v, 0.2, 0.8), ramp(-spot.v, 0.2, 0.8));
    let depth = -spot.p.z;
    // On the proximal faces the grooves of the roots begin.
    let proximal = ramp(spot.u.abs(), 0.3, 0.9) * if spot.u > 0.0 { 0.3 } else { 0.12 };
    (0.75 * buccal + 0.6 * lingual) * bell(spot.p.x, 1.1) * ramp(depth, 0.3, 3.2)
        + proximal * bell(spot.p.y, 1.1) * ramp(depth, 1.0, 4.5)
}
