//! Hand that moves one tool without force.

use super::limits::Limits;
use super::motion::Motion;
use super::pose::{HandPose, at_most, turn, turned};
use crate::camera::Vector;

/// Distance from home that ends the way home: mm, and radians.
const AT_HOME: [f64; 2] = [1e-6, 1e-6];

/// State of a hand: the pose that its input asks for, and the motion still to be done.
///
/// The hand turns its tool about the pivot, so that a rotation leaves the tip in its place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hand {
    /// Pivot in the tool's frame, mm.
    pivot: Vector,
    home: HandPose,
    limits: Limits,
    /// Place of the pivot in the world, mm, and orientation.
    pose: HandPose,
    /// Motion that the speed has not let through yet: world axes, mm and radians.
    backlog: Motion,
    is_homing: bool,
}

impl Hand {
    /// Hand at a start pose, which is also its home. `pivot` is the working point of the tool, in its frame, mm.
    pub fn new(home: HandPose, pivot: Vector, limits: Limits) -> Self {
        let mut hand = Self {
            pivot,
            home,
            limits,
            pose: home,
            backlog: Motion::none(),
            is_homing: false,
        };
        hand.place(&home.point(&pivot));
        hand
    }

    /// Pose that the input asks for.
    pub fn pose(&self) -> HandPose {
        self.pose
    }

    /// Pivot in the tool's frame, mm.
    pub fn pivot(&self) -> Vector {
        self.pivot
    }

    /// Limits.
    pub fn limits(&self) -> &Limits {
        &self.limits
    }

    /// Takes in a motion, world axes, mm and radians. The motion is carried out by [`Hand::advance`] within the limits
    /// of speed. A motion beyond the backlog, and one that is not finite, is dropped.
    pub fn apply(&mut self, motion: &Motion) {
        if !motion.is_finite() || *motion == Motion::none() {
            return;
        }
        if self.is_homing {
            self.stop();
        }
        let Limits {
            speed_mm_s,
            spin_rad_s,
            backlog_s,
            ..
        } = self.limits;
        let sum = self.backlog.and(motion);
        self.backlog = Motion {
            shift: at_most(&sum.shift, speed_mm_s * backlog_s),
            turn: at_most(&sum.turn, spin_rad_s * backlog_s),
        };
    }

    /// Starts the way home, at the greatest speed. Any later motion ends it.
    pub fn go_home(&mut self) {
        self.backlog = Motion::none();
        self.is_homing = true;
    }

    /// Forgets motion that is still to be done.
    pub fn stop(&mut self) {
        self.backlog = Motion::none();
        self.is_homing = false;
    }

    /// Carries out the motion of a time, seconds.
    pub fn advance(&mut self, seconds: f64) {
        if self.is_homing {
            self.backlog = Motion {
                shift: self.home.point(&self.pivot) - self.pose.point(&self.pivot),
                turn: turned(&self.pose.orientation, &self.home.orientation),
            };
        }
        let done = Motion {
            shift: at_most(&self.backlog.shift, self.limits.speed_mm_s * seconds),
            turn: at_most(&self.backlog.turn, self.limits.spin_rad_s * seconds),
        };
        self.backlog = self.backlog.and(&done.times(-1.0, -1.0));
        let left = [self.backlog.shift.norm(), self.backlog.turn.norm()];
        self.is_homing &= left[0] > AT_HOME[0] || left[1] > AT_HOME[1];
        let place = self.pose.point(&self.pivot) + done.shift;
        // The product of many rotations leaves unit length by rounding.
        let mut orientation = turn(&done.turn) * self.pose.orientation;
        orientation.renormalize();
        self.pose.orientation = orientation;
        self.place(&place);
    }

    /// Puts the hand at a pose, for example one that the guide allows. The backlog stays.
    pub fn put(&mut self, pose: &HandPose) {
        self.pose.orientation = pose.orientation;
        self.place(&pose.point(&self.pivot));
    }

    fn place(&mut self, place: &Vector) {
        let inside = self.limits.inside(place);
        self.pose = HandPose::with_point_at(&self.pivot, &inside, self.pose.orientation);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hand::pose::Turn;
    use proptest::prelude::*;

    const PIVOT: [f64; 3] = [0.0, -8.0, 90.0];

    fn hand() -> Hand {
        let pivot = Vector::from(PIVOT);
        let home =
            HandPose::with_point_at(&pivot, &Vector::zeros(), turn(&Vector::new(0.4, 0.2, 1.0)));
        Hand::new(home, pivot, Limits::around([Vector::zeros()], 50.0))
    }

    fn run(hand: &mut Hand, seconds: f64) {
        for _ in 0..(seconds * 1000.0) as usize {
            hand.advance(1e-3);
        }
    }

    fn tip(hand: &Hand) -> Vector {
        hand.pose().point(&hand.pivot())
    }

    #[test]
    fn a_motion_arrives_in_full_and_a_turn_leaves_the_tip_in_its_place() {
        let mut hand = hand();
        hand.apply(&Motion::shift(3.0, -2.0, 1.0));
        run(&mut hand, 0.1);
        assert!((tip(&hand) - Vector::new(3.0, -2.0, 1.0)).norm() < 1e-9);
        let (before, by) = (hand.pose(), Vector::new(0.1, 0.2, -0.15));
        hand.apply(&Motion::turn(by.x, by.y, by.z));
        run(&mut hand, 0.2);
        assert!((tip(&hand) - Vector::new(3.0, -2.0, 1.0)).norm() < 1e-9);
        let found = turned(&before.orientation, &hand.pose().orientation);
        assert!((found - by).norm() < 1e-9, "{found}");
        assert!(
            (hand.pose().position - before.position).norm() > 1.0,
            "the handle moves"
        );
    }

    #[test]
    fn a_jump_of_the_mouse_is_cut_to_the_backlog_and_to_the_speed() {
        let mut hand = hand();
        hand.apply(&Motion::shift(400.0, 0.0, 0.0));
        hand.advance(1e-3);
        assert!((tip(&hand).x - 0.15).abs() < 1e-9, "150 mm/s for 1 ms");
        run(&mut hand, 1.0);
        assert!((tip(&hand).x - 15.0).abs() < 1e-6, "150 mm/s for 0.1 s");
    }

    #[test]
    fn the_way_home_ends_there_and_a_motion_ends_the_way() {
        let mut hand = hand();
        let home = hand.pose();
        hand.put(&HandPose::with_point_at(
            &hand.pivot(),
            &Vector::new(30.0, 0.0, 9.0),
            Turn::identity(),
        ));
        hand.go_home();
        run(&mut hand, 0.1);
        let half = tip(&hand).norm();
        assert!((10.0..20.0).contains(&half), "{half}");
        let mut other = hand;
        run(&mut hand, 0.5);
        assert!((hand.pose().position - home.position).norm() < 1e-6);
        assert!(!hand.is_homing);
        other.apply(&Motion::shift(0.0, 0.0, 1e-3));
        run(&mut other, 0.5);
        assert!((tip(&other).norm() - half).abs() < 0.01);
    }

    proptest! {
        #[test]
        fn any_motions_stay_within_workspace_and_speed(
            motions in proptest::collection::vec(
                ([-1e4f64..1e4, -1e4..1e4, -1e4..1e4], [-9.0f64..9.0, -9.0..9.0, -9.0..9.0], any::<bool>()), 1..80),
        ) {
            let mut hand = hand();
            for (shift, by, is_odd) in motions {
                let mut motion = Motion { shift: Vector::from(shift), turn: Vector::from(by) };
                if is_odd {
                    motion.shift.y = f64::NAN;
                }
                hand.apply(&motion);
                let (before, was) = (tip(&hand), hand.pose().orientation);
                hand.advance(1e-3);
                prop_assert!((tip(&hand) - before).norm() <= 0.15 + 1e-9);
                prop_assert!(turned(&was, &hand.pose().orientation).norm() <= 4e-3 + 1e-9);
                prop_assert!(tip(&hand).amax() <= 50.0 + 1e-9);
            }
        }
    }
}
