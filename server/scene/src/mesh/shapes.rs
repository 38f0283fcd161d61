//! Simple solids with a known answer, for tests and benches: metres, closed, outward.

use std::collections::BTreeMap;

use sulcus_core::Vec3;

use crate::mesh::TriMesh;

/// Returns a sphere about the origin: an icosahedron whose triangles were cut in four `cuts` times.
pub fn icosphere(radius: f64, cuts: u32) -> TriMesh {
    let g = (1.0 + 5.0_f64.sqrt()) * 0.5;
    let corners = [
        [-1.0, g, 0.0],
        [1.0, g, 0.0],
        [-1.0, -g, 0.0],
        [1.0, -g, 0.0],
        [0.0, -1.0, g],
        [0.0, 1.0, g],
        [0.0, -1.0, -g],
        [0.0, 1.0, -g],
        [g, 0.0, -1.0],
        [g, 0.0, 1.0],
        [-g, 0.0, -1.0],
        [-g, 0.0, 1.0],
    ];
    let mut mesh = TriMesh {
        vertices: corners
            .iter()
            .map(|&[x, y, z]| Vec3::new(x, y, z).normalize() * radius)
            .collect(),
        triangles: vec![
            [0, 11, 5],
            [0, 5, 1],
            [0, 1, 7],
            [0, 7, 10],
            [0, 10, 11],
            [1, 5, 9],
            [5, 11, 4],
            [11, 10, 2],
            [10, 7, 6],
            [7, 1, 8],
            [3, 9, 4],
            [3, 4, 2],
            [3, 2, 6],
            [3, 6, 8],
            [3, 8, 9],
            [4, 9, 5],
            [2, 4, 11],
            [6, 2, 10],
            [8, 6, 7],
            [9, 8, 1],
        ],
    };
    for _ in 0..cuts {
        let mut middles = BTreeMap::new();
        let mut cut = Vec::with_capacity(mesh.triangles.len() * 4);
        let vertices = &mut mesh.vertices;
        let mut middle = |a: u32, b: u32| {
            *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                let between = (vertices[a as usize] + vertices[b as usize]).normalize() * radius;
                vertices.push(between);
                vertices.len() as u32 - 1
            })
        };
        for &[a, b, c] in &mesh.triangles {
            let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
            cut.extend([[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]);
        }
        mesh.triangles = cut;
    }
    mesh
}

/// Returns an ellipsoid about the origin with the given semi-axes (metres), as fine as [`icosphere`].
pub fn ellipsoid(semi_axes: Vec3, cuts: u32) -> TriMesh {
    let mut mesh = icosphere(1.0, cuts);
    for vertex in &mut mesh.vertices {
        vertex.component_mul_assign(&semi_axes);
    }
    mesh
}

/// Returns a box about the origin with the given half edges (metres): twelve triangles, sharp edges.
pub fn cuboid(half: Vec3) -> TriMesh {
    let sign = |bit: bool| if bit { 1.0 } else { -1.0 };
    TriMesh {
        vertices: (0..8_u32)
            .map(|k| {
                half.component_mul(&Vec3::new(
                    sign(k & 1 != 0),
                    sign(k & 2 != 0),
                    sign(k & 4 != 0),
                ))
            })
            .collect(),
        triangles: vec![
            [0, 2, 3],
            [0, 3, 1],
            [4, 5, 7],
            [4, 7, 6],
            [0, 1, 5],
            [0, 5, 4],
            [2, 6, 7],
            [2, 7, 3],
            [0, 4, 6],
            [0, 6, 2],
            [1, 3, 7],
            [1, 7, 5],
        ],
    }
}
