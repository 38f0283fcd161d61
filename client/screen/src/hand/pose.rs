//! Pose of a tool in double precision, and rotation about a point of the tool.

use nalgebra::{Quaternion, UnitQuaternion};
use sulcus_proto::datagram::WirePose;

use crate::camera::Vector;
use crate::stage::MM;

/// Rotation.
pub type Turn = UnitQuaternion<f64>;

/// Pose of a tool, `world_from_tool`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HandPose {
    /// Device point, the origin of the tool's frame: world axes, mm.
    pub position: Vector,
    /// Orientation.
    pub orientation: Turn,
}

impl HandPose {
    /// Pose of the wire; `None` for a number that is not finite, and for a quaternion length outside 0.5 to 2.
    pub fn of(wire: &WirePose) -> Option<Self> {
        let position = wire.position.map(|x| f64::from(x) * f64::from(MM));
        let [w, i, j, k] = wire.orientation.map(f64::from);
        let turn = Quaternion::new(w, i, j, k);
        let valid = position.iter().all(|x| x.is_finite()) && (0.5..2.0).contains(&turn.norm());
        valid.then(|| Self {
            position: Vector::from(position),
            orientation: Turn::from_quaternion(turn),
        })
    }

    /// Pose of the wire: metres, quaternion `[w, x, y, z]`.
    pub fn wire(&self) -> WirePose {
        let turn = self.orientation.quaternion();
        WirePose {
            position: (self.position / f64::from(MM)).map(|x| x as f32).into(),
            orientation: [turn.w, turn.i, turn.j, turn.k].map(|x| x as f32),
        }
    }

    /// Place in the world of a point of the tool, mm.
    pub fn point(&self, own: &Vector) -> Vector {
        self.position + self.orientation * own
    }

    /// Pose with an orientation, whose point `own` of the tool lies at `place`.
    pub fn with_point_at(own: &Vector, place: &Vector, orientation: Turn) -> Self {
        Self {
            position: place - orientation * own,
            orientation,
        }
    }
}

/// Rotation of a rotation vector, radians.
pub fn turn(by: &Vector) -> Turn {
    Turn::from_scaled_axis(*by)
}

/// Rotation vector from `from` to `to` by the shorter way, world axes, radians, at most half a turn long.
pub fn turned(from: &Turn, to: &Turn) -> Vector {
    (to * from.inverse()).scaled_axis()
}

/// Vector with a length of at most `most`.
pub fn at_most(v: &Vector, most: f64) -> Vector {
    let length = v.norm();
    if length > most {
        v * (most / length)
    } else {
        *v
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn a_pose_survives_the_wire_and_a_turn_keeps_its_point(
            place in [-200.0f64..200.0, -200.0..200.0, -200.0..200.0],
            by in [-1.7f64..1.7, -1.7..1.7, -1.7..1.7],
        ) {
            let (place, own) = (Vector::from(place), Vector::new(3.0, -20.0, 90.0));
            let pose = HandPose::with_point_at(&own, &place, turn(&Vector::from(by)));
            prop_assert!((pose.point(&own) - place).norm() < 1e-9);
            let back = HandPose::of(&pose.wire()).expect("finite");
            prop_assert!((back.position - pose.position).norm() < 1e-4);
            prop_assert!(turned(&back.orientation, &pose.orientation).norm() < 1e-5);
            let vector = turned(&Turn::identity(), &pose.orientation);
            prop_assert!((turn(&vector).angle_to(&pose.orientation)) < 1e-7);
        }
    }

    #[test]
    fn a_pose_that_is_no_pose_is_refused() {
        let good = WirePose::IDENTITY;
        assert!(HandPose::of(&good).is_some());
        let position = [0.0, f32::NAN, 0.0];
        assert_eq!(HandPose::of(&WirePose { position, ..good }), None);
        for orientation in [
            [0.0; 4],
            [f32::INFINITY, 0.0, 0.0, 0.0],
            [3.0, 0.0, 0.0, 0.0],
        ] {
            assert_eq!(
                HandPose::of(&WirePose {
                    orientation,
                    ..good
                }),
                None
            );
        }
    }

    #[test]
    fn a_long_vector_is_cut_and_a_short_one_stays() {
        let v = Vector::new(3.0, 0.0, -4.0);
        assert_eq!(at_most(&v, 10.0), v);
        assert!((at_most(&v, 2.5) - v * 0.5).norm() < 1e-12);
        assert_eq!(at_most(&v, 0.0), Vector::zeros());
    }
}
