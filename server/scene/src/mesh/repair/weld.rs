//! Joining of vertices that are exactly or nearly in one place.

use crate::mesh::TriMesh;
use crate::mesh::edges::{Sets, Side, open_sides, sides};

/// Largest number of candidates for one edge in one cell of the grid. Meshes never have more; without a limit, many
/// edges in one place would take quadratic time.
const CANDIDATES: usize = 16;

/// Returns for each vertex the first vertex in exactly its place (0.0 equals -0.0).
fn first_in_place(mesh: &TriMesh) -> Vec<u32> {
    let key = |v: u32| {
        let place = mesh.vertices[v as usize];
        [place.x, place.y, place.z].map(|x| (x + 0.0).to_bits())
    };
    let mut order: Vec<u32> = (0..mesh.vertices.len() as u32).collect();
    order.sort_unstable_by_key(|&v| (key(v), v));
    let mut first = vec![0_u32; order.len()];
    for same in order.chunk_by(|&a, &b| key(a) == key(b)) {
        for &v in same {
            first[v as usize] = same[0];
        }
    }
    first
}

/// Joins all vertices that are exactly in one place. Triangles may become degenerate. Unused vertices are dropped.
pub(crate) fn join_equal(mesh: &mut TriMesh) {
    let first = first_in_place(mesh);
    for v in mesh.triangles.iter_mut().flatten() {
        *v = first[*v as usize];
    }
    super::drop_unused(mesh);
}

/// Joins vertices that are exactly in one place: ends of open edges that coincide, and corners of one triangle.
/// Returns their number.
///
/// Other vertices in one place touch without belonging together.
pub(super) fn duplicates(mesh: &mut TriMesh) -> usize {
    let first = first_in_place(mesh);
    if first.iter().zip(0_u32..).all(|(&first, v)| first == v) {
        return 0;
    }
    let mut sets = Sets::new(mesh.vertices.len());
    for &[a, b, c] in &mesh.triangles {
        for (a, b) in [(a, b), (b, c), (c, a)] {
            if first[a as usize] == first[b as usize] {
                sets.join(a, b);
            }
        }
    }
    // Open edges between the same two places.
    let mut open: Vec<([u32; 2], [u32; 2])> = open_sides(&sides(mesh))
        .iter()
        .map(|side| {
            let mut ends = [side.low, side.high];
            ends.sort_unstable_by_key(|&v| first[v as usize]);
            (ends.map(|v| first[v as usize]), ends)
        })
        .collect();
    open.sort_unstable();
    for pair in open.windows(2) {
        if pair[0].0 == pair[1].0 {
            sets.join(pair[0].1[0], pair[1].1[0]);
            sets.join(pair[0].1[1], pair[1].1[1]);
        }
    }
    apply(mesh, &mut sets)
}

/// Result of [`nearly`].
#[derive(Default)]
pub(super) struct Welded {
    pub vertices: usize,
    /// Largest distance over which a vertex moved, metres.
    pub largest: f64,
}

/// Welds the ends of open edges that nearly coincide: both ends within `tolerance` (metres).
///
/// The vertex with the lowest index keeps its place. Vertices that an edge connects are never welded, so no feature
/// of the mesh is lost.
pub(super) fn nearly(mesh: &mut TriMesh, tolerance: f64) -> Welded {
    let open = open_sides(&sides(mesh));
    if open.is_empty() {
        return Welded::default();
    }
    let mut sets = Sets::new(mesh.vertices.len());
    let close = |a: u32, b: u32| {
        (mesh.vertices[a as usize] - mesh.vertices[b as usize]).norm() <= tolerance
    };
    neighbours(mesh, &open, tolerance, |one, other| {
        let ([a, b], [c, d]) = (one.walked(), other.walked());
        // Neighbours that agree have opposite directions on their common edge.
        if close(a, d) && close(b, c) {
            sets.join(a, d);
            sets.join(b, c);
        } else if close(a, c) && close(b, d) {
            sets.join(a, c);
            sets.join(b, d);
        }
    });
    let mut whole = vec![true; mesh.vertices.len()];
    for &[a, b, c] in &mesh.triangles {
        for (a, b) in [(a, b), (b, c), (c, a)] {
            let set = sets.find(a);
            if a != b && set == sets.find(b) {
                whole[set as usize] = false;
            }
        }
    }
    let mut done = Welded::default();
    let mut moves = Vec::new();
    for v in 0..mesh.vertices.len() as u32 {
        let set = sets.find(v);
        if set == v {
            continue;
        }
        let distance = (mesh.vertices[v as usize] - mesh.vertices[set as usize]).norm();
        // Chains of nearly equal places must not lead far away.
        if distance > 2.0 * tolerance {
            whole[set as usize] = false;
        }
        moves.push((v, set, distance));
    }
    let mut target: Vec<u32> = (0..mesh.vertices.len() as u32).collect();
    for (v, set, distance) in moves {
        if whole[set as usize] {
            target[v as usize] = set;
            done.vertices += 1;
            done.largest = sulcus_core::math::fmax(done.largest, distance);
        }
    }
    for v in mesh.triangles.iter_mut().flatten() {
        *v = target[*v as usize];
    }
    done
}

/// Visits the pairs of open edges whose middles are within `tolerance` of each other, and some more pairs.
fn neighbours(mesh: &TriMesh, open: &[Side], tolerance: f64, mut visit: impl FnMut(Side, Side)) {
    let low = mesh.bounds().0;
    let place = |side: &Side| {
        let ends = [side.low, side.high].map(|v| mesh.vertices[v as usize] - low);
        (ends[0] + ends[1]) * 0.5
    };
    let cell = |x: f64| (x / (4.0 * tolerance)).floor() as i64;
    let mut grid: Vec<([i64; 3], usize)> = open
        .iter()
        .enumerate()
        .map(|(k, side)| (<[f64; 3]>::from(place(side)).map(cell), k))
        .collect();
    grid.sort_unstable();
    for (k, side) in open.iter().enumerate() {
        let middle = place(side);
        let range = |x: f64| cell(x - tolerance)..=cell(x + tolerance);
        for x in range(middle.x) {
            for y in range(middle.y) {
                for z in range(middle.z) {
                    let at = grid.partition_point(|entry| entry.0 < [x, y, z]);
                    let same = grid[at..].iter().take_while(|e| e.0 == [x, y, z]);
                    for &(_, other) in same.take(CANDIDATES) {
                        if other != k {
                            visit(*side, open[other]);
                        }
                    }
                }
            }
        }
    }
}

fn apply(mesh: &mut TriMesh, sets: &mut Sets) -> usize {
    let joined = (0..mesh.vertices.len() as u32)
        .filter(|&v| sets.find(v) != v)
        .count();
    for v in mesh.triangles.iter_mut().flatten() {
        *v = sets.find(*v);
    }
    joined
}
