//! Version of the service.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

/// Version of the service; written as text, for example `3.5.0`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct Version {
    /// First number.
    pub major: u16,
    /// Second number.
    pub minor: u16,
    /// Third number.
    pub patch: u16,
}

impl Version {
    /// First version with `mode` in the state of an arm.
    pub const V3_1: Self = Self::new(3, 1, 0);
    /// Last minor version that understands `values`.
    pub const V3_4: Self = Self::new(3, 4, 0);
    /// First version that understands `vector`.
    pub const V3_5: Self = Self::new(3, 5, 0);

    /// Version of three numbers.
    #[must_use]
    pub const fn new(major: u16, minor: u16, patch: u16) -> Self {
        Self {
            major,
            minor,
            patch,
        }
    }

    /// Name of the field of `set_cursor_force` that this version understands.
    #[must_use]
    pub fn force_field(self) -> &'static str {
        if self >= Self::V3_5 {
            "vector"
        } else {
            "values"
        }
    }

    /// Name of the field of `set_cursor_position` that this version understands.
    #[must_use]
    pub fn position_field(self) -> &'static str {
        if self >= Self::V3_5 {
            "position"
        } else {
            "values"
        }
    }

    /// True where the state of an arm has `mode` instead of `control_domain` and `control_mode`.
    pub(crate) fn has_mode(self) -> bool {
        self < Self::new(3, 2, 0)
    }
}

impl fmt::Display for Version {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}.{}.{}", self.major, self.minor, self.patch)
    }
}

impl FromStr for Version {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let wrong = || format!("'{text}' is no version; expected for example 3.5.0");
        let mut numbers = [0; 3];
        let mut parts = text.split('.');
        for (i, slot) in numbers.iter_mut().enumerate() {
            match parts.next() {
                Some(part) => *slot = part.parse().map_err(|_| wrong())?,
                None if i == 2 => {}
                None => return Err(wrong()),
            }
        }
        if parts.next().is_some() {
            return Err(wrong());
        }
        Ok(Self::new(numbers[0], numbers[1], numbers[2]))
    }
}

impl TryFrom<String> for Version {
    type Error = String;

    fn try_from(text: String) -> Result<Self, Self::Error> {
        text.parse()
    }
}

impl From<Version> for String {
    fn from(version: Version) -> Self {
        version.to_string()
    }
}
