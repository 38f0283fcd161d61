//! The surface of a mesh of tetrahedra.

use std::collections::BTreeMap;

use crate::TetMesh;
use crate::element::EDGES;

/// A face of the surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Face {
    /// Its corners, anticlockwise seen from outside.
    pub corners: [u32; 3],
    /// Nodes in the middle of the edges from the first to the second, to the third, back to the first.
    pub middles: [u32; 3],
}

/// Corners of each face of a tetrahedron, anticlockwise seen from outside.
const FACES: [[usize; 3]; 4] = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]];

/// The faces that belong to one tetrahedron only, in the order of their sorted corners.
pub fn boundary(mesh: &TetMesh) -> Vec<Face> {
    let mut faces: BTreeMap<[u32; 3], Option<Face>> = BTreeMap::new();
    for tet in &mesh.tets {
        for corners in FACES {
            let middle = |a: usize, b: usize| {
                let edge = EDGES.iter().position(|e| *e == [a, b] || *e == [b, a]);
                tet[4 + edge.unwrap_or(0)]
            };
            let [a, b, c] = corners;
            let face = Face {
                corners: corners.map(|k| tet[k]),
                middles: [middle(a, b), middle(b, c), middle(c, a)],
            };
            let mut key = face.corners;
            key.sort_unstable();
            // What comes twice is inside.
            faces
                .entry(key)
                .and_modify(|face| *face = None)
                .or_insert(Some(face));
        }
    }
    faces.into_values().flatten().collect()
}
