//! Filter of the list of sessions: the parts of an address behind the question mark.

use serde::Deserialize;

use super::book::People;
use crate::house::Recorded;

/// Filter; an empty part admits everything.
#[derive(Clone, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(default)]
pub struct Filter {
    /// Name of the class.
    pub class: String,
    /// Opaque learner id.
    pub learner: String,
    /// Exercise.
    pub exercise: String,
    /// Mode.
    pub mode: String,
}

impl Filter {
    /// Whether a session passes.
    pub fn admits(&self, one: &Recorded, people: &People) -> bool {
        let is = |wanted: &str, found: &str| wanted.is_empty() || wanted == found;
        is(&self.learner, &one.learner)
            && is(&self.exercise, &one.exercise)
            && is(&self.mode, &one.mode)
            && (self.class.is_empty()
                || people.is_member(&self.class, &one.learner, one.started_unix_s))
    }

    /// The filter as the part of an address, with the question mark; empty without a filter.
    pub fn query(&self) -> String {
        let parts = [
            ("class", &self.class),
            ("learner", &self.learner),
            ("exercise", &self.exercise),
            ("mode", &self.mode),
        ];
        let parts: Vec<String> = parts
            .iter()
            .filter(|(_, value)| !value.is_empty())
            .map(|(name, value)| format!("{name}={}", encoded(value)))
            .collect();
        if parts.is_empty() {
            String::new()
        } else {
            format!("?{}", parts.join("&"))
        }
    }
}

/// Text as a part of an address.
pub fn encoded(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for byte in text.bytes() {
        if byte.is_ascii_alphanumeric() || matches!(byte, b'-' | b'_' | b'.') {
            out.push(char::from(byte));
        } else {
            out.push_str(&format!("%{byte:02X}"));
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_filter_survives_its_address() {
        let filter = Filter {
            class: "Year 3 & B".into(),
            learner: "s-1".into(),
            ..Filter::default()
        };
        let query = filter.query();
        assert_eq!(query, "?class=Year%203%20%26%20B&learner=s-1");
        let uri: axum::http::Uri = format!("/results{query}").parse().expect("an address");
        let read = axum::extract::Query::<Filter>::try_from_uri(&uri).expect("a filter");
        assert_eq!(read.0, filter);
        assert_eq!(Filter::default().query(), "");
    }
}
