//! Gamepad: sticks, triggers and shoulder buttons as deflections in the axes of the picture.
//!
//! | part | motion |
//! |---|---|
//! | left stick | right, left, up, down |
//! | right trigger, left trigger | towards the eye, away from it |
//! | right stick | turn right, turn left, tip away, tip towards the eye |
//! | left shoulder, right shoulder | roll left, roll right |

use super::motion::Motion;
use super::spacenav::CapRule;

/// State of a gamepad.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sticks {
    /// Left stick, -1 to 1: to the right, and away from the person.
    pub left: [f64; 2],
    /// Right stick, in the same axes.
    pub right: [f64; 2],
    /// Left and right trigger, 0 to 1.
    pub triggers: [f64; 2],
    /// Left and right shoulder button.
    pub shoulders: [bool; 2],
}

impl Sticks {
    /// Deflection in the axes of the picture, each number -1 to 1. `rule` gives dead zone and curve.
    pub fn deflection(&self, rule: &CapRule) -> Motion {
        let [right, up] = self.left.map(|share| rule.curve(share));
        let [turn, tip] = self.right.map(|share| rule.curve(share));
        let [away, towards] = self.triggers.map(|share| rule.curve(share));
        let [left, roll] = self.shoulders.map(|down| f64::from(u8::from(down)));
        Motion::shift(right, up, towards - away).and(&Motion::turn(-tip, turn, left - roll))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hand::keys::Act;

    #[test]
    fn each_part_moves_as_the_key_of_the_same_direction() {
        let none = Sticks::default();
        let parts = [
            (
                Sticks {
                    left: [1.0, 0.0],
                    ..none
                },
                Act::Right,
            ),
            (
                Sticks {
                    left: [0.0, -1.0],
                    ..none
                },
                Act::Down,
            ),
            (
                Sticks {
                    right: [1.0, 0.0],
                    ..none
                },
                Act::TurnRight,
            ),
            (
                Sticks {
                    right: [0.0, 1.0],
                    ..none
                },
                Act::TipAway,
            ),
            (
                Sticks {
                    triggers: [1.0, 0.0],
                    ..none
                },
                Act::Away,
            ),
            (
                Sticks {
                    triggers: [0.0, 1.0],
                    ..none
                },
                Act::Towards,
            ),
            (
                Sticks {
                    shoulders: [true, false],
                    ..none
                },
                Act::RollLeft,
            ),
            (
                Sticks {
                    shoulders: [false, true],
                    ..none
                },
                Act::RollRight,
            ),
        ];
        for (sticks, act) in parts {
            let found = sticks.deflection(&CapRule::sticks());
            assert_eq!(Some(found), act.deflection(), "{act:?}");
        }
    }

    #[test]
    fn a_worn_stick_at_rest_moves_nothing() {
        let worn = Sticks {
            left: [0.09, -0.07],
            right: [-0.05, 0.1],
            ..Sticks::default()
        };
        assert_eq!(worn.deflection(&CapRule::sticks()), Motion::none());
        assert_ne!(worn.deflection(&CapRule::default()), Motion::none());
    }
}
