//! What hangs together: tetrahedra that meet in a vertex only are parted there, the largest piece is kept.

use sulcus_core::Vec3;

use super::lattice::Filled;
use super::{MOST_APART, stencil::six_volumes};
use crate::edges::Sets;
use crate::mesh::TriMesh;

/// Faces of a tetrahedron, outward: face k is opposite corner k.
const FACES: [[usize; 3]; 4] = [[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]];

/// Every face of every tetrahedron: its sorted corners, the tetrahedron, which of its faces. Faces of two come together.
fn faces(tets: &[[u32; 4]]) -> Vec<([u32; 3], u32, u8)> {
    let mut all = Vec::with_capacity(4 * tets.len());
    for (t, tet) in tets.iter().enumerate() {
        for (k, face) in FACES.iter().enumerate() {
            let mut corners = face.map(|corner| tet[corner]);
            corners.sort_unstable();
            all.push((corners, t as u32, k as u8));
        }
    }
    all.sort_unstable();
    all
}

/// The surface of tetrahedra: faces that only one has, outward.
pub fn outside(nodes: &[Vec3], tets: &[[u32; 4]]) -> TriMesh {
    let mut mesh = TriMesh::default();
    let mut new = vec![u32::MAX; nodes.len()];
    for shared in faces(tets).chunk_by(|a, b| a.0 == b.0) {
        let &[(_, tet, face)] = shared else { continue };
        let triangle = FACES[usize::from(face)].map(|k| {
            let node = tets[tet as usize][k] as usize;
            if new[node] == u32::MAX {
                new[node] = mesh.vertices.len() as u32;
                mesh.vertices.push(nodes[node]);
            }
            new[node]
        });
        mesh.triangles.push(triangle);
    }
    mesh
}

/// The largest piece, its nodes in the order of its tetrahedra, each node of one fan of tetrahedra only.
///
/// # Errors
/// None when there is nothing; the number of other pieces and their share of the volume when that is too much.
pub fn largest((places, tets): Filled) -> Result<Filled, Option<(usize, f64)>> {
    // Corners are the same node where a face joins their tetrahedra. A node of the lattice moved onto the surface can lie
    // between two sides that have only it, or an edge, in common: it becomes two.
    let slot = |tet: u32, k: usize| 4 * tet + k as u32;
    let mut nodes = Sets::new(4 * tets.len());
    let mut joined = Sets::new(tets.len());
    for shared in faces(&tets).chunk_by(|a, b| a.0 == b.0) {
        let &[(corners, one, _), (_, other, _)] = shared else {
            continue;
        };
        joined.join(one, other);
        for corner in corners {
            let of = |tet: u32| {
                let k = tets[tet as usize].iter().position(|&c| c == corner);
                slot(tet, k.unwrap_or(0))
            };
            nodes.join(of(one), of(other));
        }
    }
    let volume = |tet: &[u32; 4]| six_volumes(&tet.map(|k| places[k as usize]));
    let mut volumes = vec![0.0; tets.len()];
    let mut pieces = 0;
    for (t, tet) in tets.iter().enumerate() {
        let piece = joined.find(t as u32) as usize;
        pieces += usize::from(volumes[piece] == 0.0);
        volumes[piece] += volume(tet);
    }
    let whole: f64 = volumes.iter().sum();
    let best = (0..tets.len()).max_by(|&a, &b| volumes[a].total_cmp(&volumes[b]).then(b.cmp(&a)));
    let best = best.ok_or(None)?;
    let apart = 1.0 - volumes[best] / whole;
    if apart > MOST_APART {
        return Err(Some((pieces - 1, apart)));
    }
    let mut kept: Filled = Default::default();
    let mut new = vec![u32::MAX; 4 * tets.len()];
    for (t, tet) in (0..).zip(&tets) {
        if joined.find(t) as usize != best {
            continue;
        }
        kept.1.push([0, 1, 2, 3].map(|k| {
            let node = nodes.find(slot(t, k)) as usize;
            if new[node] == u32::MAX {
                new[node] = kept.0.len() as u32;
                kept.0.push(places[tet[k] as usize]);
            }
            new[node]
        }));
    }
    Ok(kept)
}
