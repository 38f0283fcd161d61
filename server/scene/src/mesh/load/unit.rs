//! Units of length of mesh files.

use serde::{Deserialize, Serialize};

/// Unit of length of a mesh file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Unit {
    /// Millimetres.
    #[serde(rename = "mm")]
    Millimetre,
    /// Metres.
    #[serde(rename = "m")]
    Metre,
    /// International inches, 25.4 mm.
    #[serde(rename = "in")]
    Inch,
}

impl Unit {
    /// All units, in the order of messages.
    pub const ALL: [Unit; 3] = [Unit::Millimetre, Unit::Metre, Unit::Inch];

    /// Length of one unit, metres.
    pub fn metres(self) -> f64 {
        match self {
            Unit::Millimetre => 1e-3,
            Unit::Metre => 1.0,
            Unit::Inch => 25.4e-3,
        }
    }

    /// Returns the unit in scene files and on the command line.
    pub fn symbol(self) -> &'static str {
        match self {
            Unit::Millimetre => "mm",
            Unit::Metre => "m",
            Unit::Inch => "in",
        }
    }

    /// Returns the unit in a sentence.
    pub(crate) fn plural(self) -> &'static str {
        match self {
            Unit::Millimetre => "millimetres",
            Unit::Metre => "metres",
            Unit::Inch => "inches",
        }
    }
}

impl std::str::FromStr for Unit {
    type Err = String;
    fn from_str(text: &str) -> Result<Self, String> {
        Unit::ALL
            .into_iter()
            .find(|unit| unit.symbol() == text)
            .ok_or_else(|| format!("unit is `{text}`, expected `mm`, `m` or `in`"))
    }
}
