//! The drawn mouth mirror.

use sulcus_core::Vec3;

use super::grip::handle;
use super::turned::Turned;
use super::{DrawnTool, Steel};
use crate::instruments::Mirror;
use crate::instruments::mirror::{AROUND, BEND_MM, FOOT_MM};
use crate::mesh::TriMesh;

/// Width of the steel rim round the glass, mm: 0.5 to 0.8 in the trade. The round of the disc's edge belongs to it.
const RIM_MM: f64 = 0.6;
/// Number of ridges of each grip. The disc takes most of the triangles.
const RIDGES: usize = 15;
/// Distance between cross-sections of the display mesh, mm.
const STEP_MM: f64 = 1.0;

impl Mirror {
    /// Returns the instrument for a display. Disc, neck and the touching part of the shank have the surface of
    /// [`Mirror::display_mesh`].
    pub fn drawn(&self) -> DrawnTool {
        let line = self.line();
        let (outline, edge, glass) = self.drawn_outline();
        let (mut mesh, ring) = self.disc(&outline, &edge);
        let offsets = self.offsets(&mesh, &ring);
        let steel = finish(&mut mesh, outline.len());
        let mut turned = Turned::from_rim(&line, self.radius(), (mesh, steel), &ring);
        for (s, radius) in self.kept_rings() {
            let corners = self.neck_ring(&offsets, s, radius);
            turned.outline(s, corners, Steel::Polished);
        }
        let (from, to) = (self.bent() + 12.0, self.length_mm - self.radius());
        handle(&mut turned, from, to, self.thickness(from), RIDGES);
        let (mesh, steel) = without_unused(&turned.mesh, &turned.steel);
        DrawnTool {
            mesh: mesh.placed(1e-3, Vec3::zeros()),
            steel,
            glass_radius: Some(glass * 1e-3),
        }
    }

    /// Returns the disc's outline without rings that lie in a flat face, the part of it that is the round edge, and
    /// the radius of the glass, mm.
    fn drawn_outline(&self) -> (Vec<[f64; 2]>, std::ops::RangeInclusive<usize>, f64) {
        let (whole, edge) = self.outline();
        let half = 0.5 * self.disc_thickness_mm;
        let flat = self.radius() - self.edge_radius_mm;
        let glass = (self.radius() - RIM_MM).min(flat);
        let mut outline = Vec::new();
        if glass < flat {
            outline.push([glass, half]);
        }
        let first = outline.len();
        outline.extend(&whole[edge]);
        let last = outline.len() - 1;
        (outline, first..=last, glass)
    }

    /// Returns the cross-sections of the neck that its surface needs. Between others the neck is a straight cone.
    fn kept_rings(&self) -> Vec<(f64, f64)> {
        let all = self.neck_rings(self.length_mm - self.radius(), STEP_MM);
        let (foot, bent) = (self.radius() + FOOT_MM, self.bent());
        let bend = bent - BEND_MM * self.disc_deg.to_radians();
        let touching = self.touching_mm - self.radius();
        let is_needed = |s: f64| {
            let ends = [s - STEP_MM, s + STEP_MM];
            ends[0] < foot || (ends[1] > bend && ends[0] < bent)
        };
        let last = all.iter().position(|(s, _)| *s >= touching);
        let last = last.unwrap_or(all.len() - 1);
        let kept = all.iter().take(last + 1).enumerate();
        kept.filter(|(k, (s, _))| is_needed(*s) || *k == last)
            .map(|(_, ring)| *ring)
            .collect()
    }
}

/// Returns the finishes of a disc whose outline has `rows` rows. The middles of both faces get rings of their own at
/// their borders, so that the faces are flat up to the rim.
fn finish(mesh: &mut TriMesh, rows: usize) -> Vec<Steel> {
    let bottom = mesh.vertices.len() - 1;
    let mut steel = vec![Steel::Rim; mesh.vertices.len()];
    steel[0] = Steel::Satin;
    // The rim ends where the back begins.
    steel[1 + (rows - 2) * AROUND..=bottom].fill(Steel::Satin);
    for (middle, row) in [(0, 0), (bottom, rows - 1)] {
        let first = mesh.vertices.len();
        let ring = 1 + row * AROUND..1 + (row + 1) * AROUND;
        for v in ring.clone() {
            let copy = mesh.vertices[v];
            mesh.vertices.push(copy);
            steel.push(Steel::Satin);
        }
        for triangle in &mut mesh.triangles {
            if triangle.contains(&(middle as u32)) {
                *triangle = triangle.map(|v| {
                    let v = v as usize;
                    let v = if ring.contains(&v) {
                        first + v - ring.start
                    } else {
                        v
                    };
                    v as u32
                });
            }
        }
    }
    steel
}

/// Drops vertices that no triangle has, with their finishes.
fn without_unused(mesh: &TriMesh, steel: &[Steel]) -> (TriMesh, Vec<Steel>) {
    let mut number = vec![u32::MAX; mesh.vertices.len()];
    let (mut kept, mut finishes) = (TriMesh::default(), Vec::new());
    for triangle in &mesh.triangles {
        kept.triangles.push(triangle.map(|v| {
            let old = v as usize;
            if number[old] == u32::MAX {
                number[old] = kept.vertices.len() as u32;
                kept.vertices.push(mesh.vertices[old]);
                finishes.push(steel[old]);
            }
            number[old]
        }));
    }
    (kept, finishes)
}
