//! Reflection in the glass of a mouth mirror: the camera of a second pass.
//!
//! The pass shows the world as the reflected eye sees it, cropped to the glass's window in the main picture. Its near
//! plane is the plane of the glass, so that nothing behind the glass shows (Lengyel, "Oblique view frustum depth
//! projection and clipping", 2005; depth from 0 to 1).

use nalgebra::Vector4;

use crate::camera::{Matrix, PassCamera, Plane, Vector};

/// Number of points of the rim from which the window is found.
const RIM: usize = 32;
/// Margin of the window, of the picture's half size: a pixel of the rim needs its neighbours.
const MARGIN: f64 = 0.01;

/// Glass in the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disc {
    /// Middle, mm.
    pub centre: Vector,
    /// Unit normal out of the reflecting side.
    pub normal: Vector,
    /// Radius, mm.
    pub radius: f64,
}

/// Rectangle of the main picture, -1 to 1 rightwards and upwards.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Window {
    /// Middle.
    pub middle: [f64; 2],
    /// Half the width and half the height.
    pub half: [f64; 2],
}

impl Window {
    /// Smallest window of whole pixels around this one. A texel of the reflection then is a pixel of the picture.
    fn outwards(&self, size: [u32; 2]) -> Self {
        let mut whole = *self;
        for (k, pixels) in size.into_iter().enumerate() {
            let pixels = 0.5 * f64::from(pixels);
            let low = ((self.middle[k] - self.half[k]) * pixels + pixels).floor() / pixels;
            let high = ((self.middle[k] + self.half[k]) * pixels + pixels).ceil() / pixels;
            whole.middle[k] = 0.5 * (low + high) - 1.0;
            whole.half[k] = 0.5 * (high - low);
        }
        whole
    }
}

/// Returns the pass of a reflection and its window in the main picture of `size` pixels. The window ends at borders of
/// pixels. `None`: the glass is seen from behind, edge on, or outside of the picture.
pub fn reflected(main: &PassCamera, disc: &Disc, size: [u32; 2]) -> Option<(PassCamera, Window)> {
    let plane = Plane::through(&disc.centre, &disc.normal);
    if plane.distance(&main.eye) <= 1e-6 * disc.radius {
        return None;
    }
    let window = window(main, disc)?.outwards(size);
    let reflection = plane.reflection();
    let view = main.view * reflection;
    let crop = Matrix::new(
        1.0 / window.half[0],
        0.0,
        0.0,
        -window.middle[0] / window.half[0], //
        0.0,
        1.0 / window.half[1],
        0.0,
        -window.middle[1] / window.half[1], //
        0.0,
        0.0,
        1.0,
        0.0, //
        0.0,
        0.0,
        0.0,
        1.0,
    );
    let projection = oblique(&(crop * main.projection), &view, &plane)?;
    let pass = PassCamera {
        view,
        projection,
        eye: reflection.transform_point(&main.eye.into()).coords,
        turns: !main.turns,
    };
    Some((pass, window))
}

/// Window of a disc in a picture, within the picture. `None`: outside, or partly behind the eye.
fn window(main: &PassCamera, disc: &Disc) -> Option<Window> {
    let aside = if disc.normal.x.abs() < 0.9 {
        Vector::x()
    } else {
        Vector::y()
    };
    let u = disc.normal.cross(&aside).normalize();
    let v = disc.normal.cross(&u);
    let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
    for k in 0..RIM {
        let (sine, cosine) = (k as f64 * std::f64::consts::TAU / RIM as f64).sin_cos();
        // The polygon's sides lie within the circle; its corners are moved out as far.
        let radius = disc.radius / (std::f64::consts::PI / RIM as f64).cos();
        let seen = main.seen(&(disc.centre + (u * cosine + v * sine) * radius))?;
        for (k, at) in [seen.x, seen.y].into_iter().enumerate() {
            low[k] = low[k].min(at);
            high[k] = high[k].max(at);
        }
    }
    let low = low.map(|at| (at - MARGIN).max(-1.0));
    let high = high.map(|at| (at + MARGIN).min(1.0));
    (low[0] < high[0] && low[1] < high[1]).then(|| Window {
        middle: [0, 1].map(|k| 0.5 * (low[k] + high[k])),
        half: [0, 1].map(|k| 0.5 * (high[k] - low[k])),
    })
}

/// Replaces the near plane of a projection by the plane of the glass.
fn oblique(projection: &Matrix, view: &Matrix, plane: &Plane) -> Option<Matrix> {
    let world = Vector4::new(plane.normal.x, plane.normal.y, plane.normal.z, plane.offset);
    let plane = view.try_inverse()?.transpose() * world;
    // A half mirror's projection turns the sides, so that the farthest corner lies at the other one.
    let side = |k: usize| sign(plane[k] * projection[(k, k)]);
    let corner = Vector4::new(side(0), side(1), 1.0, 1.0);
    let far = projection.try_inverse()? * corner;
    let last = projection.row(3).transpose();
    let scale = last.dot(&far) / plane.dot(&far);
    if !scale.is_finite() {
        return None;
    }
    let mut oblique = *projection;
    oblique.set_row(2, &(plane * scale).transpose());
    Some(oblique)
}

fn sign(x: f64) -> f64 {
    if x < 0.0 { -1.0 } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::Camera;

    const SIZE: [u32; 2] = [900, 600];

    fn main_camera() -> Camera {
        let (eye, target) = (Vector::new(400.0, 30.0, 200.0), Vector::new(0.0, 0.0, 0.0));
        Camera::looking(eye, target, Vector::z(), 16.0, 1.5)
    }

    fn main_pass() -> PassCamera {
        main_camera().pass()
    }

    fn disc() -> Disc {
        Disc {
            centre: Vector::new(5.0, -10.0, 4.0),
            normal: Vector::new(0.8, 0.5, 0.3).normalize(),
            radius: 10.6,
        }
    }

    /// Place of a point of the reflected pass in the main picture.
    fn in_main(window: &Window, at: &Vector) -> [f64; 2] {
        [0, 1].map(|k| window.middle[k] + window.half[k] * at[k])
    }

    #[test]
    fn a_point_is_seen_where_its_mirror_image_is() {
        let (main, disc) = (main_pass(), disc());
        let (pass, window) = reflected(&main, &disc, SIZE).expect("a reflection");
        let plane = Plane::through(&disc.centre, &disc.normal);
        for point in [[40.0, 3.0, 20.0], [25.0, 20.0, -12.0], [90.0, -30.0, 55.0]] {
            let point = Vector::from(point);
            assert!(plane.distance(&point) > 0.0);
            let image = plane.reflection().transform_point(&point.into()).coords;
            let (seen, expected) = (pass.seen(&point), main.seen(&image).expect("ahead"));
            let at = in_main(&window, &seen.expect("ahead"));
            assert!((at[0] - expected.x).abs() < 1e-9 && (at[1] - expected.y).abs() < 1e-9);
        }
    }

    #[test]
    fn points_of_the_glass_stay_and_have_depth_zero_and_points_behind_are_clipped() {
        let (main, disc) = (main_pass(), disc());
        let (pass, window) = reflected(&main, &disc, SIZE).expect("a reflection");
        let across = disc.normal.cross(&Vector::z()).normalize();
        for off in [-9.0, 0.0, 4.0, 10.0] {
            let point = disc.centre + across * off;
            let (seen, expected) = (
                pass.seen(&point).expect("ahead"),
                main.seen(&point).expect("ahead"),
            );
            let at = in_main(&window, &seen);
            assert!((at[0] - expected.x).abs() < 1e-9 && (at[1] - expected.y).abs() < 1e-9);
            assert!(seen.z.abs() < 1e-9, "{}", seen.z);
        }
        let behind = disc.centre - disc.normal * 5.0;
        assert!(pass.seen(&behind).expect("ahead").z < 0.0);
        let before = disc.centre + disc.normal * 60.0;
        assert!((0.0..1.0).contains(&pass.seen(&before).expect("ahead").z));
    }

    #[test]
    fn a_glass_from_behind_or_out_of_the_picture_has_no_pass() {
        let main = main_pass();
        let mut turned = disc();
        turned.normal = -turned.normal;
        assert_eq!(reflected(&main, &turned, SIZE), None);
        let mut away = disc();
        away.centre.y += 400.0;
        assert_eq!(reflected(&main, &away, SIZE), None);
    }

    #[test]
    fn no_corner_of_the_far_plane_is_cut_when_a_half_mirror_flips_the_picture() {
        for (mirrored, y) in [(false, 0.5), (true, 0.5), (false, -0.5), (true, -0.5)] {
            let mut camera = main_camera();
            camera.mirrored = mirrored;
            let (main, mut disc) = (camera.pass(), disc());
            disc.normal = Vector::new(0.8, y, 0.3).normalize();
            let (pass, _) = reflected(&main, &disc, SIZE).expect("a reflection");
            let last = pass.view.try_inverse().expect("a view");
            let depths = [[-1.0, -1.0], [1.0, -1.0], [-1.0, 1.0], [1.0, 1.0]].map(|[x, y]| {
                // The main pass ends 1500 mm before the eye.
                let [a, b] = [0, 1].map(|k| [x, y][k] + pass.projection[(k, 2)]);
                let at = [a / pass.projection[(0, 0)], b / pass.projection[(1, 1)]];
                let far = Vector4::new(at[0] * 1500.0, at[1] * 1500.0, -1500.0, 1.0);
                pass.seen(&(last * far).xyz()).expect("ahead").z
            });
            let deepest = depths.iter().fold(0.0f64, |most, depth| most.max(*depth));
            assert!((deepest - 1.0).abs() < 1e-9, "{depths:?}");
        }
    }

    #[test]
    fn a_window_ends_at_borders_of_pixels() {
        let (_, window) = reflected(&main_pass(), &disc(), SIZE).expect("a reflection");
        for (k, size) in SIZE.into_iter().enumerate() {
            let borders = [-1.0, 1.0].map(|side| window.middle[k] + side * window.half[k]);
            for border in borders {
                let pixels = 0.5 * (border + 1.0) * f64::from(size);
                assert!((pixels - pixels.round()).abs() < 1e-9, "{pixels}");
            }
        }
    }
}
