//! Keys of the readings, free of any window system.

/// Key of a reading.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Key {
    /// Digit, 0 to 9. A larger number changes nothing.
    Digit(u8),
    /// Sign of a recession: the margin lies above the cemento-enamel junction.
    Minus,
    /// Clears the probing depth, and takes the next digits for it. A new site begins in this field.
    Depth,
    /// Probing depth as a whole number, mm, counted by a pedal. A number beyond the range changes nothing.
    Count(u8),
    /// Bleeding: the first press says yes, the second no, the third withdraws the finding.
    Bleeding,
    /// Suppuration: the first press says yes, the second withdraws the finding.
    Suppuration,
    /// Clears the recession, and takes the next digits for it.
    Recession,
    /// Clears the furcation, and takes the next digit for its grade.
    Furcation,
    /// Takes back the last key that changed something.
    Undo,
    /// Confirms the site and goes on to the next one. Without any finding the site stays open.
    Next,
    /// Goes back to the site before. All findings stay.
    Back,
}

impl Key {
    /// Key of a typed character; letter case has no meaning. `None`: no key of a reading.
    ///
    /// | character | key |
    /// |---|---|
    /// | `0` to `9` | digit |
    /// | `-` | minus |
    /// | `p` | probing depth |
    /// | `b`, `s`, `r`, `f` | bleeding, suppuration, recession, furcation |
    /// | `u`, backspace | undo |
    /// | `n`, return, blank | next |
    /// | `<`, `,` | back |
    pub fn from_char(c: char) -> Option<Self> {
        let key = match c.to_ascii_lowercase() {
            '0'..='9' => Self::Digit(c.to_digit(10)? as u8),
            '-' => Self::Minus,
            'p' => Self::Depth,
            'b' => Self::Bleeding,
            's' => Self::Suppuration,
            'r' => Self::Recession,
            'f' => Self::Furcation,
            'u' | '\u{8}' => Self::Undo,
            'n' | '\r' | '\n' | ' ' => Self::Next,
            '<' | ',' => Self::Back,
            _ => return None,
        };
        Some(key)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn letters_of_either_case_are_keys_and_others_are_none() {
        assert_eq!(Key::from_char('7'), Some(Key::Digit(7)));
        assert_eq!(Key::from_char('B'), Key::from_char('b'));
        assert_eq!(Key::from_char('\r'), Some(Key::Next));
        for c in ['x', '\u{663}', '\u{1b}', '+'] {
            assert_eq!(Key::from_char(c), None, "{c:?}");
        }
    }
}
