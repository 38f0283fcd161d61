//! Both hands of a person without a force device: which hand moves, scale, clutch, and steady motions.

use nalgebra::Vector3;
use sulcus_proto::TOOLS;

use super::guide::Guide;
use super::motion::{Frame, Motion};
use super::one::Hand;
use super::pose::HandPose;

/// Device that gives steady motions, as shares of the greatest speed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Steady {
    /// Held keys.
    Keys,
    /// Cap of a 3D mouse.
    Cap,
    /// Sticks of a gamepad.
    Sticks,
}

/// Scales between input and motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scales {
    /// Translation for a count of the mouse, mm.
    pub mm_per_count: f64,
    /// Rotation for a count of the mouse, radians.
    pub rad_per_count: f64,
    /// Speed of a full deflection, mm/s.
    pub speed_mm_s: f64,
    /// Spin of a full deflection, rad/s.
    pub spin_rad_s: f64,
    /// Share of all scales under precision.
    pub precise: f64,
}

impl Default for Scales {
    /// Chosen: 400 counts, a centimetre on the desk with a usual mouse, are 10 mm or 46 degrees. A held key moves
    /// 20 mm/s or turns 0.8 rad/s. Precision is a quarter.
    fn default() -> Self {
        Self {
            mm_per_count: 0.025,
            rad_per_count: 0.002,
            speed_mm_s: 20.0,
            spin_rad_s: 0.8,
            precise: 0.25,
        }
    }
}

/// Both hands, by the slots of the tools.
#[derive(Clone, Debug, PartialEq)]
pub struct Hands {
    hands: [Option<Hand>; TOOLS],
    held: [bool; TOOLS],
    chosen: usize,
    frame: Frame,
    scales: Scales,
    is_open: bool,
    is_precise: bool,
    /// Deflections of keys, cap and sticks, each number -1 to 1.
    steady: [Motion; 3],
}

impl Hands {
    /// Hands of a scene: `None` for a slot without a tool. Both hands hold their tools, the first one is chosen, and the
    /// clutch is open.
    pub fn new(hands: [Option<Hand>; TOOLS], scales: Scales) -> Self {
        Self {
            hands,
            held: hands.map(|hand| hand.is_some()),
            chosen: hands.iter().position(Option::is_some).unwrap_or(0),
            frame: Frame::default(),
            scales,
            is_open: true,
            is_precise: false,
            steady: [Motion::none(); 3],
        }
    }

    /// Slot of the hand that moves.
    pub fn chosen(&self) -> usize {
        self.chosen
    }

    /// Chooses the next hand. The other hand stays where it is.
    pub fn choose_next(&mut self) {
        let next = (1..=TOOLS).map(|k| (self.chosen + k) % TOOLS);
        let mut with_tool = next.filter(|k| self.hands[*k].is_some());
        if let Some(next) = with_tool.next() {
            self.stop();
            self.chosen = next;
        }
    }

    /// Whether the clutch is open: motions then move nothing.
    pub fn is_open(&self) -> bool {
        self.is_open
    }

    /// Opens or closes the clutch. An opened clutch stops the hand at once.
    pub fn set_open(&mut self, open: bool) {
        if open {
            self.stop();
        }
        self.is_open = open;
    }

    /// Switches precision.
    pub fn set_precise(&mut self, precise: bool) {
        self.is_precise = precise;
    }

    /// Takes the axes of the picture.
    pub fn look(&mut self, frame: Frame) {
        self.frame = frame;
    }

    /// Takes the chosen tool up, or lays it down.
    pub fn take_or_lay(&mut self) {
        self.held[self.chosen] = !self.held[self.chosen] && self.hands[self.chosen].is_some();
    }

    /// Whether the hand of a slot holds its tool.
    pub fn is_held(&self, slot: usize) -> bool {
        self.held.get(slot).copied().unwrap_or(false)
    }

    /// Starts the way home of the chosen hand, with a closed clutch alone.
    pub fn go_home(&mut self) {
        if let Some(hand) = self.moving() {
            hand.go_home();
        }
    }

    /// Takes in a motion of the mouse, counts in the axes of the picture.
    pub fn apply(&mut self, counts: &Motion) {
        let share = self.share();
        let scaled = counts.times(
            self.scales.mm_per_count * share,
            self.scales.rad_per_count * share,
        );
        let by = self.frame.in_world(&scaled);
        if let Some(hand) = self.moving() {
            hand.apply(&by);
        }
    }

    /// Takes in the deflection of a steady device, each number -1 to 1. The deflection holds until the next call. One
    /// that is not finite counts as none.
    pub fn deflect(&mut self, device: Steady, share: &Motion) {
        let clamped = |v: &Vector3<f64>| v.map(|x| x.clamp(-1.0, 1.0));
        self.steady[device as usize] = if share.is_finite() {
            Motion {
                shift: clamped(&share.shift),
                turn: clamped(&share.turn),
            }
        } else {
            Motion::none()
        };
    }

    /// Lets everything go, as a window that lost the focus must: held keys would never be released.
    pub fn let_go(&mut self) {
        self.steady = [Motion::none(); 3];
        self.is_precise = false;
        self.set_open(true);
    }

    /// Carries out the motion of a time, seconds.
    pub fn advance(&mut self, seconds: f64) {
        let sum = self
            .steady
            .iter()
            .fold(Motion::none(), |sum, each| sum.and(each));
        let share = self.share() * seconds;
        let (speed, spin) = (self.scales.speed_mm_s, self.scales.spin_rad_s);
        let by = self.frame.in_world(&sum.times(speed * share, spin * share));
        if let Some(hand) = self.moving() {
            hand.apply(&by);
        }
        for hand in self.hands.iter_mut().flatten() {
            hand.advance(seconds);
        }
    }

    /// Pose that a hand asks for; `None` for a slot without a tool.
    pub fn pose(&self, slot: usize) -> Option<HandPose> {
        Some(self.hands.get(slot)?.as_ref()?.pose())
    }

    /// Hand of a slot.
    pub fn hand(&self, slot: usize) -> Option<&Hand> {
        self.hands.get(slot)?.as_ref()
    }

    /// Pulls the target of a held tool into the bound of its guide round the graphic tool.
    pub fn stick(&mut self, slot: usize, guide: &Guide, graphic: &HandPose, force_n: f64) {
        let Some(Some(hand)) = self.hands.get_mut(slot) else {
            return;
        };
        let limited = guide
            .lead(force_n)
            .limited(&hand.pose(), graphic, &hand.pivot());
        hand.put(&limited);
    }

    fn share(&self) -> f64 {
        if self.is_precise {
            self.scales.precise
        } else {
            1.0
        }
    }

    /// Chosen hand, with a closed clutch and a tool in it.
    fn moving(&mut self) -> Option<&mut Hand> {
        let may_move = !self.is_open && self.held[self.chosen];
        self.hands[self.chosen].as_mut().filter(|_| may_move)
    }

    fn stop(&mut self) {
        for hand in self.hands.iter_mut().flatten() {
            hand.stop();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::{Camera, Vector};
    use crate::hand::limits::Limits;
    use crate::hand::pose::Turn;

    fn hands() -> Hands {
        let hand = |y: f64| {
            let home = HandPose {
                position: Vector::new(0.0, y, 0.0),
                orientation: Turn::identity(),
            };
            Some(Hand::new(
                home,
                Vector::zeros(),
                Limits::around([home.position], 60.0),
            ))
        };
        let mut hands = Hands::new([hand(0.0), hand(30.0)], Scales::default());
        hands.set_open(false);
        hands
    }

    fn places(hands: &Hands) -> [Vector; 2] {
        [0, 1].map(|slot| hands.pose(slot).expect("a tool").position)
    }

    fn run(hands: &mut Hands) {
        for _ in 0..1000 {
            hands.advance(1e-3);
        }
    }

    #[test]
    fn counts_move_the_chosen_hand_in_the_axes_of_the_picture() {
        let mut hands = hands();
        let eye = Vector::new(0.0, -400.0, 0.0);
        hands.look(Frame::of(&Camera::looking(
            eye,
            Vector::zeros(),
            Vector::z(),
            20.0,
            1.0,
        )));
        hands.apply(&Motion::shift(100.0, 40.0, 20.0));
        run(&mut hands);
        // The eye looks along y: right is x, towards the eye is -y.
        let expected = [Vector::new(2.5, -0.5, 1.0), Vector::new(0.0, 30.0, 0.0)];
        assert!((places(&hands)[0] - expected[0]).norm() < 1e-9);
        assert_eq!(places(&hands)[1], expected[1]);
        hands.choose_next();
        hands.apply(&Motion::shift(0.0, 100.0, 0.0));
        run(&mut hands);
        assert!((places(&hands)[0] - expected[0]).norm() < 1e-9);
        assert!((places(&hands)[1] - Vector::new(0.0, 30.0, 2.5)).norm() < 1e-9);
    }

    #[test]
    fn precision_is_a_quarter_for_mouse_and_keys() {
        let length = |precise: bool| {
            let mut hands = hands();
            hands.set_precise(precise);
            hands.apply(&Motion::shift(80.0, 0.0, 0.0));
            hands.deflect(Steady::Keys, &Motion::shift(1.0, 0.0, 0.0));
            run(&mut hands);
            places(&hands)[0].norm()
        };
        // 80 counts are 2 mm, and a key held for a second is 20 mm.
        assert!((length(false) - 22.0).abs() < 1e-6, "{}", length(false));
        assert!((length(true) - 5.5).abs() < 1e-6);
    }

    #[test]
    fn an_open_clutch_moves_nothing_and_stops_at_once() {
        let mut hands = hands();
        hands.apply(&Motion::shift(400.0, 0.0, 0.0));
        hands.advance(1e-3);
        let before = places(&hands);
        hands.set_open(true);
        hands.apply(&Motion::shift(400.0, 0.0, 0.0));
        hands.deflect(Steady::Cap, &Motion::shift(1.0, 0.0, 0.0));
        hands.go_home();
        run(&mut hands);
        assert_eq!(places(&hands), before);
        hands.set_open(false);
        hands.advance(1e-3);
        assert_ne!(places(&hands), before, "the cap is still deflected");
        hands.let_go();
        hands.set_open(false);
        let before = places(&hands);
        run(&mut hands);
        assert_eq!(places(&hands), before);
    }

    #[test]
    fn a_tool_that_is_laid_down_stays_and_a_wrong_deflection_is_none() {
        let mut hands = hands();
        hands.take_or_lay();
        assert!(!hands.is_held(0) && hands.is_held(1) && !hands.is_held(2));
        hands.apply(&Motion::shift(100.0, 0.0, 0.0));
        hands.deflect(Steady::Sticks, &Motion::shift(1.0, 0.0, 0.0));
        run(&mut hands);
        assert_eq!(places(&hands)[0], Vector::zeros());
        hands.take_or_lay();
        hands.deflect(Steady::Sticks, &Motion::shift(f64::NAN, 1.0, 0.0));
        run(&mut hands);
        assert_eq!(places(&hands)[0], Vector::zeros());
        hands.deflect(Steady::Sticks, &Motion::shift(0.0, 7.0, 0.0));
        run(&mut hands);
        assert!(
            (places(&hands)[0].z - 20.0).abs() < 1e-6,
            "a full deflection at most"
        );
    }

    #[test]
    fn one_tool_alone_stays_chosen() {
        let first = hands().hands[0];
        let mut one = Hands::new([None, first], Scales::default());
        assert_eq!(one.chosen(), 1);
        one.choose_next();
        assert_eq!(one.chosen(), 1);
        assert!(one.pose(0).is_none() && !one.is_held(0));
    }
}
