//! Escaping of all text in pages.
//!
//! `askama.toml` names [`PageText`] as the escaper of every template. The drawings of [`Svg`](super::svg::Svg) pass
//! their values through the same type. Text therefore reaches a page through [`PageText`] only.

use std::fmt::{self, Write};

use askama::filters::Escaper;

/// Escaper of text and of attribute values in double quotes. Markup characters become entities. Control characters
/// become U+FFFD.
#[derive(Clone, Copy, Debug)]
pub struct PageText;

impl Escaper for PageText {
    fn write_escaped_str<W: Write>(&self, mut dest: W, text: &str) -> fmt::Result {
        text.chars()
            .try_for_each(|c| self.write_escaped_char(&mut dest, c))
    }

    fn write_escaped_char<W: Write>(&self, mut dest: W, c: char) -> fmt::Result {
        match c {
            '&' => dest.write_str("&amp;"),
            '<' => dest.write_str("&lt;"),
            '>' => dest.write_str("&gt;"),
            '"' => dest.write_str("&quot;"),
            '\'' => dest.write_str("&#39;"),
            c if c.is_control() => dest.write_char('\u{fffd}'),
            c => dest.write_char(c),
        }
    }
}

/// Buffer of markup that escapes everything written to it.
pub struct Escaping<'a>(pub &'a mut String);

impl Write for Escaping<'_> {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        PageText.write_escaped_str(&mut *self.0, text)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_recording_says_is_no_markup() {
        let mut page = String::new();
        let text = "<script>'a' & \"b\"\u{7}";
        write!(Escaping(&mut page), "{text}").expect("text");
        assert_eq!(
            page,
            "&lt;script&gt;&#39;a&#39; &amp; &quot;b&quot;\u{fffd}"
        );
    }
}
