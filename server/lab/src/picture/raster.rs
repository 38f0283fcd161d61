//! A z-buffer: which point of a surface each pixel shows.

use sulcus_core::Vec3;
use sulcus_core::math::{fmax, fmin};
use sulcus_scene::mesh::distance::MeshDistance;

use super::camera::{Camera, pixels};
use super::image::Image;

/// Pixels of a picture are 2 x 2 of these, so that edges are smooth.
pub(crate) const FINER: usize = 2;

/// Corner normals that turn farther from the face's than this belong to a sharp edge.
const SHARP_COS: f64 = 0.8;

/// What a pixel shows.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Fragment {
    /// Row by row.
    pub(crate) pixel: usize,
    /// Point of the surface, metres.
    pub(crate) point: Vec3,
    /// Its unit normal.
    pub(crate) normal: Vec3,
    /// Number of the triangle.
    pub(crate) of: u32,
}

/// All that a picture shows, [`FINER`] times finer than the picture.
pub(crate) struct Fragments {
    pub(super) camera: Camera,
    /// Pixels that show something.
    pub(crate) seen: Vec<Fragment>,
}

/// The camera whose pixels are those of fragments.
fn finer(camera: &Camera) -> Camera {
    Camera {
        pixel: camera.pixel / FINER as f64,
        width: camera.width * FINER,
        height: camera.height * FINER,
        ..camera.clone()
    }
}

struct Buffer {
    camera: Camera,
    nearest: Vec<(f64, Option<Fragment>)>,
}

impl Buffer {
    fn new(camera: &Camera) -> Self {
        let camera = finer(camera);
        Self {
            nearest: vec![(f64::NEG_INFINITY, None); camera.width * camera.height],
            camera,
        }
    }

    /// `fragment` is only asked for when it is in front of what is there.
    fn put(&mut self, x: usize, y: usize, depth: f64, fragment: impl FnOnce() -> (Vec3, u32)) {
        let pixel = y * self.camera.width + x;
        if depth > self.nearest[pixel].0 {
            let (normal, of) = fragment();
            let point = self.camera.unproject(x as f64 + 0.5, y as f64 + 0.5, depth);
            let fragment = Fragment {
                pixel,
                point,
                normal,
                of,
            };
            self.nearest[pixel] = (depth, Some(fragment));
        }
    }

    fn done(self) -> Fragments {
        Fragments {
            camera: self.camera,
            seen: self
                .nearest
                .into_iter()
                .filter_map(|pixel| pixel.1)
                .collect(),
        }
    }
}

/// Draws a mesh.
pub(crate) fn draw_mesh(camera: &Camera, distance: &MeshDistance) -> Fragments {
    let mut buffer = Buffer::new(camera);
    let (width, height) = (buffer.camera.width, buffer.camera.height);
    let mesh = distance.mesh();
    for (t, triangle) in mesh.triangles.iter().enumerate() {
        let face = distance.face_normal(t as u32);
        if face.dot(&camera.towards) <= 0.0 {
            continue;
        }
        let normals = triangle.map(|v| {
            let smooth = distance.vertex_normal(v);
            if smooth.dot(&face) > SHARP_COS {
                smooth
            } else {
                face
            }
        });
        let c = mesh.corners(t).map(|corner| buffer.camera.project(&corner));
        let twice = cross(&c[0], &c[1], &c[2]);
        let range = |axis: usize, count: usize| {
            let (a, b, c) = (c[0][axis], c[1][axis], c[2][axis]);
            // A little more than the triangle, so that neighbours leave no gap between them.
            pixels(
                fmin(a, fmin(b, c)) - 1e-6,
                fmax(a, fmax(b, c)) + 1e-6,
                count,
            )
        };
        for y in range(1, height) {
            for x in range(0, width) {
                let p = Vec3::new(x as f64 + 0.5, y as f64 + 0.5, 0.0);
                let weights = [
                    cross(&c[1], &c[2], &p) / twice,
                    cross(&c[2], &c[0], &p) / twice,
                    cross(&c[0], &c[1], &p) / twice,
                ];
                if weights.iter().all(|w| *w >= -1e-9) {
                    let mix = |of: &dyn Fn(usize) -> f64| (0..3).map(|k| weights[k] * of(k)).sum();
                    let depth: f64 = mix(&|k| c[k].z);
                    buffer.put(x, y, depth, || {
                        let normal = Vec3::from_fn(|axis, _| mix(&|k| normals[k][axis]));
                        (normal.normalize(), t as u32)
                    });
                }
            }
        }
    }
    buffer.done()
}

fn cross(a: &Vec3, b: &Vec3, c: &Vec3) -> f64 {
    (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x)
}

impl Fragments {
    /// The picture, on white: `colour` gives each fragment's (number in `seen`), `least` in 0 to 1 is the
    /// light in full shadow.
    pub(crate) fn picture(&self, least: f64, colour: impl Fn(usize) -> [u8; 3]) -> Image {
        let camera = &self.camera;
        let light = (camera.towards + camera.up * 0.5 - camera.right * 0.35).normalize();
        let mut fine = vec![[255_u8; 3]; camera.width * camera.height];
        for (k, fragment) in self.seen.iter().enumerate() {
            let lit = least + (1.0 - least) * fmax(fragment.normal.dot(&light), 0.0);
            fine[fragment.pixel] = colour(k).map(|c| (f64::from(c) * lit).round() as u8);
        }
        let mut image = Image::white(camera.width / FINER, camera.height / FINER);
        for y in 0..image.height {
            for x in 0..image.width {
                let mut sum = [0_u32; 3];
                for k in 0..FINER * FINER {
                    let (fx, fy) = (x * FINER + k % FINER, y * FINER + k / FINER);
                    let pixel = fine[fy * camera.width + fx];
                    for (sum, c) in sum.iter_mut().zip(pixel) {
                        *sum += u32::from(c);
                    }
                }
                image.set(x, y, sum.map(|c| (c / (FINER * FINER) as u32) as u8));
            }
        }
        image
    }
}

#[cfg(test)]
mod tests {
    use sulcus_scene::mesh::shapes::icosphere;

    use super::super::camera::SIDES;
    use super::*;

    #[test]
    fn a_ball_is_drawn_as_a_disc_of_points_that_face_the_eye() {
        let (radius, corner) = (0.005, Vec3::repeat(0.006));
        let distance = MeshDistance::new(icosphere(radius, 5));
        for side in &SIDES {
            let camera = Camera::new(side, &-corner, &corner, 0.0001);
            let drawn = draw_mesh(&camera, &distance);
            let disc = std::f64::consts::PI * (radius / camera.pixel * FINER as f64).powi(2);
            assert!((drawn.seen.len() as f64 / disc - 1.0).abs() < 0.01);
            for fragment in &drawn.seen {
                // On the ball, on the side of the eye, normal outward.
                assert!((fragment.point.norm() - radius).abs() < 1e-5);
                assert!(fragment.point.dot(&camera.towards) > -1e-5);
                assert!((fragment.normal - fragment.point / radius).norm() < 0.03);
            }
            let picture = drawn.picture(0.5, |_| [200, 100, 0]);
            assert_eq!((picture.width, picture.height), (120, 120));
            assert_eq!(picture.at(0, 0), [255; 3]);
            // The normal in the middle is the direction to the eye.
            let lit = 0.5 + 0.5 / f64::hypot(1.0, f64::hypot(0.5, 0.35));
            let wanted = [200.0, 100.0, 0.0].map(|c: f64| (c * lit).round() as u8);
            for (found, wanted) in picture.at(60, 60).iter().zip(wanted) {
                assert!(found.abs_diff(wanted) <= 2, "{found} {wanted}");
            }
        }
    }

    #[test]
    fn what_is_nearer_to_the_eye_hides_the_rest() {
        let corner = Vec3::new(0.012, 0.006, 0.006);
        let camera = Camera::new(&SIDES[0], &-corner, &corner, 0.0001);
        for (first, second) in [(0.005, -0.005), (-0.005, 0.005)] {
            let ball = |x: f64| icosphere(0.005, 4).placed(1.0, Vec3::new(x, 0.0, 0.0));
            let mut both = ball(first);
            let (vertices, triangles) = (both.vertices.len() as u32, both.triangles.len());
            let other = ball(second);
            let moved = |triangle: &[u32; 3]| triangle.map(|v| v + vertices);
            both.triangles.extend(other.triangles.iter().map(moved));
            both.vertices.extend(other.vertices);
            let seen = draw_mesh(&camera, &MeshDistance::new(both)).seen;
            let in_front = |of: u32| ((of as usize) < triangles) == (first > second);
            assert!(!seen.is_empty() && seen.iter().all(|f| in_front(f.of)));
        }
    }
}
