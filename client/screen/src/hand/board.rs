//! State of keys and mouse buttons, and their effect on the hands.

use super::hands::{Hands, Steady};
use super::keys::{Act, Control, TABLE, act};
use super::motion::Motion;
use super::pad::PadEvent;
use super::spacenav::CapRule;
use super::sticks::Sticks;

/// Counts of the mouse that a notch of the wheel stands for. Chosen: 0.5 mm.
const NOTCH: f64 = 20.0;

/// Keys and mouse buttons of a window.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Board {
    down: [bool; Control::ALL.len()],
}

impl Default for Board {
    fn default() -> Self {
        Self::new()
    }
}

impl Board {
    /// Board with no key down.
    pub fn new() -> Self {
        Self {
            down: [false; Control::ALL.len()],
        }
    }

    /// Takes in a press. Returns whether the press belongs to the hands; any other goes to findings and camera.
    /// Repeated presses of a held key count once.
    pub fn press(&mut self, control: Control, hands: &mut Hands) -> bool {
        if hands.is_open() && !act(control).works_open() {
            return false;
        }
        if std::mem::replace(&mut self.down[control as usize], true) {
            return true;
        }
        match act(control) {
            Act::Clutch => hands.set_open(!hands.is_open()),
            Act::OtherHand => hands.choose_next(),
            Act::Home => hands.go_home(),
            Act::TakeOrLay => hands.take_or_lay(),
            _ => self.hold(hands),
        }
        true
    }

    /// Takes in a release.
    pub fn release(&mut self, control: Control, hands: &mut Hands) {
        self.down[control as usize] = false;
        self.hold(hands);
    }

    /// Takes in a motion of the mouse, counts to the right and downwards.
    pub fn mouse(&self, right: f64, down: f64, hands: &mut Hands) {
        let with = [Control::Ctrl, Control::RightButton, Control::LeftButton];
        let held = with.into_iter().find(|k| self.down[*k as usize]);
        hands.apply(&act(held.unwrap_or(Control::Mouse)).counts(right, down));
    }

    /// Takes in notches of the wheel, positive away from the person.
    pub fn wheel(&self, notches: f64, hands: &mut Hands) {
        hands.apply(&act(Control::Wheel).counts(0.0, -NOTCH * notches));
    }

    /// Takes in a deflection of the cap of a 3D mouse, each number -1 to 1.
    pub fn cap(&self, share: &Motion, hands: &mut Hands) {
        hands.deflect(Steady::Cap, share);
    }

    /// Takes in the sticks of a gamepad.
    pub fn sticks(&self, sticks: &Sticks, hands: &mut Hands) {
        hands.deflect(Steady::Sticks, &sticks.deflection(&CapRule::sticks()));
    }

    /// Takes in an event of a gamepad. Returns whether the event belongs to the hands.
    pub fn pad(&mut self, event: &PadEvent, hands: &mut Hands) -> bool {
        match event {
            PadEvent::Sticks(sticks) => {
                self.sticks(sticks, hands);
                true
            }
            PadEvent::Button(button, is_down) => {
                let Some(control) = button.control() else {
                    return false;
                };
                if *is_down {
                    return self.press(control, hands);
                }
                self.release(control, hands);
                true
            }
        }
    }

    /// Releases all keys and lets the hands go, as for a window that lost the focus.
    pub fn let_go(&mut self, hands: &mut Hands) {
        *self = Self::new();
        hands.let_go();
    }

    /// Passes on what held keys do.
    fn hold(&self, hands: &mut Hands) {
        let held = TABLE
            .iter()
            .filter(|(control, _)| self.down[*control as usize]);
        let steady = held.filter_map(|(_, act)| act.deflection());
        let sum = steady.fold(Motion::none(), |sum, each| sum.and(&each));
        hands.deflect(Steady::Keys, &sum);
        let mut precise = TABLE.iter().filter(|(_, act)| *act == Act::Precise);
        hands.set_precise(precise.any(|(control, _)| self.down[*control as usize]));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::Vector;
    use crate::hand::hands::Scales;
    use crate::hand::limits::Limits;
    use crate::hand::one::Hand;
    use crate::hand::pose::{HandPose, Turn, turned};

    fn hands() -> Hands {
        let home = HandPose {
            position: Vector::zeros(),
            orientation: Turn::identity(),
        };
        let hand = Hand::new(
            home,
            Vector::zeros(),
            Limits::around([Vector::zeros()], 90.0),
        );
        Hands::new([Some(hand), Some(hand)], Scales::default())
    }

    /// Place and rotation vector of the chosen tool after a second. x points to the eye, y to the right.
    fn after(hands: &mut Hands) -> [Vector; 2] {
        for _ in 0..1000 {
            hands.advance(1e-3);
        }
        let pose = hands.pose(hands.chosen()).expect("a tool");
        [pose.position, turned(&Turn::identity(), &pose.orientation)]
    }

    #[test]
    fn letters_are_findings_until_the_clutch_is_closed() {
        let (mut hands, mut board) = (hands(), Board::new());
        assert!(!board.press(Control::S, &mut hands));
        assert!(
            !board.press(Control::RightButton, &mut hands),
            "the camera's"
        );
        assert_eq!(after(&mut hands)[0], Vector::zeros());
        assert!(board.press(Control::Space, &mut hands));
        assert!(board.press(Control::Space, &mut hands), "a repeated press");
        assert!(!hands.is_open());
        assert!(board.press(Control::S, &mut hands));
        assert!((after(&mut hands)[0] - Vector::new(0.0, 0.0, -20.0)).norm() < 1e-6);
        board.release(Control::S, &mut hands);
        assert!((after(&mut hands)[0] - Vector::new(0.0, 0.0, -20.0)).norm() < 1e-6);
        board.release(Control::Space, &mut hands);
        board.press(Control::Space, &mut hands);
        assert!(hands.is_open() && !board.press(Control::S, &mut hands));
    }

    #[test]
    fn buttons_and_wheel_change_the_meaning_of_the_mouse() {
        let moved = |with: Option<Control>| {
            let (mut hands, mut board) = (hands(), Board::new());
            hands.set_open(false);
            if let Some(with) = with {
                assert!(board.press(with, &mut hands));
            }
            board.mouse(40.0, 20.0, &mut hands);
            after(&mut hands)
        };
        let close = |found: [Vector; 2], place: [f64; 3], turn: [f64; 3]| {
            let off = [
                found[0] - Vector::from(place),
                found[1] - Vector::from(turn),
            ];
            assert!(off[0].norm() < 1e-9 && off[1].norm() < 1e-9, "{found:?}");
        };
        close(moved(None), [0.0, 1.0, -0.5], [0.0; 3]);
        close(moved(Some(Control::LeftButton)), [0.5, 1.0, 0.0], [0.0; 3]);
        close(
            moved(Some(Control::RightButton)),
            [0.0; 3],
            [0.0, 0.04, 0.08],
        );
        close(moved(Some(Control::Ctrl)), [0.0; 3], [-0.08, 0.0, 0.0]);
        close(moved(Some(Control::Shift)), [0.0, 0.25, -0.125], [0.0; 3]);
        let (mut hands, board) = (hands(), Board::new());
        hands.set_open(false);
        board.wheel(2.0, &mut hands);
        close(after(&mut hands), [-1.0, 0.0, 0.0], [0.0; 3]);
    }

    #[test]
    fn a_lost_focus_releases_everything() {
        let (mut hands, mut board) = (hands(), Board::new());
        hands.set_open(false);
        board.press(Control::D, &mut hands);
        board.press(Control::Shift, &mut hands);
        board.let_go(&mut hands);
        hands.set_open(false);
        assert_eq!(after(&mut hands)[0], Vector::zeros());
        assert!(board.press(Control::Tab, &mut hands));
        assert_eq!(hands.chosen(), 1);
        board.press(Control::D, &mut hands);
        assert!(
            (after(&mut hands)[0].y - 20.0).abs() < 1e-6,
            "no precision is left"
        );
    }

    #[test]
    fn sticks_move_three_times_as_fast_as_a_key_and_a_quarter_of_that_with_precision() {
        let (mut hands, mut board) = (hands(), Board::new());
        assert!(board.press(Control::PadLower, &mut hands));
        let sticks = Sticks {
            left: [0.0, 1.0],
            ..Sticks::default()
        };
        board.sticks(&sticks, &mut hands);
        assert!((after(&mut hands)[0].z - 60.0).abs() < 1e-6);
        board.sticks(
            &Sticks {
                left: [0.0, -1.0],
                ..sticks
            },
            &mut hands,
        );
        board.press(Control::PadLeft, &mut hands);
        assert!((after(&mut hands)[0].z - 45.0).abs() < 1e-6);
    }
}
