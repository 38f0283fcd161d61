//! Glass of a mouth mirror, found on the mirror's mesh.

use sulcus_core::{DisplayMesh, Tool, Vec3};
use sulcus_proto::display::DisplayGlass;

use crate::display::f32s;

/// Smallest area of a flat face that is a glass, square metres: a disc of 12 mm.
const LEAST_M2: f64 = 1.1e-4;
/// Largest angle between normals of one flat face, as a cosine.
const SAME: f64 = 0.9999;

/// Returns the largest flat face of a tool that faces the handle. `None` for a probe, and for a tool without such a
/// face.
///
/// A mirror's handle lies on the reflecting side: the operator looks along it. The compiled tool has no other sign of
/// its reflecting side.
pub fn glass(tool: &Tool) -> Option<DisplayGlass> {
    if !tool.bands.is_empty() {
        return None;
    }
    let mut best: Option<Face> = None;
    // A face of the flat disc is a fan or strips of large triangles, so that few directions are candidates.
    for candidate in directions(&tool.mesh) {
        // The origin of the frame is the device point on the handle.
        let face = Face::towards(&tool.mesh, candidate);
        let faces_handle = candidate.dot(&-face.middle) > 0.0;
        let is_larger = best.as_ref().is_none_or(|best| face.area > best.area);
        if faces_handle && face.area > LEAST_M2 && is_larger {
            best = Some(face);
        }
    }
    best.map(|face| DisplayGlass {
        centre: f32s(&face.middle),
        normal: f32s(&face.normal),
        radius: (face.area / std::f64::consts::PI).sqrt() as f32,
    })
}

/// Flat part of a mesh.
struct Face {
    normal: Vec3,
    /// Centre of the area, metres.
    middle: Vec3,
    /// Area, square metres.
    area: f64,
}

impl Face {
    fn towards(mesh: &DisplayMesh, normal: Vec3) -> Self {
        let (mut area, mut sum) = (0.0, Vec3::zeros());
        for triangle in &mesh.triangles {
            let (middle, vector) = middle_and_area(mesh, triangle);
            let size = vector.norm();
            if vector.dot(&normal) > SAME * size {
                area += size;
                sum += middle * size;
            }
        }
        Self {
            normal,
            middle: sum / area.max(f64::MIN_POSITIVE),
            area,
        }
    }
}

/// Unit normals of the triangles with at least a thousandth of the smallest glass, each once.
fn directions(mesh: &DisplayMesh) -> Vec<Vec3> {
    let mut found: Vec<Vec3> = Vec::new();
    for triangle in &mesh.triangles {
        let (_, vector) = middle_and_area(mesh, triangle);
        let size = vector.norm();
        if size < 1e-3 * LEAST_M2 {
            continue;
        }
        let normal = vector / size;
        if found.iter().all(|one| one.dot(&normal) < SAME) {
            found.push(normal);
        }
    }
    found
}

/// Centre of a triangle, and its normal with the length of its area.
fn middle_and_area(mesh: &DisplayMesh, triangle: &[u32; 3]) -> (Vec3, Vec3) {
    let [a, b, c] = triangle.map(|v| Vec3::from(mesh.vertices[v as usize].map(f64::from)));
    ((a + b + c) / 3.0, (b - a).cross(&(c - a)) * 0.5)
}
