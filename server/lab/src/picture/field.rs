//! What lies on a drawn mesh, and where it ends.

use sulcus_core::Vec3;
use sulcus_scene::mesh::TriMesh;

use super::image::Image;
use super::raster::{FINER, Fragments};

impl Fragments {
    /// What a field on a mesh, drawn here, is at a fragment: between the `values` at the mesh's vertices.
    pub(crate) fn value(&self, k: usize, mesh: &TriMesh, values: &[f64]) -> f64 {
        let fragment = &self.seen[k];
        let l = within(&fragment.point, &mesh.corners(fragment.of as usize));
        let triangle = mesh.triangles[fragment.of as usize];
        (0..3).map(|c| l[c] * values[triangle[c] as usize]).sum()
    }

    /// Draws the outline of what is seen, two pixels wide, into a picture by the same camera.
    pub(crate) fn outline(&self, image: &mut Image, colour: [u8; 3]) {
        let (width, height) = (self.camera.width, self.camera.height);
        let mut covered = vec![false; width * height];
        for fragment in &self.seen {
            covered[fragment.pixel] = true;
        }
        for fragment in &self.seen {
            let (x, y) = (fragment.pixel % width, fragment.pixel / width);
            let beside = [
                (x.wrapping_sub(1), y),
                (x + 1, y),
                (x, y.wrapping_sub(1)),
                (x, y + 1),
            ];
            let out =
                |&(x, y): &(usize, usize)| x >= width || y >= height || !covered[y * width + x];
            if beside.iter().any(out) {
                image.fill((x / FINER, y / FINER), (2, 2), colour);
            }
        }
    }
}

/// Barycentric coordinates of a point of a triangle; the first corner's where the triangle has no area.
fn within(p: &Vec3, [a, b, c]: &[Vec3; 3]) -> [f64; 3] {
    let area = (b - a).cross(&(c - a));
    let twice = area.norm_squared();
    if twice == 0.0 {
        return [1.0, 0.0, 0.0];
    }
    let part = |x: &Vec3, y: &Vec3| ((x - p).cross(&(y - p)).dot(&area) / twice).clamp(0.0, 1.0);
    [part(b, c), part(c, a), part(a, b)]
}

#[cfg(test)]
mod tests {
    use sulcus_scene::mesh::distance::MeshDistance;
    use sulcus_scene::mesh::shapes::icosphere;

    use super::super::camera::{Camera, SIDES};
    use super::super::raster::draw_mesh;
    use super::*;

    #[test]
    fn fields_are_read_between_vertices_and_outlines_run_round_what_is_seen() {
        let distance = MeshDistance::new(icosphere(0.005, 4));
        let mesh = distance.mesh();
        let camera = Camera::new(&SIDES[0], &-Vec3::repeat(0.006), &Vec3::repeat(0.006), 1e-4);
        let seen = draw_mesh(&camera, &distance);
        // What is linear in place is read exactly.
        let along: Vec<f64> = mesh.vertices.iter().map(|v| 3.0 * v.y - v.z).collect();
        for (k, fragment) in seen.seen.iter().enumerate() {
            let wanted = 3.0 * fragment.point.y - fragment.point.z;
            assert!((seen.value(k, mesh, &along) - wanted).abs() < 1e-9);
        }
        let mut image = Image::white(camera.width, camera.height);
        seen.outline(&mut image, [0; 3]);
        let mut count = 0;
        for y in 0..image.height {
            for x in 0..image.width {
                let off = (x as f64 - 59.5).hypot(y as f64 - 59.5);
                if image.at(x, y) == [0; 3] {
                    assert!((off - 50.0).abs() < 2.5, "{off}");
                    count += 1;
                }
            }
        }
        assert!((400..1200).contains(&count), "{count}");
    }
}
