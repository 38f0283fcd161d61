//! Switch of a pedal: the key, mouse button or gamepad button that the pedal is for the system.

use std::str::FromStr;

use crate::hand::pad::PadButton;

/// Button of a mouse.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MouseSwitch {
    /// Left button.
    Left,
    /// Right button.
    Right,
    /// Middle button.
    Middle,
    /// Button that goes back.
    Back,
    /// Button that goes forward.
    Forward,
}

impl MouseSwitch {
    /// All buttons with their names.
    const NAMES: [(&str, Self); 5] = [
        ("left", Self::Left),
        ("right", Self::Right),
        ("middle", Self::Middle),
        ("back", Self::Back),
        ("forward", Self::Forward),
    ];
}

/// Keys with a name, besides F1 to F24. The names are those of the W3C (UI Events `key` values), in small letters.
const NAMED: [&str; 26] = [
    "enter",
    "space",
    "tab",
    "backspace",
    "escape",
    "insert",
    "delete",
    "home",
    "end",
    "pageup",
    "pagedown",
    "arrowup",
    "arrowdown",
    "arrowleft",
    "arrowright",
    "shift",
    "control",
    "alt",
    "capslock",
    "numlock",
    "scrolllock",
    "pause",
    "printscreen",
    "contextmenu",
    "audiovolumeup",
    "audiovolumedown",
];

/// Switch of a pedal.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Switch {
    /// Key: its character or name, in small letters.
    Key(String),
    /// Button of a mouse.
    Mouse(MouseSwitch),
    /// Button of a gamepad.
    Pad(PadButton),
}

impl FromStr for Switch {
    type Err = String;

    /// Switch of a name: a single character, a named key such as `pagedown` or `f13`, `mouse-` or `pad-` with the name
    /// of a button.
    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let small = text.to_lowercase();
        if let Some(name) = small.strip_prefix("mouse-") {
            let mut rows = MouseSwitch::NAMES.iter();
            let found = rows.find(|row| row.0 == name);
            let names = MouseSwitch::NAMES.map(|row| row.0).join(", ");
            return found.map(|row| Self::Mouse(row.1)).ok_or_else(|| {
                format!("`{text}` is no button of a mouse, expected mouse- and one of: {names}")
            });
        }
        if let Some(name) = small.strip_prefix("pad-") {
            let names = PadButton::names().join(", ");
            return PadButton::of_name(name).map(Self::Pad).ok_or_else(|| {
                format!("`{text}` is no button of a gamepad, expected pad- and one of: {names}")
            });
        }
        let is_function = (1..=24).any(|n| small == format!("f{n}"));
        let is_character = small.chars().count() == 1 && !small.contains(char::is_whitespace);
        if is_character || is_function || NAMED.contains(&&*small) {
            return Ok(Self::Key(small));
        }
        Err(format!(
            "`{text}` is no key, expected a character, f1 to f24, mouse- or pad- with a button, or one of: {}",
            NAMED.join(", ")
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_and_buttons_are_known_by_their_names() {
        let key = |name: &str| Ok(Switch::Key(name.into()));
        assert_eq!("b".parse(), key("b"));
        assert_eq!("F13".parse(), key("f13"));
        assert_eq!("PageDown".parse(), key("pagedown"));
        assert_eq!("ß".parse(), key("ß"));
        assert_eq!("mouse-back".parse(), Ok(Switch::Mouse(MouseSwitch::Back)));
        assert_eq!("pad-start".parse(), Ok(Switch::Pad(PadButton::Start)));
        for wrong in [
            "",
            " ",
            "f0",
            "f25",
            "f05",
            "f+5",
            "bb",
            "mouse-",
            "mouse-x",
            "pad-x",
            "page down",
        ] {
            let refused = wrong.parse::<Switch>().expect_err("no switch");
            assert!(refused.starts_with(&format!("`{wrong}`")), "{refused}");
        }
    }
}
