//! A patch for a hole: of all triangulations of its rim the one that bends least, then the smallest.
//!
//! Sources: Liepa, Filling Holes in Meshes, Symposium on Geometry Processing 2003, section 3; Barequet and Sharir
//! 1995.

use sulcus_core::Vec3;

use crate::mesh::TriMesh;
use crate::mesh::edges::Side;

/// The rim of a hole, in the direction in which the patch walks it.
pub(super) struct Rim {
    vertices: Vec<u32>,
    points: Vec<Vec3>,
    /// Unit normal of the triangle beyond the edge from vertex k to the next; `None` if it has no area.
    beyond: Vec<Option<Vec3>>,
    /// Whether one triangle is beyond all edges.
    flap: bool,
}

impl Rim {
    /// Returns the rim of a hole. `rim` has the direction of the triangles around the hole, which is opposite to the
    /// patch.
    pub(super) fn new(mesh: &TriMesh, rim: &[Side]) -> Self {
        let vertices: Vec<u32> = rim.iter().rev().map(|side| side.walked()[1]).collect();
        Self {
            points: vertices
                .iter()
                .map(|&v| mesh.vertices[v as usize])
                .collect(),
            vertices,
            flap: rim.iter().all(|side| side.triangle == rim[0].triangle),
            beyond: rim
                .iter()
                .rev()
                .map(|side| unit(mesh.area_vector(side.triangle as usize)))
                .collect(),
        }
    }
}

/// Penalty of a triangulation: its sharpest bend (1 - cos) and its area, both in steps above rounding, then the
/// squares of the lengths of its diagonals.
type Weight = (f64, f64, f64);

/// Returns the triangles of the best patch; `None` if no triangulation is possible.
///
/// `taken` returns whether an edge exists already. No diagonal may be such an edge.
pub(super) fn fill(rim: &Rim, taken: &dyn Fn(u32, u32) -> bool) -> Option<Vec<[u32; 3]>> {
    let n = rim.vertices.len();
    let own = |t: [usize; 3]| t.map(|k| rim.vertices[k]);
    if n == 3 {
        // A flap of one triangle would get a second one on its back.
        return (!rim.flap).then(|| vec![own([0, 1, 2])]);
    }
    let largest = rim.points.iter().fold(0.0_f64, |size, p| {
        sulcus_core::math::fmax(size, (p - rim.points[0]).norm_squared())
    });
    if largest <= 0.0 {
        return None;
    }
    let area = |i: usize, m: usize, j: usize| {
        let p = &rim.points;
        (p[m] - p[i]).cross(&(p[j] - p[i]))
    };
    let bend = |a: Option<Vec3>, b: Option<Vec3>| match (a, b) {
        (Some(a), Some(b)) => ((1.0 - a.dot(&b)) * 1e6).round() * 1e-6,
        _ => 2.0,
    };
    // best[i][j]: weight of the part between vertices i and j, and its third corner.
    let mut best = vec![vec![(None::<Weight>, 0_usize); n]; n];
    for i in 0..n - 1 {
        best[i][i + 1].0 = Some((0.0, 0.0, 0.0));
    }
    let normal = |best: &[Vec<(Option<Weight>, usize)>], i: usize, j: usize| {
        if j == i + 1 {
            rim.beyond[i]
        } else {
            unit(area(i, best[i][j].1, j))
        }
    };
    for span in 2..n {
        for i in 0..n - span {
            let j = i + span;
            let whole = (i, j) == (0, n - 1);
            if !whole && taken(rim.vertices[i], rim.vertices[j]) {
                continue;
            }
            let mut chosen: (Option<Weight>, usize) = (None, 0);
            for m in i + 1..j {
                let (Some(left), Some(right)) = (best[i][m].0, best[m][j].0) else {
                    continue;
                };
                let vector = area(i, m, j);
                let own = unit(vector);
                let mut sharpest = [left.0, right.0].into_iter().fold(
                    sulcus_core::math::fmax(
                        bend(own, normal(&best, i, m)),
                        bend(own, normal(&best, m, j)),
                    ),
                    sulcus_core::math::fmax,
                );
                if whole {
                    sharpest = sulcus_core::math::fmax(sharpest, bend(own, rim.beyond[n - 1]));
                }
                // Steps of a millionth of the hole, so rounding does not decide.
                let area = (vector.norm() / (1e-6 * largest)).round();
                let diagonal = (rim.points[i] - rim.points[j]).norm_squared();
                let weight = (
                    sharpest,
                    left.1 + right.1 + area,
                    left.2 + right.2 + if whole { 0.0 } else { diagonal },
                );
                if chosen.0.is_none_or(|least| weight < least) {
                    chosen = (Some(weight), m);
                }
            }
            best[i][j] = chosen;
        }
    }
    best[0][n - 1].0?;
    let mut patch = Vec::with_capacity(n - 2);
    let mut parts = vec![(0, n - 1)];
    while let Some((i, j)) = parts.pop() {
        if j - i < 2 {
            continue;
        }
        let m = best[i][j].1;
        patch.push(own([i, m, j]));
        parts.extend([(i, m), (m, j)]);
    }
    Some(patch)
}

fn unit(v: Vec3) -> Option<Vec3> {
    let length = v.norm();
    (length > 0.0).then(|| v / length)
}
