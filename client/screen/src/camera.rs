//! Cameras: an eye behind a glass in the world, and its passes.
//!
//! Unit: millimetres, world axes. The glass is the screen's own rectangle. The eye may stand anywhere in front of it, so
//! a half-mirror station, head tracking and stereo are data. A plain view has an assumed eye in front of the middle.
//! Source: Kooima, "Generalized perspective projection", 2008.

use nalgebra::{Matrix4, Vector3, Vector4};

/// Vector in millimetres.
pub type Vector = Vector3<f64>;
/// Matrix of homogeneous coordinates. Depth runs from 0 at the near plane to 1 at the far plane.
pub type Matrix = Matrix4<f64>;

/// Nearest and farthest distance that a picture shows, mm.
const RANGE_MM: [f64; 2] = [20.0, 1500.0];

/// Plane `normal . x + offset = 0`, with a unit normal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plane {
    /// Unit normal, towards the side that is kept.
    pub normal: Vector,
    /// Offset, mm.
    pub offset: f64,
}

impl Plane {
    /// Plane through a point.
    pub fn through(point: &Vector, normal: &Vector) -> Self {
        let normal = normal.normalize();
        Self {
            normal,
            offset: -normal.dot(point),
        }
    }

    /// Signed distance of a point, mm.
    pub fn distance(&self, point: &Vector) -> f64 {
        self.normal.dot(point) + self.offset
    }

    /// Reflection at the plane.
    pub fn reflection(&self) -> Matrix {
        let n = self.normal;
        let turned = nalgebra::Matrix3::identity() - n * n.transpose() * 2.0;
        let mut whole = Matrix::identity();
        whole.fixed_view_mut::<3, 3>(0, 0).copy_from(&turned);
        whole
            .fixed_view_mut::<3, 1>(0, 3)
            .copy_from(&(n * (-2.0 * self.offset)));
        whole
    }
}

/// Camera of a view.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Lower left, lower right and upper left corner of the glass.
    screen: [Vector; 3],
    eye: Vector,
    /// Whether the output is flipped left to right, for a screen that is seen in a half mirror.
    pub mirrored: bool,
}

impl Camera {
    /// Camera of an eye behind a glass, given by its lower left, lower right and upper left corner.
    pub fn through(screen: [Vector; 3], eye: Vector) -> Self {
        Self {
            screen,
            eye,
            mirrored: false,
        }
    }

    /// Camera of an eye that looks at `target`. The picture is `height_deg` high and `aspect` times as wide. The glass
    /// lies through the target.
    pub fn looking(eye: Vector, target: Vector, up: Vector, height_deg: f64, aspect: f64) -> Self {
        let ahead = (target - eye).normalize();
        let right = ahead.cross(&up).normalize();
        let above = right.cross(&ahead);
        let half = (target - eye).norm() * (0.5 * height_deg.to_radians()).tan();
        let corner = |x: f64, y: f64| target + right * (x * half * aspect) + above * (y * half);
        Self::through(
            [corner(-1.0, -1.0), corner(1.0, -1.0), corner(-1.0, 1.0)],
            eye,
        )
    }

    /// Eye.
    pub fn eye(&self) -> Vector {
        self.eye
    }

    /// Middle of the glass.
    pub fn middle(&self) -> Vector {
        (self.screen[1] + self.screen[2]) * 0.5
    }

    /// Unit vectors of the picture: to the right, upwards, and towards the eye. A flipped output has a flipped right.
    pub fn axes(&self) -> [Vector; 3] {
        let [low, right_end, high] = self.screen;
        let right = (right_end - low).normalize();
        let up = (high - low).normalize();
        let flip = if self.mirrored { -1.0 } else { 1.0 };
        [right * flip, up, right.cross(&up)]
    }

    /// Half the diagonal of the glass, mm.
    pub fn half_diagonal(&self) -> f64 {
        (self.screen[1] - self.screen[2]).norm() * 0.5
    }

    /// The same camera turned about the middle of its glass: `turn` radians to the right, `tilt` radians upwards, with
    /// the distance of the eye and the size of the glass times `zoom`.
    pub fn orbited(&self, turn: f64, tilt: f64, zoom: f64) -> Self {
        let middle = self.middle();
        let right = (self.screen[1] - self.screen[0]).normalize();
        let about_up = nalgebra::Rotation3::from_axis_angle(&Vector::z_axis(), turn);
        let sideways = nalgebra::Unit::new_normalize(about_up * right);
        let about_right = nalgebra::Rotation3::from_axis_angle(&sideways, tilt);
        let place = |at: &Vector| middle + about_right * (about_up * (at - middle)) * zoom;
        Self {
            screen: self.screen.map(|at| place(&at)),
            eye: place(&self.eye),
            mirrored: self.mirrored,
        }
    }

    /// The same camera rotated about a place.
    pub fn rotated(&self, by: &nalgebra::Rotation3<f64>, about: &Vector) -> Self {
        let place = |at: &Vector| about + by * (at - about);
        Self {
            screen: self.screen.map(|at| place(&at)),
            eye: place(&self.eye),
            mirrored: self.mirrored,
        }
    }

    /// The same camera with a smaller glass about the same middle: the picture is magnified without a wider angle.
    pub fn magnified(&self, factor: f64) -> Self {
        let middle = self.middle();
        Self {
            screen: self.screen.map(|at| middle + (at - middle) / factor),
            ..*self
        }
    }

    /// The same camera moved by a vector.
    pub fn moved(&self, by: &Vector) -> Self {
        Self {
            screen: self.screen.map(|at| at + by),
            eye: self.eye + by,
            mirrored: self.mirrored,
        }
    }

    /// Pass of the camera.
    pub fn pass(&self) -> PassCamera {
        let [low, right_end, high] = self.screen;
        let right = (right_end - low).normalize();
        let up = (high - low).normalize();
        let back = right.cross(&up).normalize();
        let [near, far] = RANGE_MM;
        let from_eye = |at: &Vector| at - self.eye;
        let distance = -back.dot(&from_eye(&low));
        let scale = near / distance;
        let x = [low, right_end].map(|at| right.dot(&from_eye(&at)) * scale);
        let y = [low, high].map(|at| up.dot(&from_eye(&at)) * scale);
        let (dx, dy) = (x[1] - x[0], y[1] - y[0]);
        let projection = Matrix::new(
            2.0 * near / dx,
            0.0,
            (x[1] + x[0]) / dx,
            0.0, //
            0.0,
            2.0 * near / dy,
            (y[1] + y[0]) / dy,
            0.0, //
            0.0,
            0.0,
            far / (near - far),
            near * far / (near - far), //
            0.0,
            0.0,
            -1.0,
            0.0,
        );
        let row = |axis: &Vector| [axis.x, axis.y, axis.z, -axis.dot(&self.eye)];
        let [r, u, b] = [row(&right), row(&up), row(&back)];
        let view = Matrix::new(
            r[0], r[1], r[2], r[3], u[0], u[1], u[2], u[3], b[0], b[1], b[2], b[3], 0.0, 0.0, 0.0,
            1.0,
        );
        let flip = if self.mirrored { -1.0 } else { 1.0 };
        PassCamera {
            view,
            projection: Matrix::new_nonuniform_scaling(&Vector::new(flip, 1.0, 1.0)) * projection,
            eye: self.eye,
            turns: self.mirrored,
        }
    }
}

/// Camera of one pass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PassCamera {
    /// Eye from world.
    pub view: Matrix,
    /// Clip space from eye.
    pub projection: Matrix,
    /// Eye of the highlights, world axes.
    pub eye: Vector,
    /// Whether the winding of triangles turns.
    pub turns: bool,
}

impl PassCamera {
    /// Clip space from world.
    pub fn matrix(&self) -> Matrix {
        self.projection * self.view
    }

    /// Place in the picture, -1 to 1 rightwards and upwards, and depth; `None` behind the eye.
    pub fn seen(&self, point: &Vector) -> Option<Vector> {
        let clip = self.matrix() * point.push(1.0);
        (clip.w > 0.0).then(|| clip.xyz() / clip.w)
    }

    /// Ray of a place in the picture: its start on the near plane, and its unit direction.
    pub fn ray(&self, x: f64, y: f64) -> Option<(Vector, Vector)> {
        let back = self.matrix().try_inverse()?;
        let at = |depth: f64| {
            let point = back * Vector4::new(x, y, depth, 1.0);
            point.xyz() / point.w
        };
        let (near, far) = (at(0.0), at(1.0));
        Some((near, (far - near).normalize()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn camera() -> Camera {
        let (eye, target) = (
            Vector::new(300.0, 120.0, 350.0),
            Vector::new(10.0, 5.0, -3.0),
        );
        Camera::looking(eye, target, Vector::z(), 16.0, 1.6)
    }

    #[test]
    fn the_middle_and_the_corners_of_the_glass_are_those_of_the_picture() {
        let camera = camera();
        let pass = camera.pass();
        let close = |a: Vector, b: [f64; 2]| (a.x - b[0]).abs() < 1e-9 && (a.y - b[1]).abs() < 1e-9;
        assert!(close(
            pass.seen(&camera.middle()).expect("ahead"),
            [0.0, 0.0]
        ));
        for (corner, at) in camera
            .screen
            .iter()
            .zip([[-1.0, -1.0], [1.0, -1.0], [-1.0, 1.0]])
        {
            assert!(close(pass.seen(corner).expect("ahead"), at));
        }
        let behind = camera.eye + (camera.eye - camera.middle());
        assert_eq!(pass.seen(&behind), None);
    }

    #[test]
    fn an_eye_aside_of_the_glass_keeps_the_glass_as_the_picture() {
        let glass =
            [[-100.0, 0.0], [100.0, 0.0], [-100.0, 120.0]].map(|[y, z]| Vector::new(0.0, y, z));
        for eye in [
            [400.0, 0.0, 60.0],
            [350.0, -90.0, 200.0],
            [250.0, 160.0, -40.0],
        ] {
            let pass = Camera::through(glass, Vector::from(eye)).pass();
            for (corner, at) in glass.iter().zip([[-1.0, -1.0], [1.0, -1.0], [-1.0, 1.0]]) {
                let seen = pass.seen(corner).expect("ahead");
                assert!((seen.x - at[0]).abs() < 1e-9 && (seen.y - at[1]).abs() < 1e-9);
            }
        }
    }

    #[test]
    fn a_half_mirror_flips_left_and_right_alone() {
        let (plain, mut flipped) = (camera(), camera());
        flipped.mirrored = true;
        let point = Vector::new(14.0, -8.0, 2.0);
        let (a, b) = (plain.pass().seen(&point), flipped.pass().seen(&point));
        let (a, b) = (a.expect("ahead"), b.expect("ahead"));
        assert!(
            (a.x + b.x).abs() < 1e-12 && (a.y - b.y).abs() < 1e-12 && (a.z - b.z).abs() < 1e-12
        );
        assert!(flipped.pass().turns && !plain.pass().turns);
    }

    #[test]
    fn the_axes_move_a_point_as_the_picture_shows() {
        let (plain, mut flipped) = (camera(), camera());
        flipped.mirrored = true;
        for camera in [plain, flipped] {
            let [right, up, towards] = camera.axes();
            let seen = |by: Vector| camera.pass().seen(&(camera.middle() + by)).expect("ahead");
            let (start, depth) = (seen(Vector::zeros()), seen(towards));
            assert!(seen(right).x > start.x + 1e-3 && seen(up).y > start.y + 1e-3);
            assert!(depth.z < start.z - 1e-6, "nearer to the eye");
        }
    }

    #[test]
    fn a_ray_goes_through_the_point_that_is_seen_there() {
        let (pass, point) = (camera().pass(), Vector::new(-20.0, 15.0, -9.0));
        let seen = pass.seen(&point).expect("ahead");
        let (from, along) = pass.ray(seen.x, seen.y).expect("a ray");
        let off = (point - from) - along * (point - from).dot(&along);
        assert!(off.norm() < 1e-6, "{off}");
    }

    #[test]
    fn an_orbit_keeps_the_middle_and_the_distance() {
        let camera = camera();
        let turned = camera.orbited(0.4, -0.2, 1.0);
        assert!((turned.middle() - camera.middle()).norm() < 1e-9);
        let away = |camera: &Camera| (camera.eye - camera.middle()).norm();
        assert!((away(&turned) - away(&camera)).abs() < 1e-9);
        assert!((away(&camera.orbited(0.0, 0.0, 0.5)) / away(&camera) - 0.5).abs() < 1e-12);
    }
}
