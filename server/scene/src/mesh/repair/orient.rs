//! Consistent orientation of triangles.

use crate::mesh::TriMesh;
use crate::mesh::edges::{Sets, by_edge, sides};

/// Turns triangles until neighbours agree. Returns the triangles turned.
///
/// In a connected surface the majority stays; at equal numbers, the side of the first triangle. A surface that cannot
/// be oriented is left unchanged.
pub(super) fn agree(mesh: &mut TriMesh) -> Vec<u32> {
    // Up to three neighbours across edges with two triangles, and whether they differ.
    let mut neighbours = vec![[(u32::MAX, false); 3]; mesh.triangles.len()];
    let mut all_agree = true;
    let sides = sides(mesh);
    for edge in by_edge(&sides) {
        let [one, other] = edge else { continue };
        let differ = one.forward == other.forward;
        all_agree &= !differ;
        for (from, to) in [(one, other), (other, one)] {
            if let Some(free) = neighbours[from.triangle as usize]
                .iter_mut()
                .find(|neighbour| neighbour.0 == u32::MAX)
            {
                *free = (to.triangle, differ);
            }
        }
    }
    if all_agree {
        return Vec::new();
    }
    let mut turn: Vec<Option<bool>> = vec![None; mesh.triangles.len()];
    let mut turned = Vec::new();
    for start in 0..mesh.triangles.len() as u32 {
        if turn[start as usize].is_some() {
            continue;
        }
        turn[start as usize] = Some(false);
        let mut surface = vec![start];
        let mut at = 0;
        let mut orientable = true;
        while let Some(&triangle) = surface.get(at) {
            at += 1;
            let own = turn[triangle as usize] == Some(true);
            for &(other, differ) in &neighbours[triangle as usize] {
                if other == u32::MAX {
                    continue;
                }
                match turn[other as usize] {
                    None => {
                        turn[other as usize] = Some(own != differ);
                        surface.push(other);
                    }
                    Some(known) => orientable &= known == (own != differ),
                }
            }
        }
        let against = surface
            .iter()
            .filter(|&&t| turn[t as usize] == Some(true))
            .count();
        let minority = 2 * against <= surface.len();
        if orientable {
            turned.extend(
                surface
                    .iter()
                    .filter(|&&t| turn[t as usize] == Some(minority)),
            );
        }
    }
    turned.sort_unstable();
    for &triangle in &turned {
        mesh.triangles[triangle as usize].swap(1, 2);
    }
    turned
}

/// Turns a closed surface of one piece outward if its volume is negative. Returns whether it was turned.
pub(super) fn outward(mesh: &mut TriMesh) -> bool {
    if mesh.signed_volume() >= 0.0 || !super::closed(mesh) {
        return false;
    }
    let mut sets = Sets::new(mesh.vertices.len());
    for &[a, b, c] in &mesh.triangles {
        sets.join(a, b);
        sets.join(a, c);
    }
    let first = mesh.triangles[0][0];
    let piece = sets.find(first);
    if mesh
        .triangles
        .iter()
        .any(|triangle| sets.find(triangle[0]) != piece)
    {
        return false;
    }
    for triangle in &mut mesh.triangles {
        triangle.swap(1, 2);
    }
    true
}
