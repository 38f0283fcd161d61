//! Flat lid for the open base of a scan.

use std::collections::{BTreeMap, BTreeSet};

use serde::Serialize;
use sulcus_core::Vec3;

use super::holes::rims;
use crate::mesh::TriMesh;
use crate::mesh::edges::{Place, first_few, open_sides, openings, rounded, sides};
use crate::mesh::polygon::{Plane, triangulate_within};

/// Largest distance of the rim from its best plane, as a share of the diagonal of the rim's box. The margin of a
/// crown varies by less.
pub const BASE_FLAT_SHARE: f64 = 0.2;

/// A base that was closed on request.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ClosedBase {
    /// Corners of its rim.
    pub corners: usize,
    /// Area of the lid, square millimetres.
    pub area_mm2: f64,
    /// Largest distance of a corner from the best plane of the rim, mm.
    pub off_plane_mm: f64,
    /// Mean of the corners, mm, in the mesh's frame.
    pub at_mm: [f64; 3],
}

/// Closes the one opening of a mesh; returns `None` if nothing is open.
///
/// # Errors
/// The openings found, in a few words, if there is not exactly one nearly flat rim.
pub(super) fn close(mesh: &mut TriMesh) -> Result<Option<ClosedBase>, String> {
    let all = sides(mesh);
    let open = open_sides(&all);
    if open.is_empty() {
        return Ok(None);
    }
    let loops = rims(&open, mesh.vertices.len());
    let [rim] = &loops[..] else {
        let found = openings(mesh, &open);
        return Err(format!(
            "{} open edges in {} loops ({})",
            open.len(),
            loops.len(),
            first_few(&found)
        ));
    };
    if rim.len() != open.len() {
        return Err(format!(
            "{} open edges, of which only {} are a loop",
            open.len(),
            rim.len()
        ));
    }
    // The lid traverses the rim against the triangles around it.
    let corners: Vec<u32> = rim.iter().rev().map(|side| side.walked()[1]).collect();
    let points: Vec<Vec3> = corners.iter().map(|&v| mesh.vertices[v as usize]).collect();
    let plane = Plane::through(&points);
    let mut lid = Vec::with_capacity(corners.len());
    triangulate_within(&corners, &mesh.vertices, BASE_FLAT_SHARE, &mut lid)
        .map_err(|found| format!("as the rim {found}"))?;
    let ends = |a: u32, b: u32| (a.min(b), a.max(b));
    let around: BTreeSet<(u32, u32)> = (0..corners.len())
        .map(|k| ends(corners[k], corners[(k + 1) % corners.len()]))
        .collect();
    let known = |a: u32, b: u32| {
        let ends = ends(a, b);
        let walked = all.binary_search_by_key(&ends, |side| (side.low, side.high));
        walked.is_ok() && !around.contains(&ends)
    };
    let lid = parted(mesh, lid, &known);
    let area: f64 = lid
        .iter()
        .map(|t| {
            let [a, b, c] = t.map(|v| mesh.vertices[v as usize]);
            0.5 * (b - a).cross(&(c - a)).norm()
        })
        .sum();
    mesh.triangles.extend(lid);
    let mean = points.iter().sum::<Vec3>() / points.len() as f64;
    Ok(Some(ClosedBase {
        corners: corners.len(),
        area_mm2: rounded(1e6 * area),
        off_plane_mm: rounded(1e3 * plane.off),
        at_mm: (mean * 1e3).into(),
    }))
}

/// Splits inner edges of the lid that the mesh already has: an edge may have two triangles only.
fn parted(
    mesh: &mut TriMesh,
    lid: Vec<[u32; 3]>,
    known: &dyn Fn(u32, u32) -> bool,
) -> Vec<[u32; 3]> {
    let mut middles: BTreeMap<(u32, u32), u32> = BTreeMap::new();
    let mut parts = Vec::with_capacity(lid.len());
    let mut rest = lid;
    while let Some([a, b, c]) = rest.pop() {
        let turns = [[a, b, c], [b, c, a], [c, a, b]];
        let Some([a, b, c]) = turns.into_iter().find(|[a, b, _]| known(*a, *b)) else {
            parts.push([a, b, c]);
            continue;
        };
        let middle = *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
            let place = (mesh.vertices[a as usize] + mesh.vertices[b as usize]) * 0.5;
            mesh.vertices.push(place);
            mesh.vertices.len() as u32 - 1
        });
        rest.extend([[a, middle, c], [middle, b, c]]);
    }
    parts.sort_unstable();
    parts
}

impl std::fmt::Display for ClosedBase {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(
            f,
            "a rim of {} corners, {} mm2, at {} mm, at most {} mm off its plane",
            self.corners,
            self.area_mm2,
            Place(self.at_mm),
            self.off_plane_mm
        )
    }
}
