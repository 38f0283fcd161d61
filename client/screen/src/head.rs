//! Head of the patient, turned and tilted in steps.
//!
//! The world frame of the simulation stays with the mouth. The picture shows the head in the room: eye and glass of the
//! camera turn against the head, about the middle of the picture. Every view keeps its subject in the middle.

use nalgebra::Rotation3;

use crate::camera::{Camera, Vector};

/// Step of a key, degrees. Chosen.
const STEP_DEG: i16 = 15;
/// Largest turn and largest tilt to either side, degrees. Chosen, within the motion of a lying patient's neck.
const MOST_DEG: [i16; 2] = [45, 30];

/// Head.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Head {
    turn_deg: i16,
    tilt_deg: i16,
}

impl Head {
    /// Head turned to the patient's left, -45 to 45 degrees, and tilted with the chin upwards, -30 to 30 degrees.
    ///
    /// # Errors
    /// An angle is out of range.
    pub fn new(turn_deg: i16, tilt_deg: i16) -> Result<Self, String> {
        for (name, deg, most) in [
            ("turn", turn_deg, MOST_DEG[0]),
            ("tilt", tilt_deg, MOST_DEG[1]),
        ] {
            if !(-most..=most).contains(&deg) {
                return Err(format!(
                    "the {name} of the head is {deg} degrees, expected -{most} to {most}"
                ));
            }
        }
        Ok(Self { turn_deg, tilt_deg })
    }

    /// Turn to the patient's left, degrees.
    pub fn turn_deg(&self) -> i16 {
        self.turn_deg
    }

    /// Tilt of the chin upwards, degrees.
    pub fn tilt_deg(&self) -> i16 {
        self.tilt_deg
    }

    /// Head after steps to the patient's left and with the chin upwards, within the range.
    pub fn stepped(&self, left: i16, up: i16) -> Self {
        let [turn, tilt] = MOST_DEG;
        Self {
            turn_deg: (self.turn_deg + left * STEP_DEG).clamp(-turn, turn),
            tilt_deg: (self.tilt_deg + up * STEP_DEG).clamp(-tilt, tilt),
        }
    }

    /// Rotation of the head, `room_from_mouth`: the tilt about the axis through the ears, then the turn about the neck.
    pub fn rotation(&self) -> Rotation3<f64> {
        let [turn, tilt] = [self.turn_deg, self.tilt_deg].map(|deg| f64::from(deg).to_radians());
        let about_ears = Rotation3::from_axis_angle(&Vector::y_axis(), -tilt);
        Rotation3::from_axis_angle(&Vector::z_axis(), turn) * about_ears
    }

    /// Camera in the frame of the mouth, for a camera in the room. The middle of the picture stays.
    pub fn seen(&self, camera: &Camera) -> Camera {
        if *self == Self::default() {
            return *camera;
        }
        camera.rotated(&self.rotation().inverse(), &camera.middle())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_stay_in_the_range() {
        let mut head = Head::default();
        for (steps, turn) in [(1, 15), (1, 30), (1, 45), (1, 45), (-7, -45)] {
            head = head.stepped(steps, 0);
            assert_eq!((head.turn_deg(), head.tilt_deg()), (turn, 0));
        }
        let up = head.stepped(0, 9);
        assert_eq!((up.turn_deg(), up.tilt_deg()), (-45, 30));
        assert_eq!(Head::new(-45, 30), Ok(up));
        for (turn, tilt, name) in [(46, 0, "turn"), (0, -31, "tilt")] {
            let refused = Head::new(turn, tilt).expect_err("out of range");
            assert!(refused.contains(name), "{refused}");
        }
    }

    #[test]
    fn a_turn_to_the_left_carries_the_chin_to_the_patients_left_and_a_tilt_upwards() {
        let chin = |turn, tilt| Head::new(turn, tilt).expect("in range").rotation() * Vector::x();
        assert!(chin(30, 0).y > 0.49 && chin(-30, 0).y < -0.49);
        assert!(chin(0, 30).z > 0.49 && chin(0, -30).z < -0.49);
    }

    #[test]
    fn the_picture_of_a_turned_head_is_that_of_its_turned_points() {
        let eye = Vector::new(260.0, -30.0, 330.0);
        let mut camera = Camera::looking(eye, Vector::new(-8.0, 4.0, 2.0), Vector::z(), 17.0, 1.6);
        for mirrored in [false, true] {
            camera.mirrored = mirrored;
            for (turn, tilt) in [(0, 0), (45, 0), (-15, 30), (30, -30)] {
                let head = Head::new(turn, tilt).expect("in range");
                let (seen, middle) = (head.seen(&camera).pass(), camera.middle());
                for point in [[0.0, 0.0, 0.0], [-20.0, 24.0, 3.0], [9.0, -12.0, -7.0]] {
                    let point = Vector::from(point);
                    let turned = middle + head.rotation() * (point - middle);
                    let off = seen.seen(&point).expect("ahead")
                        - camera.pass().seen(&turned).expect("ahead");
                    assert!(off.norm() < 1e-9, "{turn} {tilt} {off}");
                }
            }
        }
    }
}
