//! Acts of controls: steady motions, meanings of the mouse, and switches.

use crate::hand::motion::Motion;

/// Act of a control. Directions are those of the picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Act {
    /// Steady motion upwards.
    Up,
    /// Steady motion downwards.
    Down,
    /// Steady motion to the left.
    Left,
    /// Steady motion to the right.
    Right,
    /// Steady motion away from the eye.
    Away,
    /// Steady motion towards the eye.
    Towards,
    /// Steady turn, upper side away from the eye.
    TipAway,
    /// Steady turn, upper side towards the eye.
    TipTowards,
    /// Steady turn, near side to the left.
    TurnLeft,
    /// Steady turn, near side to the right.
    TurnRight,
    /// Steady turn, upper side to the left.
    RollLeft,
    /// Steady turn, upper side to the right.
    RollRight,
    /// Precision while held.
    Precise,
    /// Opens or closes the clutch.
    Clutch,
    /// Chooses the other hand.
    OtherHand,
    /// Way home.
    Home,
    /// Takes the tool up, or lays it down.
    TakeOrLay,
    /// Counts of the mouse move in the plane of the picture.
    InPicture,
    /// Counts of the mouse move to the sides, away from the eye and towards it. Notches of the wheel do as well.
    InDepth,
    /// Counts of the mouse tip and turn.
    Tilt,
    /// Counts of the mouse roll.
    Roll,
    /// Deflections in all six directions.
    AllSix,
}

impl Act {
    /// All acts.
    pub const ALL: [Self; 22] = {
        use Act::*;
        [
            Up, Down, Left, Right, Away, Towards, TipAway, TipTowards, TurnLeft, TurnRight,
            RollLeft, RollRight, Precise, Clutch, OtherHand, Home, TakeOrLay, InPicture, InDepth,
            Tilt, Roll, AllSix,
        ]
    };

    /// Whether the control of the act belongs to the hands while the clutch is open. Every other control then serves
    /// findings and the camera.
    pub fn works_open(self) -> bool {
        use Act::*;
        matches!(self, Precise | Clutch | OtherHand | TakeOrLay)
    }

    /// Full deflection of a steady motion; `None` for other acts.
    pub fn deflection(self) -> Option<Motion> {
        Some(match self {
            Self::Up => Motion::shift(0.0, 1.0, 0.0),
            Self::Down => Motion::shift(0.0, -1.0, 0.0),
            Self::Left => Motion::shift(-1.0, 0.0, 0.0),
            Self::Right => Motion::shift(1.0, 0.0, 0.0),
            Self::Away => Motion::shift(0.0, 0.0, -1.0),
            Self::Towards => Motion::shift(0.0, 0.0, 1.0),
            Self::TipAway => Motion::turn(-1.0, 0.0, 0.0),
            Self::TipTowards => Motion::turn(1.0, 0.0, 0.0),
            Self::TurnLeft => Motion::turn(0.0, -1.0, 0.0),
            Self::TurnRight => Motion::turn(0.0, 1.0, 0.0),
            Self::RollLeft => Motion::turn(0.0, 0.0, 1.0),
            Self::RollRight => Motion::turn(0.0, 0.0, -1.0),
            _ => return None,
        })
    }

    /// Motion of the mouse by `right` and `down` counts; none for an act without the mouse.
    pub fn counts(self, right: f64, down: f64) -> Motion {
        match self {
            Self::InPicture => Motion::shift(right, -down, 0.0),
            Self::InDepth => Motion::shift(right, 0.0, down),
            Self::Tilt => Motion::turn(down, right, 0.0),
            Self::Roll => Motion::turn(0.0, 0.0, -right),
            _ => Motion::none(),
        }
    }
}
