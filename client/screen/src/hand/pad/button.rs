//! Buttons of a gamepad, by their place.

use crate::hand::keys::Control;

/// Button of a gamepad.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PadButton {
    /// Lower button of the right side.
    Lower,
    /// Right button of the right side.
    Right,
    /// Upper button of the right side.
    Upper,
    /// Left button of the right side.
    Left,
    /// Left shoulder button.
    LeftShoulder,
    /// Right shoulder button.
    RightShoulder,
    /// Select button.
    Select,
    /// Start button.
    Start,
    /// Press of the left stick.
    LeftStick,
    /// Press of the right stick.
    RightStick,
}

/// Each button with its name on the command line and its number in the kernel.
const TABLE: [(PadButton, &str, u16); 10] = [
    (PadButton::Lower, "lower", 304),
    (PadButton::Right, "right", 305),
    (PadButton::Upper, "upper", 307),
    (PadButton::Left, "left", 308),
    (PadButton::LeftShoulder, "left-shoulder", 310),
    (PadButton::RightShoulder, "right-shoulder", 311),
    (PadButton::Select, "select", 314),
    (PadButton::Start, "start", 315),
    (PadButton::LeftStick, "left-stick", 317),
    (PadButton::RightStick, "right-stick", 318),
];

impl PadButton {
    /// Button with a number of the kernel; `None` for any other number.
    pub fn of_kernel(number: u16) -> Option<Self> {
        let mut rows = TABLE.iter();
        rows.find(|row| row.2 == number).map(|row| row.0)
    }

    /// Button with a name of the command line; `None` for any other name.
    pub fn of_name(name: &str) -> Option<Self> {
        let mut rows = TABLE.iter();
        rows.find(|row| row.1 == name).map(|row| row.0)
    }

    /// Names of all buttons, in the order of the table.
    pub fn names() -> [&'static str; TABLE.len()] {
        TABLE.map(|row| row.1)
    }

    /// Control of the hands; `None` for a button without an act of its own.
    pub fn control(self) -> Option<Control> {
        Some(match self {
            Self::Lower => Control::PadLower,
            Self::Right => Control::PadRight,
            Self::Upper => Control::PadUpper,
            Self::Left => Control::PadLeft,
            _ => return None,
        })
    }
}
