//! Weak guide: the lead of the hand over the graphic tool is bounded, because nobody feels the wall.
//!
//! A force device stops the hand at a wall. A mouse does not: its tool would run deep into the tissue while the graphic
//! tool stays outside. The force of the coupling, stiffness times lead, would be that of a fist. The guide bounds the
//! lead by the largest force of the exercise: `force / stiffness`. A hand that pushes and then rests holds its force.
//!
//! A tool at its bound also holds back the target of its hand in the direction of the lead. The way back from a wall
//! therefore begins with the first count of the mouse. Motion along the wall is kept.
//!
//! - In contact the lead is bounded by force and torque.
//! - Without contact the lead is the delay of the link times the speed. A wider bound lets a free tool move; it also
//!   bounds the first push at a wall, which lasts for one delay of the link. The return into the narrow bound has the
//!   speed of the hand.
//!
//! Measured against a stiff wall, 500 N/m, bound 0.25 N:
//!
//! | hand | delay of the link | largest force |
//! |---|---|---|
//! | 20 mm/s | 2 to 20 ms | 0.250 N, held |
//! | 140 mm/s | 2 ms | 0.250 N, held |
//! | 140 mm/s | 20 ms | 1.41 N at first; the free lead bounds it to 1.5 N |
//! | 20 mm/s for 1 s, no guide | 2 ms | 7.5 N, held |
//!
//! A pressed tool that slides at 20 mm/s on a link of 10 ms lost 1.5 % of its way.
//!
//! **Recording.** The guide acts before the pose is sent. The recorded poses are those of the guide, and the simulation
//! never sees other ones. A replay feeds the simulation the same poses without a guide, so that it is identical by
//! construction. No hand has felt a recorded force; its upper end is the bound of the guide.

use super::pose::{HandPose, at_most, turn, turned};
use crate::camera::Vector;

/// Bound of the lead of a hand over its graphic tool.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lead {
    /// Largest distance of the pivots, mm.
    pub shift_mm: f64,
    /// Largest angle between the tools, radians.
    pub turn_rad: f64,
}

/// Coupling of a tool, as the scene has it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coupling {
    /// Stiffness in translation of the working point, N/m.
    pub stiffness_n_per_m: f64,
    /// Stiffness in rotation, N m/rad.
    pub stiffness_nm_per_rad: f64,
}

/// Share of a bound from which a tool is at the bound. Rounding of the wire is far below the rest.
const AT_BOUND: f64 = 0.999;

/// Guide of a tool.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Guide {
    /// Bound in contact.
    pub contact: Lead,
    /// Bound without contact.
    pub free: Lead,
    /// Least force of a contact, newtons.
    pub contact_n: f64,
}

impl Guide {
    /// Guide that bounds the force of the coupling to `force_n` and its torque to `torque_nm`. The free lead is chosen:
    /// 3 mm and 0.08 rad, for 150 mm/s and 4 rad/s on a link of 20 ms.
    ///
    /// The bound of the force holds exactly if the pivot is the working point of the tool.
    pub fn new(force_n: f64, torque_nm: f64, coupling: &Coupling) -> Self {
        Self {
            contact: Lead {
                shift_mm: force_n / coupling.stiffness_n_per_m * 1e3,
                turn_rad: torque_nm / coupling.stiffness_nm_per_rad,
            },
            free: Lead {
                shift_mm: 3.0,
                turn_rad: 0.08,
            },
            contact_n: crate::panel::CONTACT_N,
        }
    }

    /// Bound at a displayed force, newtons. A contact never has a wider bound than a free tool. A force that is not a
    /// number counts as a contact.
    pub fn lead(&self, force_n: f64) -> Lead {
        if force_n < self.contact_n {
            Lead {
                shift_mm: self.free.shift_mm.max(self.contact.shift_mm),
                turn_rad: self.free.turn_rad.max(self.contact.turn_rad),
            }
        } else {
            self.contact
        }
    }
}

impl Lead {
    /// Pose nearest to `pose` within the bound round `graphic`, for tools with a pivot in their frame, mm.
    pub fn limited(&self, pose: &HandPose, graphic: &HandPose, pivot: &Vector) -> HandPose {
        let (from, lead) = (
            graphic.point(pivot),
            pose.point(pivot) - graphic.point(pivot),
        );
        let twist = turned(&graphic.orientation, &pose.orientation);
        if lead.norm() <= self.shift_mm && twist.norm() <= self.turn_rad {
            // No rounding for a pose that is allowed.
            return *pose;
        }
        let place = from + at_most(&lead, self.shift_mm);
        let orientation = turn(&at_most(&twist, self.turn_rad)) * graphic.orientation;
        HandPose::with_point_at(pivot, &place, orientation)
    }

    /// Target of a hand whose tool is at `pose`. A tool at its bound takes away the part of the target that lies beyond
    /// the bound in the direction of the lead; any other target stays.
    pub fn stuck(
        &self,
        target: &HandPose,
        pose: &HandPose,
        graphic: &HandPose,
        pivot: &Vector,
    ) -> HandPose {
        let from = graphic.point(pivot);
        let lead = pose.point(pivot) - from;
        let shift = beyond(&(target.point(pivot) - from), &lead, self.shift_mm);
        let twist = |of: &HandPose| turned(&graphic.orientation, &of.orientation);
        let by = beyond(&twist(target), &twist(pose), self.turn_rad);
        let orientation = match by {
            Some(by) => turn(&(twist(target) - by)) * graphic.orientation,
            None => target.orientation,
        };
        let place = target.point(pivot) - shift.unwrap_or_default();
        if shift.is_none() && by.is_none() {
            return *target;
        }
        HandPose::with_point_at(pivot, &place, orientation)
    }
}

/// Part of `wanted` beyond `most` in the direction of `lead`, if a lead of this length is at its bound.
fn beyond(wanted: &Vector, lead: &Vector, most: f64) -> Option<Vector> {
    let length = lead.norm();
    let direction = lead / length;
    let excess = wanted.dot(&direction) - most;
    (length > 0.0 && length >= AT_BOUND * most && excess > 0.0).then(|| direction * excess)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const PROBE: Coupling = Coupling {
        stiffness_n_per_m: 500.0,
        stiffness_nm_per_rad: 0.5,
    };

    #[test]
    fn the_lead_is_force_over_stiffness() {
        let guide = Guide::new(0.25, 0.005, &PROBE);
        assert!((guide.contact.shift_mm - 0.5).abs() < 1e-12);
        assert!((guide.contact.turn_rad - 0.01).abs() < 1e-12);
        assert_eq!(guide.lead(0.0).shift_mm, 3.0);
        for force_n in [0.01, 0.3, f64::NAN] {
            assert_eq!(guide.lead(force_n), guide.contact, "{force_n}");
        }
        let strong = Guide::new(5.0, 1.0, &PROBE);
        assert_eq!(
            strong.lead(0.0),
            strong.contact,
            "never narrower than in contact"
        );
    }

    #[test]
    fn a_target_sticks_in_the_direction_of_the_lead_alone() {
        let bound = Guide::new(0.25, 0.005, &PROBE).contact;
        let pivot = Vector::new(0.0, -8.0, 90.0);
        let at = |place: [f64; 3], by: [f64; 3]| {
            HandPose::with_point_at(&pivot, &Vector::from(place), turn(&Vector::from(by)))
        };
        let graphic = at([0.0; 3], [0.0; 3]);
        let target = at([4.0, 9.0, -3.0], [0.3, 0.0, 0.0]);
        // In the middle of the bound nothing sticks.
        let pose = at([0.3, 0.0, 0.0], [0.005, 0.0, 0.0]);
        assert_eq!(bound.stuck(&target, &pose, &graphic, &pivot), target);
        let pose = at([0.5, 0.0, 0.0], [0.005, 0.0, 0.0]);
        let stuck = bound.stuck(&target, &pose, &graphic, &pivot);
        assert!((stuck.point(&pivot) - Vector::new(0.5, 9.0, -3.0)).norm() < 1e-9);
        assert!((turned(&graphic.orientation, &stuck.orientation).x - 0.3).abs() < 1e-9);
        let pose = at([0.0; 3], [0.01, 0.0, 0.0]);
        let stuck = bound.stuck(&target, &pose, &graphic, &pivot);
        assert!((stuck.point(&pivot) - target.point(&pivot)).norm() < 1e-9);
        assert!((turned(&graphic.orientation, &stuck.orientation).x - 0.01).abs() < 1e-9);
        // A target on the way back stays.
        let back = at([0.4, 9.0, 0.0], [-0.2, 0.0, 0.0]);
        let pose = at([0.5, 0.0, 0.0], [0.01, 0.0, 0.0]);
        assert_eq!(bound.stuck(&back, &pose, &graphic, &pivot), back);
    }

    proptest! {
        #[test]
        fn a_limited_pose_is_the_nearest_allowed_one(
            place in [-9.0f64..9.0, -9.0..9.0, -9.0..9.0], by in [-1.0f64..1.0, -1.0..1.0, -1.0..1.0],
        ) {
            let pivot = Vector::new(0.0, -8.0, 90.0);
            let start = turn(&Vector::new(0.3, -0.5, 2.0));
            let graphic = HandPose::with_point_at(&pivot, &Vector::new(1.0, 2.0, 3.0), start);
            let (shift, by) = (Vector::from(place), Vector::from(by));
            let pose = HandPose::with_point_at(&pivot, &(graphic.point(&pivot) + shift), turn(&by) * start);
            let bound = Guide::new(0.25, 0.005, &PROBE).contact;
            let limited = bound.limited(&pose, &graphic, &pivot);
            let lead = limited.point(&pivot) - graphic.point(&pivot);
            let twist = turned(&graphic.orientation, &limited.orientation);
            prop_assert!(lead.norm() <= 0.5 + 1e-9 && twist.norm() <= 0.01 + 1e-9);
            // On the way from the graphic tool to the hand, as far as the bound allows.
            prop_assert!((lead - shift * (0.5 / shift.norm()).min(1.0)).norm() < 1e-9);
            prop_assert!((twist - by * (0.01 / by.norm()).min(1.0)).norm() < 1e-6);
            let near = HandPose::with_point_at(&pivot, &(graphic.point(&pivot) + shift * 0.01), start);
            prop_assert_eq!(bound.limited(&near, &graphic, &pivot), near);
        }
    }
}
