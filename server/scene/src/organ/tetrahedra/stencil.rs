//! Part of a lattice tetrahedron inside the surface, cut into tetrahedra.
//!
//! The cut faces of a prism or pyramid are split by the diagonal from their lowest vertex. Both tetrahedra at a face
//! therefore agree, and a prism never gets the one split without tetrahedra.
//!
//! Source: Dompierre et al. 1999, "How to subdivide pyramids, prisms and hexahedra into tetrahedra".
//!
//! The order of the vertices decides the angles; the lattice defines it. A side of a prism on the surface is split in
//! the way with the larger smallest angle.

use sulcus_core::Vec3;

/// Side of a corner: inside, on the surface or outside.
pub type Side = i8;

/// Adds the inner part of the tetrahedron of `corners` to `out`.
///
/// `sides` are 1 inside, 0 on the surface, -1 outside. `cut` returns the vertex between a corner inside and one
/// outside, `rank` the order of vertices, `places` their places.
pub fn fill(
    mut corners: [u32; 4],
    mut sides: [Side; 4],
    cut: impl Fn(u32, u32) -> u32,
    rank: impl Fn(u32) -> u64,
    places: &[Vec3],
    out: &mut Vec<[u32; 4]>,
) {
    let inside = sides.iter().filter(|&&side| side > 0).count();
    if inside == 0 {
        return;
    }
    // Corners are sorted inside first, outside last. The tetrahedron keeps its orientation.
    let mut odd = false;
    for end in (1..4).rev() {
        for k in 0..end {
            if sides[k] < sides[k + 1] {
                sides.swap(k, k + 1);
                corners.swap(k, k + 1);
                odd = !odd;
            }
        }
    }
    if odd {
        // Two corners of the same side are exchanged. Of four corners two always have the same side.
        let k = (0..3).find(|&k| sides[k] == sides[k + 1]).unwrap_or(0);
        corners.swap(k, k + 1);
    }
    let [p, q, r, s] = corners;
    match (inside, sides[2], sides[3]) {
        (_, _, 0..) => out.push(corners),
        (1, _, _) => {
            let on = |k: usize| {
                if sides[k] < 0 {
                    cut(p, corners[k])
                } else {
                    corners[k]
                }
            };
            out.push([p, on(1), on(2), on(3)]);
        }
        (2, 0, _) => {
            let (pc, qc) = (cut(p, s), cut(q, s));
            if rank(p).min(rank(qc)) < rank(q).min(rank(pc)) {
                out.extend([[p, q, r, qc], [p, qc, r, pc]]);
            } else {
                out.extend([[p, q, r, pc], [q, qc, r, pc]]);
            }
        }
        (2, _, _) => {
            let [one, other] = [p, q].map(|k| [k, cut(k, r), cut(k, s)]);
            let (ways, mut way) = prism(one, other, rank);
            let first = ways[0][0][0];
            if first == p || first == q {
                // The third side lies on the surface, so no neighbour depends on its split.
                let [one, other] = ways.map(|tets| sharpest(&tets, places));
                way = usize::from(other < one);
            }
            out.extend(ways[way]);
        }
        _ => {
            let (ways, way) = prism([p, q, r], [p, q, r].map(|k| cut(k, s)), rank);
            out.extend(ways[way]);
        }
    }
}

/// Returns a prism cut in three, with both splits of its third side, and the split by the order of vertices.
///
/// `bottom` is clockwise as seen from outside, `top` anticlockwise. Two sides are split from the lowest vertex, which
/// is first in all tetrahedra.
fn prism(
    mut bottom: [u32; 3],
    mut top: [u32; 3],
    rank: impl Fn(u32) -> u64,
) -> ([[[u32; 4]; 3]; 2], usize) {
    let lowest = |of: &[u32; 3]| (0..3).min_by_key(|&k| rank(of[k])).unwrap_or(0);
    let (mut first, last) = (lowest(&bottom), lowest(&top));
    if rank(top[last]) < rank(bottom[first]) {
        // The prism is turned upside down.
        (bottom, top) = (top, bottom);
        bottom.swap(1, 2);
        top.swap(1, 2);
        first = (3 - last) % 3;
    }
    bottom.rotate_left(first);
    top.rotate_left(first);
    let ([a, b, c], [d, e, f]) = (bottom, top);
    let ways = [
        [[a, b, c, f], [a, b, f, e], [a, e, f, d]],
        [[a, b, c, e], [a, e, c, f], [a, e, f, d]],
    ];
    let second = rank(c).min(rank(e)) < rank(b).min(rank(f));
    (ways, usize::from(second))
}

/// Returns six times the volume of a tetrahedron, m3.
pub fn six_volumes(corners: &[Vec3; 4]) -> f64 {
    let [a, b, c, d] = corners;
    (b - a).dot(&(c - a).cross(&(d - a)))
}

/// Returns the cosines of the angles between the faces of a tetrahedron.
pub fn dihedral_cosines(corners: &[Vec3; 4]) -> [f64; 6] {
    // Outward normals, opposite each corner.
    let normals = [[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]].map(|[a, b, c]: [usize; 3]| {
        let normal = (corners[b] - corners[a]).cross(&(corners[c] - corners[a]));
        normal / normal.norm()
    });
    [[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]].map(|[a, b]: [usize; 2]| {
        sulcus_core::math::fclamp(-normals[a].dot(&normals[b]), -1.0, 1.0)
    })
}

/// Returns the largest cosine of an angle between two faces of one of these tetrahedra.
fn sharpest(tets: &[[u32; 4]], places: &[Vec3]) -> f64 {
    tets.iter()
        .flat_map(|tet| dihedral_cosines(&tet.map(|k| places[k as usize])))
        .fold(-1.0, sulcus_core::math::fmax)
}
