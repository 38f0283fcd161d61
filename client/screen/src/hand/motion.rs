//! Motion in the axes of the picture.

use crate::camera::{Camera, Vector};

/// Translation and rotation about the picture's axes: x to the right, y upwards, z towards the eye.
///
/// The unit follows from the use: counts of a mouse, shares of the greatest speed, or mm and radians. Rotations follow
/// the right hand: a positive turn about x tips the upper side towards the eye.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Motion {
    /// Translation.
    pub shift: Vector,
    /// Rotation vector.
    pub turn: Vector,
}

impl Motion {
    /// No motion.
    pub fn none() -> Self {
        Self::default()
    }

    /// Translation without rotation.
    pub fn shift(right: f64, up: f64, towards: f64) -> Self {
        Self {
            shift: Vector::new(right, up, towards),
            turn: Vector::zeros(),
        }
    }

    /// Rotation without translation.
    pub fn turn(right: f64, up: f64, towards: f64) -> Self {
        Self {
            shift: Vector::zeros(),
            turn: Vector::new(right, up, towards),
        }
    }

    /// Motion with other units.
    pub fn times(&self, shift: f64, turn: f64) -> Self {
        Self {
            shift: self.shift * shift,
            turn: self.turn * turn,
        }
    }

    /// Both motions together; rotation vectors add up.
    pub fn and(&self, other: &Self) -> Self {
        Self {
            shift: self.shift + other.shift,
            turn: self.turn + other.turn,
        }
    }

    /// Whether all numbers are finite.
    pub fn is_finite(&self) -> bool {
        let numbers = self.shift.iter().chain(self.turn.iter());
        numbers.copied().all(f64::is_finite)
    }
}

/// Axes of a picture in the world: to the right, upwards, towards the eye.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame([Vector; 3]);

impl Frame {
    /// Axes of a camera.
    pub fn of(camera: &Camera) -> Self {
        Self(camera.axes())
    }

    /// The same motion in the axes of the world. In a flipped picture a rotation is flipped as well: the tool turns as
    /// the picture shows.
    pub fn in_world(&self, motion: &Motion) -> Motion {
        let [right, up, towards] = self.0;
        let sum = |v: &Vector| right * v.x + up * v.y + towards * v.z;
        // A rotation vector changes its sign under a reflection.
        let handed = right.cross(&up).dot(&towards).signum();
        Motion {
            shift: sum(&motion.shift),
            turn: sum(&motion.turn) * handed,
        }
    }
}

impl Default for Frame {
    /// Axes of a person who looks at the patient's face: left of the patient is right.
    fn default() -> Self {
        Self([Vector::y(), Vector::z(), Vector::x()])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hand::pose::turn;

    fn camera(mirrored: bool) -> Camera {
        let eye = Vector::new(300.0, -120.0, 210.0);
        let mut camera = Camera::looking(eye, Vector::new(5.0, 4.0, 3.0), Vector::z(), 20.0, 1.5);
        camera.mirrored = mirrored;
        camera
    }

    #[test]
    fn a_motion_goes_where_the_picture_shows() {
        for mirrored in [false, true] {
            let camera = camera(mirrored);
            let (frame, pass) = (Frame::of(&camera), camera.pass());
            let seen = |at: &Vector| pass.seen(at).expect("ahead");
            let (from, tip) = (
                camera.middle(),
                camera.middle() + Frame::of(&camera).0[1] * 20.0,
            );
            let by = frame.in_world(&Motion::shift(2.0, 1.0, 0.0)).shift;
            let moved = seen(&(from + by)) - seen(&from);
            assert!(moved.x > 1e-3 && moved.y > 1e-3, "{moved}");
            // A turn about the line of sight carries what is above to the left.
            let by = frame.in_world(&Motion::turn(0.0, 0.0, 0.3)).turn;
            let turned = seen(&(from + turn(&by) * (tip - from))) - seen(&tip);
            assert!(turned.x < -1e-3, "{mirrored}: {turned}");
            // A turn about the axis to the right brings what is above nearer to the eye.
            let by = frame.in_world(&Motion::turn(0.3, 0.0, 0.0)).turn;
            let nearer = seen(&(from + turn(&by) * (tip - from))).z - seen(&tip).z;
            assert!(nearer < -1e-6, "{mirrored}: {nearer}");
        }
    }

    #[test]
    fn motions_add_up_and_take_units() {
        let both = Motion::shift(1.0, 2.0, 3.0).and(&Motion::turn(4.0, 5.0, 6.0));
        let scaled = both.times(2.0, 0.5);
        assert_eq!(scaled.shift, Vector::new(2.0, 4.0, 6.0));
        assert_eq!(scaled.turn, Vector::new(2.0, 2.5, 3.0));
        assert!(both.is_finite() && !both.times(f64::NAN, 1.0).is_finite());
    }
}
