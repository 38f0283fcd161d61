//! Version of the service, and the field of a force that follows from it.

use std::fmt;

use serde_json::Value;

/// Version of the service.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Version {
    major: u32,
    minor: u32,
}

/// Field of a force in a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Field {
    /// `vector`, of version 3.5 and later.
    Vector,
    /// `values`, of versions 3.1 to 3.4.
    Values,
}

impl Field {
    /// Name in a message.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Vector => "vector",
            Self::Values => "values",
        }
    }
}

impl Version {
    /// Reads the answer to `GET /version`: an object with `project_version`, or the version alone.
    pub(super) fn parse(body: &str) -> Option<Self> {
        let value: Option<Value> = serde_json::from_str(body).ok();
        let named = match &value {
            Some(Value::Object(map)) => map.get("project_version")?.as_str()?,
            Some(Value::String(text)) => text.as_str(),
            _ => body,
        };
        let mut parts = named.trim().trim_start_matches(['v', 'V']).split('.');
        let major = number(parts.next()?)?;
        let minor = number(parts.next()?)?;
        Some(Self { major, minor })
    }

    /// Returns the field of a force.
    ///
    /// # Errors
    /// The version is older than 3.1: one sentence.
    pub(super) fn field(self) -> Result<Field, String> {
        match (self.major, self.minor) {
            (3, 1..=4) => Ok(Field::Values),
            (0..=2, _) | (3, 0) => Err(format!(
                "the Haply service has version {self}, expected 3.1 or later: update the Haply software"
            )),
            _ => Ok(Field::Vector),
        }
    }

    /// Remark about a version that is newer than the known ones.
    pub(super) fn remark(self) -> Option<String> {
        (self.major > 3).then(|| {
            format!("the Haply service has version {self}, and versions 3.1 to 3.9 are known: the force may stay away")
        })
    }
}

/// Number at the beginning of `part`; a suffix such as `0-beta` is no obstacle.
fn number(part: &str) -> Option<u32> {
    let end = part.find(|c: char| !c.is_ascii_digit());
    part[..end.unwrap_or(part.len())].parse().ok()
}

impl fmt::Display for Version {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}.{}", self.major, self.minor)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn each_version_has_its_field() {
        let of = |text: &str| Version::parse(text).unwrap().field();
        for old in [r#"{"project_version":"3.0.9"}"#, "2.7.1", r#""0.9""#] {
            let sentence = of(old).unwrap_err();
            assert!(sentence.contains("expected 3.1 or later"), "{sentence}");
        }
        assert_eq!(of(r#"{"project_version":"3.1.0"}"#), Ok(Field::Values));
        assert_eq!(
            of(r#"{"a":1,"project_version":"v3.4.12-rc1"}"#),
            Ok(Field::Values)
        );
        assert_eq!(of("3.5"), Ok(Field::Vector));
        assert_eq!(of("3.10.0"), Ok(Field::Vector));
        assert_eq!(of("4.0.0"), Ok(Field::Vector));
        assert!(Version::parse("4.0.0").unwrap().remark().is_some());
        assert!(Version::parse("3.9.0").unwrap().remark().is_none());
    }

    #[test]
    fn other_texts_are_no_version() {
        for text in [
            "",
            "3",
            "{}",
            r#"{"project_version":3.5}"#,
            "three.five",
            "null",
            "[3,5]",
        ] {
            assert_eq!(Version::parse(text), None, "{text}");
        }
    }

    proptest! {
        #[test]
        fn no_text_panics(text in ".{0,60}") {
            let _ = Version::parse(&text);
        }
    }
}
