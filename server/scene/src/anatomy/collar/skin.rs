//! The collar as a closed mesh for display: one profile for each angle, swept round the tooth.

use std::f64::consts::TAU;

use sulcus_core::Vec3;

use super::Collar;
use crate::mesh::TriMesh;

/// Angles of the sweep.
const ANGLES: usize = 144;
/// Depth of attached tissue inside the tooth, mm.
const OVERLAP: f64 = 0.3;
/// Rows of the pocket's wall, of the round crest and of the outer face.
const WALL: usize = 6;
const CREST: usize = 5;
const OUTER: usize = 10;

/// The closed surface, metres, in the tooth's frame.
pub fn skin(collar: &Collar) -> TriMesh {
    let angles = angles(collar);
    let profiles = crate::parallel::map(ANGLES, |k| profile(collar, angles[k]));
    let rows = profiles[0].len();
    let mut mesh = TriMesh {
        vertices: profiles.into_iter().flatten().collect(),
        triangles: Vec::with_capacity(2 * rows * ANGLES),
    };
    for k in 0..ANGLES {
        let next = (k + 1) % ANGLES;
        for row in 0..rows {
            let above = (row + 1) % rows;
            let corner = |k: usize, row: usize| (k * rows + row) as u32;
            let (a, b) = (corner(k, row), corner(next, row));
            let (c, d) = (corner(next, above), corner(k, above));
            // Cut along the shorter diagonal.
            let p = |v: u32| mesh.vertices[v as usize];
            if (p(a) - p(c)).norm() <= (p(b) - p(d)).norm() {
                mesh.triangles.extend([[a, c, b], [a, d, c]]);
            } else {
                mesh.triangles.extend([[a, d, b], [b, d, c]]);
            }
        }
    }
    mesh
}

/// Height of the first search for the corners to the neighbours, mm.
const REFERENCE: f64 = 0.0;

/// Angles of the corners where the outer face meets the planes to the neighbours at a height, ascending.
fn corners(collar: &Collar, z: f64) -> Vec<f64> {
    let mut corners: Vec<f64> = collar
        .neighbours
        .iter()
        .flatten()
        .flat_map(|neighbour| [false, true].map(|lingual| neighbour.corner(lingual, z)))
        .map(|[x, y]| libm::atan2(y, x).rem_euclid(TAU))
        .collect();
    corners.sort_by(f64::total_cmp);
    corners
}

/// Returns angles all round, some of them at the corners.
fn angles(collar: &Collar) -> Vec<f64> {
    let mut angles: Vec<f64> = (0..ANGLES)
        .map(|k| TAU * k as f64 / ANGLES as f64)
        .collect();
    for corner in corners(collar, REFERENCE) {
        let nearest = (corner / TAU * ANGLES as f64).round() as usize % ANGLES;
        angles[nearest] = corner;
    }
    angles
}

/// Returns the angle at height `z` for the angle `around` at the reference height. Corners map to corners.
fn followed(collar: &Collar, around: f64, z: f64) -> f64 {
    let (from, to) = (corners(collar, REFERENCE), corners(collar, z));
    let n = from.len();
    if n == 0 {
        return around;
    }
    let after = from
        .iter()
        .position(|corner| around <= *corner)
        .unwrap_or(n);
    let before = (after + n - 1) % n;
    let turn = |angles: &[f64], k: usize| {
        // Round the whole circle.
        angles[k % n] + if k >= n { TAU } else { 0.0 }
    };
    let (low, high) = if after == 0 {
        ([from[before] - TAU, to[before] - TAU], [from[0], to[0]])
    } else {
        (
            [from[before], to[before]],
            [turn(&from, after), turn(&to, after)],
        )
    };
    let share = (around - low[0]) / (high[0] - low[0]).max(1e-9);
    low[1] + share * (high[1] - low[1])
}

/// One section, from the base in the tooth over floor, wall, crest and outer face back to the base.
fn profile(collar: &Collar, around: f64) -> Vec<Vec3> {
    let (sine, cosine) = (libm::sin(around), libm::cos(around));
    let (floor, crest) = (collar.floor(around), collar.crest(around));
    let crest = crest.max(floor + 0.05);
    let base = collar.sizes.base;
    let mut points = Vec::new();
    let mut put = |r: f64, z: f64| points.push(Vec3::new(r * cosine, r * sine, z) * 1e-3);
    let in_tooth = |z: f64| (collar.sections.radius(around, z) - OVERLAP).max(0.1);
    put(in_tooth(base), base);
    put(in_tooth(floor), floor);
    // A fillet between floor and wall.
    let fillet = (0.5 * collar.sizes.width).min(0.4 * (crest - floor));
    put(collar.inner(around, floor) - fillet, floor);
    let (foot, top) = (
        floor + fillet,
        (crest - 0.25 * collar.sizes.crest).max(floor + fillet),
    );
    for k in 0..WALL {
        let z = foot + (top - foot) * k as f64 / (WALL - 1) as f64;
        put(collar.inner(around, z), z);
    }
    let round = crest - top;
    for k in 1..=CREST {
        let turn = std::f64::consts::PI * k as f64 / (CREST + 1) as f64;
        let outer = collar.outer(around, top, crest);
        let inner = collar.inner(around, top);
        let r = 0.5 * (inner + outer) - 0.5 * (outer - inner) * libm::cos(turn);
        put(r, top + round * libm::sin(turn));
    }
    for k in 0..OUTER {
        let share = k as f64 / (OUTER - 1) as f64;
        // Rows are denser near the margin.
        let z = top + (base - top) * share * (0.4 + 0.6 * share);
        let there = followed(collar, around, z);
        let r = collar.outer(there, z, crest);
        points.push(Vec3::new(r * libm::cos(there), r * libm::sin(there), z) * 1e-3);
    }
    points
}
