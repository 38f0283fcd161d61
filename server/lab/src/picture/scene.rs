//! A scene as it looks at rest: all display meshes in one picture.

use sulcus_core::{DisplayMesh, Scene, Vec3};
use sulcus_scene::mesh::TriMesh;
use sulcus_scene::mesh::distance::MeshDistance;

use super::camera::{Camera, Side};
use super::image::Image;
use super::raster::draw_mesh;

/// Light in full shadow.
const SHADOW: f64 = 0.42;
/// Room round what is seen, metres.
const BORDER: f64 = 2e-3;

/// Display meshes of a scene's objects as one surface.
pub(crate) struct Still {
    distance: MeshDistance,
    /// Colour of each triangle.
    colours: Vec<[u8; 3]>,
    low: Vec3,
    high: Vec3,
}

impl Still {
    /// The objects whose names contain `only`, all of them if that is empty.
    pub(crate) fn of(scene: &Scene, only: &[String]) -> Option<Self> {
        let mut all = TriMesh::default();
        let mut colours = Vec::new();
        let shown = scene.objects.iter().filter(|object| {
            only.is_empty() || only.iter().any(|part| object.name.contains(part.as_str()))
        });
        for object in shown {
            append(&mut all, &mut colours, &object.mesh);
        }
        if all.triangles.is_empty() {
            return None;
        }
        let (low, high) = all.bounds();
        Some(Self {
            distance: MeshDistance::new(all),
            colours,
            low: low - Vec3::repeat(BORDER),
            high: high + Vec3::repeat(BORDER),
        })
    }

    /// The picture from a side, its longer edge `pixels` long.
    pub(crate) fn picture(&self, side: &Side, pixels: usize) -> Image {
        let wide = Camera::new(side, &self.low, &self.high, 1e-3);
        let longer = wide.width.max(wide.height).max(1);
        let pixel = 1e-3 * longer as f64 / pixels as f64;
        let camera = Camera::new(side, &self.low, &self.high, pixel);
        let drawn = draw_mesh(&camera, &self.distance);
        let of = |k: usize| self.colours[drawn.seen[k].of as usize];
        drawn.picture(SHADOW, of)
    }
}

fn append(all: &mut TriMesh, colours: &mut Vec<[u8; 3]>, mesh: &DisplayMesh) {
    let first = all.vertices.len() as u32;
    let vertices = mesh.vertices.iter();
    all.vertices
        .extend(vertices.map(|v| Vec3::from_fn(|axis, _| f64::from(v[axis]))));
    for triangle in &mesh.triangles {
        all.triangles.push(triangle.map(|v| v + first));
        // A band's border lies on vertices: a triangle is of the colour of most of its corners, which is the middle one.
        let mut corners: Vec<[u8; 4]> = triangle
            .iter()
            .filter_map(|v| mesh.vertex_colours.get(*v as usize).copied())
            .collect();
        corners.sort_unstable();
        let [r, g, b, _] = corners.get(1).copied().unwrap_or(mesh.colour);
        colours.push([r, g, b]);
    }
}
