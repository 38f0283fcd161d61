//! The largest of several pieces. Scanners leave small pieces beside the scanned object.

use serde::Serialize;
use sulcus_core::Vec3;
use sulcus_core::math::fmax;

use crate::mesh::TriMesh;
use crate::mesh::edges::{Sets, by_edge, diameter, sides};

/// Relative tolerance of equal areas. Of equal pieces the first in the file is kept.
const EQUAL: f64 = 1e-5;

/// Pieces that were dropped on request.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DroppedPieces {
    /// Pieces dropped.
    pub pieces: usize,
    /// Their triangles.
    pub triangles: usize,
    /// Largest distance across one of them, mm. With more than a few hundred corners it is the diagonal of its box.
    pub largest_mm: f64,
    /// Triangles of the piece that was kept.
    pub kept_triangles: usize,
    /// Area of the piece that was kept, square millimetres.
    pub kept_area_mm2: f64,
}

/// Keeps the piece with the largest area.
///
/// A piece is connected by edges. A part that touches it in a vertex only is another piece.
pub(super) fn keep_largest(mesh: &mut TriMesh) -> Option<DroppedPieces> {
    let mut sets = Sets::new(mesh.triangles.len());
    for edge in by_edge(&sides(mesh)) {
        for side in &edge[1..] {
            sets.join(edge[0].triangle, side.triangle);
        }
    }
    let count = mesh.triangles.len() as u32;
    let piece: Vec<u32> = (0..count).map(|t| sets.find(t)).collect();
    let mut areas = vec![0.0; mesh.triangles.len()];
    for (t, &own) in piece.iter().enumerate() {
        areas[own as usize] += 0.5 * mesh.area_vector(t).norm();
    }
    let most = areas.iter().copied().fold(0.0, fmax);
    let kept = areas
        .iter()
        .position(|&area| area >= (1.0 - EQUAL) * most)? as u32;
    // Corners of the other pieces.
    let mut others: Vec<(u32, u32)> = Vec::new();
    let mut triangles = 0;
    for (&own, corners) in piece.iter().zip(&mesh.triangles) {
        if own != kept {
            triangles += 1;
            others.extend(corners.map(|corner| (own, corner)));
        }
    }
    if others.is_empty() {
        return None;
    }
    others.sort_unstable();
    others.dedup();
    let (mut pieces, mut largest) = (0, 0.0);
    for one in others.chunk_by(|a, b| a.0 == b.0) {
        let points: Vec<Vec3> = one
            .iter()
            .map(|&(_, v)| mesh.vertices[v as usize])
            .collect();
        pieces += 1;
        largest = fmax(largest, diameter(&points));
    }
    let mut owners = piece.iter();
    mesh.triangles.retain(|_| owners.next() == Some(&kept));
    super::drop_unused(mesh);
    Some(DroppedPieces {
        pieces,
        triangles,
        largest_mm: 1e3 * largest,
        kept_triangles: mesh.triangles.len(),
        kept_area_mm2: 1e6 * mesh.area(),
    })
}
