//! Figure of a device with its source.

use serde::{Deserialize, Serialize};

/// Trust in a figure.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Source {
    /// Memory, a reseller's text or another program's constant.
    Guess,
    /// Statement of the vendor: a data sheet, or a file of the driver.
    Vendor,
    /// Measurement of the device itself, by `sulcus-client devices measure`.
    Measured,
}

impl Source {
    /// Name in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Guess => "guess",
            Self::Vendor => "vendor",
            Self::Measured => "measured",
        }
    }
}

/// Figure with its source. The name of the field states the unit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Figure<T = f64> {
    /// Value.
    pub value: T,
    /// Trust in the value.
    pub source: Source,
    /// Origin of the value, in words.
    pub from: String,
}
