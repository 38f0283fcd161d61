//! The collar as a closed mesh to look at: one profile for each angle, swept round the tooth.

use std::f64::consts::TAU;

use sulcus_core::Vec3;

use super::Collar;
use crate::mesh::TriMesh;

/// Angles of the sweep.
const ANGLES: usize = 144;
/// How far what is attached goes into the tooth, mm.
const OVERLAP: f64 = 0.3;
/// Rows of the pocket's wall, of the round crest and of the outer face.
const WALL: usize = 6;
const CREST: usize = 5;
const OUTER: usize = 10;

/// The closed surface, metres, in the tooth's frame.
pub fn skin(collar: &Collar) -> TriMesh {
    let profiles = crate::parallel::map(ANGLES, |k| profile(collar, TAU * k as f64 / ANGLES as f64));
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
    let (foot, top) = (floor + fillet, (crest - 0.25 * collar.sizes.crest).max(floor + fillet));
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
        // Denser where the margin is.
        let z = top + (base - top) * share * (0.4 + 0.6 * share);
        put(collar.outer(around, z, crest), z);
    }
    points
}
