//! Finding of a zone: right, or the fault of hand or eye.

use serde::Serialize;

/// Finding of a zone.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Finding {
    /// The tip reached the floor, and the call is within 1 mm, without too much force or tilt.
    Right,
    /// Neither probed nor called.
    Missed,
    /// Called, but not probed before the call.
    NotProbed,
    /// Probed, but not called.
    NotCalled,
    /// The tip never reached the floor at a correct force.
    NeverReachedFloor,
    /// The tip reached the floor; the call is not the depth of the tip.
    Misread,
    /// The tip reached the floor; the call is the depth of the tip under too much force.
    ReadTooHeavy,
    /// The tip reached the floor; the call is the depth that the bands of a tilted probe showed. The call is more than
    /// 1 mm off, or the tilt was wrong.
    ReadTilted,
    /// The tip reached the floor, and the call is the depth of the tip, yet more than 1 mm off.
    Off,
}

impl Finding {
    /// Words for people.
    pub fn words(self) -> &'static str {
        match self {
            Self::Right => "right",
            Self::Missed => "missed",
            Self::NotProbed => "called, not probed first",
            Self::NotCalled => "not called",
            Self::NeverReachedFloor => "never reached the floor",
            Self::Misread => "misread the band",
            Self::ReadTooHeavy => "read under too much force",
            Self::ReadTilted => "read along a tilted probe",
            Self::Off => "more than 1 mm off",
        }
    }
}
