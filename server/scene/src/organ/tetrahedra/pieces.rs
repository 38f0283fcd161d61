//! Connected pieces: tetrahedra that meet in a vertex only are parted there, and the largest piece is kept.

use std::collections::BTreeSet;

use sulcus_core::Vec3;

use super::lattice::Filled;
use super::stencil::six_volumes;
use crate::mesh::edges::Sets;

/// Largest share of the volume that may be disconnected from the largest piece. It is left out.
pub const MOST_APART: f64 = 0.01;

/// Faces of a tetrahedron, outward: face k is opposite corner k.
const FACES: [[usize; 3]; 4] = [[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]];

/// Returns every face of every tetrahedron: its sorted corners, the tetrahedron, its number there.
///
/// The two entries of a common face are consecutive.
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

/// The largest piece.
pub struct Piece {
    /// Vertices, metres, in the order of the tetrahedra.
    pub nodes: Vec<Vec3>,
    /// Index of each vertex before.
    pub before: Vec<u32>,
    /// Tetrahedra. Those at a vertex are connected by faces at it.
    pub tets: Vec<[u32; 4]>,
}

impl Piece {
    /// Returns the former indices of vertices at which the boundary touches itself: its triangles there are more than
    /// one fan.
    pub fn touching(&self) -> BTreeSet<u32> {
        let mut triangles = Vec::new();
        for shared in faces(&self.tets).chunk_by(|a, b| a.0 == b.0) {
            if let &[(corners, ..)] = shared {
                triangles.push(corners);
            }
        }
        // Sides of triangles: the vertices at the ends, and the triangle's corners there.
        let mut sides = Vec::with_capacity(3 * triangles.len());
        for (t, triangle) in (0..).zip(&triangles) {
            for [a, b] in [[0, 1], [1, 2], [0, 2]] {
                sides.push((
                    [triangle[a], triangle[b]],
                    [3 * t + a as u32, 3 * t + b as u32],
                ));
            }
        }
        sides.sort_unstable();
        let mut fans = Sets::new(3 * triangles.len());
        for side in sides.chunk_by(|a, b| a.0 == b.0) {
            if let &[(_, one), (_, other)] = side {
                fans.join(one[0], other[0]);
                fans.join(one[1], other[1]);
            }
        }
        let mut fan_of = vec![u32::MAX; self.nodes.len()];
        let mut found = BTreeSet::new();
        for (corner, &vertex) in (0..).zip(triangles.iter().flatten()) {
            let (fan, known) = (fans.find(corner), &mut fan_of[vertex as usize]);
            if *known != u32::MAX && *known != fan {
                found.insert(self.before[vertex as usize]);
            }
            *known = fan;
        }
        found
    }
}

/// Returns the largest piece. Each of its vertices has one fan of tetrahedra only.
///
/// # Errors
/// `None` if there are no tetrahedra; the number of other pieces and their share of the volume if the share is too
/// large.
pub fn largest((places, tets): &Filled) -> Result<Piece, Option<(usize, f64)>> {
    // Corners are the same node if a face joins their tetrahedra.
    //
    // A lattice node moved onto the surface can lie between two sides that share only this node, or an edge. It
    // becomes two nodes.
    let slot = |tet: u32, k: usize| 4 * tet + k as u32;
    let mut nodes = Sets::new(4 * tets.len());
    let mut joined = Sets::new(tets.len());
    for shared in faces(tets).chunk_by(|a, b| a.0 == b.0) {
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
    let mut kept = Piece {
        nodes: Vec::new(),
        before: Vec::new(),
        tets: Vec::new(),
    };
    let mut new = vec![u32::MAX; 4 * tets.len()];
    for (t, tet) in (0..).zip(tets) {
        if joined.find(t) as usize != best {
            continue;
        }
        kept.tets.push([0, 1, 2, 3].map(|k| {
            let node = nodes.find(slot(t, k)) as usize;
            if new[node] == u32::MAX {
                new[node] = kept.nodes.len() as u32;
                kept.nodes.push(places[tet[k] as usize]);
                kept.before.push(tet[k]);
            }
            new[node]
        }));
    }
    Ok(kept)
}
