//! Small holes: their rims, and the closing of them.

use std::collections::BTreeSet;

use super::fill::{Rim, fill};
use super::{ClosedHole, LONGEST_RIM, MISSING_TRIANGLE_SHARE, SMALL_HOLE_SHARE};
use crate::mesh::TriMesh;
use crate::mesh::edges::{Opening, Side, open_sides, sides};

/// Closes the small holes of a mesh whose box has a diagonal of `size` (metres).
pub(super) fn close(mesh: &mut TriMesh, size: f64) -> Vec<ClosedHole> {
    let all = sides(mesh);
    let open = open_sides(&all);
    if open.is_empty() {
        return Vec::new();
    }
    let mut added: BTreeSet<(u32, u32)> = BTreeSet::new();
    let mut closed = Vec::new();
    for rim in rims(&open, mesh.vertices.len()) {
        if rim.len() > LONGEST_RIM {
            continue;
        }
        let vertices: Vec<u32> = rim.iter().map(|side| side.walked()[0]).collect();
        let hole = Opening::around(mesh, &vertices, rim.len());
        let share = if rim.len() == 3 {
            MISSING_TRIANGLE_SHARE
        } else {
            SMALL_HOLE_SHARE
        };
        if hole.diameter_mm * 1e-3 > share * size {
            continue;
        }
        let taken = |a: u32, b: u32| {
            let (low, high) = (a.min(b), a.max(b));
            added.contains(&(low, high))
                || all
                    .binary_search_by_key(&(low, high), |side| (side.low, side.high))
                    .is_ok()
        };
        let Some(patch) = fill(&Rim::new(mesh, &rim), &taken) else {
            continue;
        };
        for triangle in &patch {
            let [a, b, c] = *triangle;
            added.extend([(a, b), (b, c), (c, a)].map(|(a, b)| (a.min(b), a.max(b))));
        }
        mesh.triangles.extend(patch);
        closed.push(hole.into());
    }
    closed
}

/// Returns the rims as loops of open sides, each in the direction of its triangles.
///
/// A rim that meets itself in a vertex is parted there. A chain that does not return to its start is left out.
pub(super) fn rims(open: &[Side], vertices: usize) -> Vec<Vec<Side>> {
    let mut from: Vec<Side> = open.to_vec();
    from.sort_unstable_by_key(|side| (side.walked(), side.triangle));
    // The next side that leaves each vertex and belongs to no rim or chain yet.
    let mut next: Vec<usize> = vec![0; vertices];
    for (k, side) in from.iter().enumerate().rev() {
        next[side.walked()[0] as usize] = k;
    }
    let mut on_way = vec![u32::MAX; vertices];
    let mut rims = Vec::new();
    for start in 0..from.len() {
        let mut way: Vec<usize> = Vec::new();
        let mut at = from[start].walked()[0];
        while next[at as usize] <= start || !way.is_empty() {
            if on_way[at as usize] != u32::MAX {
                // The chain has reached one of its own vertices: a loop.
                let rim: Vec<Side> = way
                    .drain(on_way[at as usize] as usize..)
                    .map(|k| from[k])
                    .collect();
                for side in &rim {
                    on_way[side.walked()[0] as usize] = u32::MAX;
                }
                rims.push(rim);
                continue;
            }
            let side = next[at as usize];
            if from.get(side).is_none_or(|side| side.walked()[0] != at) {
                // A dead end: triangles disagree. The chain is dropped.
                for k in way.drain(..) {
                    on_way[from[k].walked()[0] as usize] = u32::MAX;
                }
                break;
            }
            next[at as usize] = side + 1;
            on_way[at as usize] = way.len() as u32;
            way.push(side);
            at = from[side].walked()[1];
        }
    }
    rims
}
