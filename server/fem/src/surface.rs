//! The boundary of a mesh.

use std::collections::BTreeMap;

use crate::TetMesh;

/// Corners of each face of a tetrahedron, anticlockwise seen from outside, then the middles of its edges: first to second,
/// second to third, third to first corner.
const FACES: [[usize; 6]; 4] = [
    [0, 2, 1, 6, 5, 4],
    [0, 1, 3, 4, 8, 7],
    [1, 2, 3, 5, 9, 8],
    [2, 0, 3, 6, 7, 9],
];

impl TetMesh {
    /// Faces of the boundary, those that one tetrahedron alone has: three corners, anticlockwise seen from outside, then the
    /// middles of the edges from the first to the second, second to third and third to first corner. In the order of the
    /// tetrahedra; of one with several faces on the boundary, that against its last corner first, then those against corners
    /// 2, 0, 1.
    pub fn boundary_faces(&self) -> Vec<[u32; 6]> {
        let faces = self.tets.iter().flat_map(|tet| {
            let of = |face: &[usize; 6]| face.map(|a| tet[a]);
            FACES.iter().map(of)
        });
        let key = |face: &[u32; 6]| {
            let mut corners = [face[0], face[1], face[2]];
            corners.sort_unstable();
            corners
        };
        let faces: Vec<[u32; 6]> = faces.collect();
        let mut seen = BTreeMap::new();
        for face in &faces {
            *seen.entry(key(face)).or_insert(0_u32) += 1;
        }
        let alone = faces.into_iter().filter(|face| seen[&key(face)] == 1);
        alone.collect()
    }

    /// Corners of [`Self::boundary_faces`]: flat triangles, seen from outside anticlockwise.
    pub fn boundary_triangles(&self) -> Vec<[u32; 3]> {
        let faces = self.boundary_faces().into_iter();
        faces.map(|[a, b, c, ..]| [a, b, c]).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::element::EDGES;

    #[test]
    fn middles_of_a_face_stand_between_its_corners() {
        for face in FACES {
            for k in 0..3 {
                let (i, j) = (face[k], face[(k + 1) % 3]);
                let edge = EDGES[face[3 + k] - 4];
                assert!(edge == [i, j] || edge == [j, i], "{face:?}");
            }
        }
    }
}
