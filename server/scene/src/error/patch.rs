//! Part of a mesh in a zone.

use sulcus_core::Vec3;
use sulcus_core::math::{fmax, norm};

use crate::mesh::TriMesh;
use crate::mesh::distance::MeshDistance;
use crate::tree::zone::Zone;

/// Size of the smallest triangles at the border of the zone, as a share of the mesh's size.
const FINEST: f64 = 1e-3;
/// Tolerance of equal distances, metres: far above rounding, far below relevance.
pub(super) const SAME: f64 = 1e-9;

/// Returns the part of the mesh in the zone, cut at the zone's border to a thousandth of the mesh's size.
///
/// Vertices are not shared, and the patch is not closed.
pub fn zone_patch(mesh: &TriMesh, zone: &Zone) -> TriMesh {
    let (low, high) = mesh.bounds();
    let finest = FINEST * norm(&(high - low));
    let mut patch = TriMesh::default();
    let mut open: Vec<[Vec3; 3]> = Vec::new();
    for t in 0..mesh.triangles.len() {
        open.push(mesh.corners(t));
        while let Some(corners) = open.pop() {
            let (centre, radius) = disc(&corners);
            let beyond = zone.beyond(&centre);
            if beyond > radius {
                continue;
            }
            if beyond > -radius && radius > finest {
                open.extend(quarters(&corners));
            } else if beyond <= 0.0 {
                let first = patch.vertices.len() as u32;
                patch.vertices.extend(corners);
                patch.triangles.push([first, first + 1, first + 2]);
            }
        }
    }
    patch
}

/// Returns the middle of a triangle, and the distance from it to the farthest corner.
pub(super) fn disc(corners: &[Vec3; 3]) -> (Vec3, f64) {
    let centre = (corners[0] + corners[1] + corners[2]) / 3.0;
    let radius = corners
        .iter()
        .fold(0.0, |radius, corner| fmax(radius, norm(&(corner - centre))));
    (centre, radius)
}

/// Returns a triangle as four.
pub(super) fn quarters([a, b, c]: &[Vec3; 3]) -> [[Vec3; 3]; 4] {
    let (ab, bc, ca) = ((a + b) * 0.5, (b + c) * 0.5, (c + a) * 0.5);
    [[*a, ab, ca], [ab, *b, bc], [ca, bc, *c], [bc, ca, ab]]
}

/// A zone and its patch, prepared for queries.
pub(super) struct Place<'a> {
    pub(super) zone: &'a Zone,
    patch: MeshDistance,
}

impl<'a> Place<'a> {
    pub(super) fn new(mesh: &TriMesh, zone: &'a Zone) -> Self {
        Self {
            zone,
            patch: MeshDistance::new(zone_patch(mesh, zone)),
        }
    }

    /// Returns the area, square metres.
    pub(super) fn area(&self) -> f64 {
        self.patch.mesh().area()
    }

    /// Returns the additional distance from `p` to the mesh in the zone, relative to the whole mesh at `distance`,
    /// metres.
    ///
    /// The value changes by no more than twice the distance moved.
    pub(super) fn detour(&self, p: &Vec3, distance: f64) -> f64 {
        self.patch.signed(p).abs() - distance
    }

    /// Returns whether the point of the mesh nearest to `p` is in the zone.
    pub(super) fn is_nearest(&self, p: &Vec3, distance: f64) -> bool {
        self.detour(p, distance) < SAME
    }
}
