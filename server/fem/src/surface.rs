//! Boundary of a mesh.

use std::collections::BTreeMap;

use crate::mesh::TetMesh;

/// Corners of each face of a tetrahedron, anticlockwise as seen from outside, then the middles of its edges.
///
/// The edges run from the first to the second, second to third, and third to first corner.
const FACES: [[usize; 6]; 4] = [
    [0, 2, 1, 6, 5, 4],
    [0, 1, 3, 4, 8, 7],
    [1, 2, 3, 5, 9, 8],
    [2, 0, 3, 6, 7, 9],
];

impl TetMesh {
    /// Returns the faces of the boundary: those of one tetrahedron alone.
    ///
    /// A face has three corners, anticlockwise as seen from outside, then the middles of the edges from first to
    /// second, second to third and third to first corner.
    ///
    /// Faces are in the order of the tetrahedra. Of one tetrahedron, the face opposite its last corner comes first,
    /// then those opposite corners 2, 0, 1.
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

    /// Returns the corners of [`Self::boundary_faces`]: flat triangles, anticlockwise as seen from outside.
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
