//! Writer of JSON that can leave fields out and put text that is no sane JSON in place of a number.

use std::fmt::Write;

use crate::options::Omit;

/// Writer of one reply.
#[derive(Debug)]
pub(crate) struct Json<'a> {
    out: String,
    omit: Vec<&'a Omit>,
    comma: bool,
}

impl<'a> Json<'a> {
    /// Writer that leaves parts out.
    pub(crate) fn new(omit: Vec<&'a Omit>) -> Self {
        Self {
            out: String::with_capacity(2048),
            omit,
            comma: false,
        }
    }

    /// True where the part is left out.
    pub(crate) fn omits(&self, wanted: &Omit) -> bool {
        self.omit.contains(&wanted)
    }

    /// The text.
    pub(crate) fn finish(self) -> String {
        self.out
    }

    /// An object that stands for itself or in an array.
    pub(crate) fn braces(&mut self, body: impl FnOnce(&mut Self)) {
        self.separate();
        self.enclose(('{', '}'), body);
    }

    /// A field that holds an object.
    pub(crate) fn object(&mut self, name: &str, body: impl FnOnce(&mut Self)) {
        if self.key(name) {
            self.enclose(('{', '}'), body);
        }
    }

    /// A field that holds an array.
    pub(crate) fn array(&mut self, name: &str, body: impl FnOnce(&mut Self)) {
        if self.key(name) {
            self.enclose(('[', ']'), body);
        }
    }

    /// A field that holds a number.
    pub(crate) fn number(&mut self, name: &str, value: f64) {
        if self.key(name) {
            let _ = if value.is_finite() {
                write!(self.out, "{value}")
            } else {
                write!(self.out, "null")
            };
        }
    }

    /// A field that holds true or false.
    pub(crate) fn flag(&mut self, name: &str, value: bool) {
        self.raw(name, if value { "true" } else { "false" });
    }

    /// A field that holds a text.
    pub(crate) fn text(&mut self, name: &str, value: &str) {
        if self.key(name) {
            self.quote(value);
        }
    }

    /// A field that holds a text of JSON as it is.
    pub(crate) fn raw(&mut self, name: &str, value: &str) {
        if self.key(name) {
            self.out.push_str(value);
        }
    }

    /// A field that holds numbers under one letter each; `first` stands in place of the first number.
    pub(crate) fn vector(
        &mut self,
        name: &str,
        letters: &[&str],
        values: &[f64],
        first: Option<Option<&str>>,
    ) {
        self.object(name, |json| {
            for (index, (letter, value)) in letters.iter().zip(values).enumerate() {
                match first {
                    Some(Some(text)) if index == 0 => json.raw(letter, text),
                    Some(None) if index == 0 => {}
                    _ => json.number(letter, *value),
                }
            }
        });
    }

    fn key(&mut self, name: &str) -> bool {
        if self
            .omit
            .iter()
            .any(|omit| matches!(omit, Omit::Field(field) if field == name))
        {
            return false;
        }
        self.separate();
        self.quote(name);
        self.out.push(':');
        true
    }

    fn separate(&mut self) {
        if std::mem::replace(&mut self.comma, true) {
            self.out.push(',');
        }
    }

    fn enclose(&mut self, (open, close): (char, char), body: impl FnOnce(&mut Self)) {
        self.out.push(open);
        self.comma = false;
        body(self);
        self.out.push(close);
        self.comma = true;
    }

    fn quote(&mut self, text: &str) {
        self.out.push('"');
        for letter in text.chars() {
            match letter {
                '"' | '\\' => {
                    self.out.push('\\');
                    self.out.push(letter);
                }
                letter if letter < ' ' => {
                    let _ = write!(self.out, "\\u{:04x}", u32::from(letter));
                }
                letter => self.out.push(letter),
            }
        }
        self.out.push('"');
    }
}
