//! Ending of a recording's file.

use serde::Serialize;

/// Ending of a recording's file.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Ending {
    /// With the station's last statement and the end of an MCAP file.
    Finished,
    /// Cut off: the program was killed, or the machine stopped. The part before is whole.
    CutOff {
        /// Length of the whole part, bytes.
        at_byte: u64,
        /// Missing part, as text.
        why: String,
    },
    /// With the end of an MCAP file, but recovered from a cut off or damaged file ([`crate::recover()`]). The station's
    /// last statement is missing, or there are gaps.
    Recovered {
        /// Ending of the damaged file, as text.
        was: String,
        /// Missing part, as text.
        missing: String,
    },
    /// Damaged. The part before the damage is whole; the part behind it is not read.
    Damaged {
        /// First damaged byte.
        at_byte: u64,
        /// Fault, as text.
        why: String,
    },
}

impl std::fmt::Display for Ending {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Finished => f.write_str("finished"),
            Self::CutOff { at_byte, why } => write!(f, "cut off after {at_byte} bytes: {why}"),
            // Text from a file may contain control characters of a terminal.
            Self::Recovered { was, missing } => write!(
                f,
                "recovered from one that was {}; missing: {}",
                was.escape_debug(),
                missing.escape_debug()
            ),
            Self::Damaged { at_byte, why } => write!(f, "damaged at byte {at_byte}: {why}"),
        }
    }
}
