//! What is left of a tetrahedron of the lattice inside the surface, cut into tetrahedra.
//!
//! The cut faces of a prism or pyramid are split by the diagonal from their lowest vertex (Dompierre et al. 1999, "How to
//! subdivide pyramids, prisms and hexahedra into tetrahedra"): both tetrahedra at a face agree without asking, and a prism is
//! never left in the one way that has no tetrahedra. The order of the vertices decides the angles; see
//! [`super::lattice::Lattice::stuff`].

use sulcus_core::Vec3;

/// Where a corner lies: inside, on the surface or outside.
pub type Side = i8;

/// Adds to `out` what is left of the tetrahedron of `corners` whose `sides` are 1 inside, 0 on the surface, -1 outside. `cut`
/// gives the vertex between a corner inside and one outside, `rank` the order of vertices.
pub fn fill(
    mut corners: [u32; 4],
    mut sides: [Side; 4],
    cut: impl Fn(u32, u32) -> u32,
    rank: impl Fn(u32) -> u64,
    out: &mut Vec<[u32; 4]>,
) {
    let inside = sides.iter().filter(|&&side| side > 0).count();
    if inside == 0 {
        return;
    }
    // Inside first, outside last, without turning the tetrahedron inside out.
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
        // Two of the same side change places: there are always two among four.
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
        (2, _, _) => prism(
            [p, cut(p, r), cut(p, s)],
            [q, cut(q, r), cut(q, s)],
            rank,
            out,
        ),
        _ => prism([p, q, r], [p, q, r].map(|k| cut(k, s)), rank, out),
    }
}

/// Cuts a prism, whose `bottom` is anticlockwise seen from outside its `top`'s far side, in three.
fn prism(
    mut bottom: [u32; 3],
    mut top: [u32; 3],
    rank: impl Fn(u32) -> u64,
    out: &mut Vec<[u32; 4]>,
) {
    let lowest = |of: &[u32; 3]| (0..3).min_by_key(|&k| rank(of[k])).unwrap_or(0);
    let (mut b, t) = (lowest(&bottom), lowest(&top));
    if rank(top[t]) < rank(bottom[b]) {
        // Upside down.
        (bottom, top) = (top, bottom);
        bottom.swap(1, 2);
        top.swap(1, 2);
        b = (3 - t) % 3;
    }
    bottom.rotate_left(b);
    top.rotate_left(b);
    let ([a0, a1, a2], [b0, b1, b2]) = (bottom, top);
    if rank(a1).min(rank(b2)) < rank(a2).min(rank(b1)) {
        out.extend([[a0, a1, a2, b2], [a0, a1, b2, b1], [a0, b1, b2, b0]]);
    } else {
        out.extend([[a0, a1, a2, b1], [a0, b1, a2, b2], [a0, b1, b2, b0]]);
    }
}

/// Six times the volume of a tetrahedron, m3.
pub fn six_volumes(corners: &[Vec3; 4]) -> f64 {
    let [a, b, c, d] = corners;
    (b - a).dot(&(c - a).cross(&(d - a)))
}

/// Cosines of the angles between the faces of a tetrahedron.
pub fn dihedral_cosines(corners: &[Vec3; 4]) -> [f64; 6] {
    // Outward, opposite each corner.
    let normals = [[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]].map(|[a, b, c]: [usize; 3]| {
        let normal = (corners[b] - corners[a]).cross(&(corners[c] - corners[a]));
        normal / normal.norm()
    });
    [[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]].map(|[a, b]: [usize; 2]| {
        sulcus_core::math::fclamp(-normals[a].dot(&normals[b]), -1.0, 1.0)
    })
}
