//! The canine: one cusp with the mesial slope shorter, a strong cingulum, the longest root.

use super::form::{Fissures, Form, Size};
use super::section::Walls;
use crate::mesh::implicit::{bell, ramp};

pub(super) static CANINE: Form = Form {
    usual: Size {
        mesiodistal: 7.0,
        buccolingual: 7.5,
        crown: 11.0,
        root: 16.0,
    },
    drawn: Size {
        mesiodistal: 7.045,
        buccolingual: 7.536,
        crown: 11.047,
        root: 15.988,
    },
    grid: 0.235,
    walls: Walls {
        z: [
            -14.4, -12.0, -8.0, -4.0, -1.0, 0.5, 2.3, 4.2, 6.2, 8.2, 9.8, 11.5,
        ],
        mesial: [
            0.72, 1.35, 2.08, 2.48, 2.62, 2.64, 2.66, 2.88, 3.18, 3.36, 3.25, 2.8,
        ],
        distal: [
            -1.32, -1.70, -2.18, -2.50, -2.62, -2.66, -2.86, -3.24, -3.46, -3.36, -3.0, -2.4,
        ],
        buccal: [
            1.28, 2.0, 2.85, 3.30, 3.42, 3.52, 3.56, 3.22, 2.58, 1.75, 0.98, 0.0,
        ],
        lingual: [
            -1.48, -2.2, -3.05, -3.42, -3.45, -3.58, -3.72, -3.05, -2.18, -1.50, -1.02, -0.55,
        ],
        widest: [
            -0.1, -0.1, -0.1, 0.0, 0.2, 0.3, 0.4, 0.45, 0.35, 0.2, 0.05, -0.1,
        ],
        crest: [
            -0.3, -0.15, 0.0, 0.0, 0.05, 0.1, 0.15, 0.25, 0.35, 0.4, 0.45, 0.45,
        ],
        flat: [2.0, 2.1],
        round: [2.3, 2.0, 1.9],
        taper: 0.0,
        apex: 1.6,
        cej: [2.5, 1.6, 0.2],
    },
    fissures: &Fissures::NONE,
    edge: 0.5,
    chewing: |x, y, _| {
        let d = x - 0.45;
        let soft = (d * d + 0.16).sqrt() - 0.4;
        let across = (y * y + 0.25).sqrt() - 0.5;
        11.05 - 0.35 * across - soft * if d > 0.0 { 0.50 } else { 0.62 }
    },
    carving: |spot| {
        let (p, z) = (&spot.p, spot.p.z / 11.0);
        let lingual = ramp(-spot.v, 0.1, 0.7);
        // Two shallow fossae beside the lingual ridge, framed by the marginal ridges.
        let fossae = 0.32
            * lingual
            * (bell(spot.u - 0.42, 0.24) + bell(spot.u + 0.42, 0.24))
            * ramp(z, 0.3, 0.5)
            * (1.0 - ramp(z, 0.72, 0.95));
        let labial = ramp(spot.v, 0.1, 0.7);
        let lobes = 0.14
            * labial
            * (bell(spot.u - 0.5, 0.2) + bell(spot.u + 0.5, 0.2))
            * ramp(z, 0.4, 0.75);
        let side = ramp(-p.z, 0.0, 4.0) * (1.0 - ramp(-p.z, 10.0, 14.5));
        let depth = if spot.u > 0.0 { 0.22 } else { 0.32 };
        fossae + lobes + depth * ramp(spot.u.abs(), 0.3, 0.8) * bell(p.y, 1.1) * side
    },
    roots: None,
};
