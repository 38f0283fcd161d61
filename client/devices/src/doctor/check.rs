//! Result of one check.

use std::path::Path;

use serde::Serialize;

/// Most characters of a message.
pub const LONGEST: usize = 300;
/// Most characters of a path or of a foreign text within a message.
const PART: usize = 80;

/// Result of one check.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Check {
    /// Group, and the subject after a space if a group has several checks: `usb`, `library haply`, `permission 1-2`.
    pub name: String,
    /// Whether nothing has to be done.
    pub ok: bool,
    /// Finding, and advice if the check is not ok; at most 300 characters, no line breaks.
    pub message: String,
}

impl Check {
    /// Check that is ok.
    pub fn fine(name: impl Into<String>, message: impl AsRef<str>) -> Self {
        Self::new(name, true, message)
    }

    /// Check that is not ok. The message says what to do.
    pub fn wrong(name: impl Into<String>, message: impl AsRef<str>) -> Self {
        Self::new(name, false, message)
    }

    /// Check without a meaning on this system.
    pub fn elsewhere(name: &str) -> Self {
        Self::fine(name, "not checked on this system")
    }

    /// Group of the check: the first word of the name.
    pub fn group(&self) -> &str {
        self.name.split(' ').next().unwrap_or_default()
    }

    fn new(name: impl Into<String>, ok: bool, message: impl AsRef<str>) -> Self {
        Self {
            name: name.into(),
            ok,
            message: shorten(message.as_ref(), LONGEST),
        }
    }
}

/// Text of at most `most` characters on one line. Control characters become spaces: foreign text must not steer a
/// terminal. A text that is too long loses its middle.
pub fn shorten(text: &str, most: usize) -> String {
    let clean: Vec<char> = text
        .trim()
        .chars()
        .map(|letter| if letter.is_control() { ' ' } else { letter })
        .collect();
    if clean.len() <= most {
        return clean.into_iter().collect();
    }
    let kept = most.saturating_sub(3);
    let tail = kept / 2;
    let head = clean.iter().take(kept - tail);
    let end = clean.iter().skip(clean.len() - tail);
    let gap = std::iter::repeat_n(&'.', most.min(3));
    head.chain(gap).chain(end).collect()
}

/// Foreign text within a message.
pub fn part(text: &str) -> String {
    shorten(text, PART)
}

/// Path within a message.
pub fn shown(path: &Path) -> String {
    part(&path.to_string_lossy())
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn a_long_text_keeps_both_ends() {
        assert_eq!(shorten("abcdefghij", 7), "ab...ij");
        assert_eq!(shorten("a\u{1b}[2J\nb", 20), "a [2J b");
    }

    proptest! {
        #[test]
        fn messages_have_at_most_300_characters_and_one_line(text in any::<String>(), count in 1usize..40) {
            let check = Check::wrong("usb", text.repeat(count));
            prop_assert!(check.message.chars().count() <= LONGEST);
            prop_assert!(!check.message.chars().any(char::is_control));
        }

        #[test]
        fn any_length_can_be_asked_for(text in any::<String>(), most in 0usize..20) {
            prop_assert!(shorten(&text, most).chars().count() <= most);
        }
    }
}
