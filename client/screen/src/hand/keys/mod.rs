//! Keys, mouse, 3D mouse and gamepad: one table of controls and acts, which the help of the screen prints.
//!
//! Letters are findings while the clutch is open ([`crate::readings::Key`]), and motions while it is closed. A student
//! holds the tool by opening the clutch, types the finding, and closes the clutch again.

mod act;

pub use act::Act;

use crate::strings::Strings;

/// Key, mouse, or part of a 3D mouse or a gamepad. A window maps its own keys to these, letters by their place on the
/// keyboard.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Control {
    /// Letter key.
    W,
    /// Letter key.
    S,
    /// Letter key.
    A,
    /// Letter key.
    D,
    /// Letter key.
    Q,
    /// Letter key.
    E,
    /// Arrow key.
    ArrowUp,
    /// Arrow key.
    ArrowDown,
    /// Arrow key.
    ArrowLeft,
    /// Arrow key.
    ArrowRight,
    /// Page key.
    PageUp,
    /// Page key.
    PageDown,
    /// Either shift key.
    Shift,
    /// Space bar.
    Space,
    /// Tabulator.
    Tab,
    /// Home key.
    Home,
    /// Insert key.
    Insert,
    /// Mouse without a button.
    Mouse,
    /// Left button, and the mouse while the button is held.
    LeftButton,
    /// Right button, and the mouse while the button is held.
    RightButton,
    /// Either control key, and the mouse while the key is held.
    Ctrl,
    /// Wheel.
    Wheel,
    /// Cap of a 3D mouse.
    Cap,
    /// First button of a 3D mouse.
    CapFirst,
    /// Second button of a 3D mouse.
    CapSecond,
    /// Sticks, triggers and shoulder buttons of a gamepad.
    Sticks,
    /// Lower button of a gamepad's right side.
    PadLower,
    /// Right button of a gamepad's right side.
    PadRight,
    /// Left button of a gamepad's right side.
    PadLeft,
    /// Upper button of a gamepad's right side.
    PadUpper,
}

impl Control {
    /// All controls, in the order of the table.
    pub const ALL: [Self; 30] = {
        use Control::*;
        [
            W,
            S,
            A,
            D,
            Q,
            E,
            ArrowUp,
            ArrowDown,
            ArrowLeft,
            ArrowRight,
            PageUp,
            PageDown,
            Shift,
            Space,
            Tab,
            Home,
            Insert,
            Mouse,
            LeftButton,
            RightButton,
            Ctrl,
            Wheel,
            Cap,
            CapFirst,
            CapSecond,
            Sticks,
            PadLower,
            PadRight,
            PadLeft,
            PadUpper,
        ]
    };
}

/// Act of each control.
pub const TABLE: [(Control, Act); Control::ALL.len()] = [
    (Control::W, Act::Up),
    (Control::S, Act::Down),
    (Control::A, Act::Left),
    (Control::D, Act::Right),
    (Control::Q, Act::Away),
    (Control::E, Act::Towards),
    (Control::ArrowUp, Act::TipAway),
    (Control::ArrowDown, Act::TipTowards),
    (Control::ArrowLeft, Act::TurnLeft),
    (Control::ArrowRight, Act::TurnRight),
    (Control::PageUp, Act::RollLeft),
    (Control::PageDown, Act::RollRight),
    (Control::Shift, Act::Precise),
    (Control::Space, Act::Clutch),
    (Control::Tab, Act::OtherHand),
    (Control::Home, Act::Home),
    (Control::Insert, Act::TakeOrLay),
    (Control::Mouse, Act::InPicture),
    (Control::LeftButton, Act::InDepth),
    (Control::RightButton, Act::Tilt),
    (Control::Ctrl, Act::Roll),
    (Control::Wheel, Act::InDepth),
    (Control::Cap, Act::AllSix),
    (Control::CapFirst, Act::Clutch),
    (Control::CapSecond, Act::Home),
    (Control::Sticks, Act::AllSix),
    (Control::PadLower, Act::Clutch),
    (Control::PadRight, Act::OtherHand),
    (Control::PadLeft, Act::Precise),
    (Control::PadUpper, Act::Home),
];

/// Act of a control.
pub fn act(control: Control) -> Act {
    TABLE[control as usize].1
}

/// State of the clutch in words, open or closed.
pub fn clutch(is_open: bool, strings: &Strings) -> &'static str {
    strings.hands.clutch[usize::from(!is_open)]
}

/// Lines of the help: control and act, in words.
pub fn help(strings: &Strings) -> [[&'static str; 2]; TABLE.len()] {
    let words = &strings.hands;
    TABLE.map(|(control, act)| [words.controls[control as usize], words.acts[act as usize]])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hand::motion::Motion;
    use crate::strings::ENGLISH;

    #[test]
    fn table_and_lists_have_the_order_of_the_enums() {
        for (k, (control, _)) in TABLE.iter().enumerate() {
            assert_eq!((*control as usize, Control::ALL[k]), (k, *control));
        }
        for (k, act) in Act::ALL.iter().enumerate() {
            assert_eq!(*act as usize, k);
            assert!(
                TABLE.iter().any(|(_, used)| used == act),
                "{act:?} has no control"
            );
        }
        assert_eq!(act(Control::Space), Act::Clutch);
    }

    #[test]
    fn the_help_has_a_line_of_words_for_every_control() {
        let lines = help(&ENGLISH);
        assert!(lines.contains(&["W", "up"]));
        assert!(lines.contains(&["Right button and mouse", "tip and turn"]));
        assert!(lines.contains(&["Wheel", "move away and towards you"]));
        assert!(lines.contains(&["Second button of a 3D mouse", "way back to the start"]));
        for (k, [control, act]) in lines.iter().enumerate() {
            assert!(!control.is_empty() && !act.is_empty());
            assert!(
                lines[..k].iter().all(|[earlier, _]| earlier != control),
                "{control} twice"
            );
        }
    }

    #[test]
    fn an_open_clutch_says_that_the_tool_rests() {
        let [open, closed] = [true, false].map(|is_open| clutch(is_open, &ENGLISH));
        assert!(open.contains("rests") && closed.contains("moves"));
    }

    #[test]
    fn opposite_keys_cancel() {
        let steady = TABLE.iter().filter_map(|(_, act)| act.deflection());
        let sum = steady.fold(Motion::none(), |sum, each| sum.and(&each));
        assert_eq!(sum, Motion::none());
    }
}
