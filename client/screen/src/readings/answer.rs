//! Answers to a key, and the finding that the next digit belongs to.

use super::entry::Entry;

/// Finding that takes the next digit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Field {
    /// Probing depth.
    #[default]
    Depth,
    /// Recession.
    Recession {
        /// Whether the margin lies above the cemento-enamel junction.
        above: bool,
        /// Distance typed so far, mm.
        mm: Option<u8>,
    },
    /// Grade of the furcation.
    Furcation,
}

/// Answer to a key.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Heard {
    /// The key changed the findings, the field or the site.
    Taken,
    /// The findings of a site are confirmed: an event for the recording.
    Confirmed(Entry),
    /// The key changed nothing.
    Wrong(Wrong),
}

/// Reason why a key changed nothing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wrong {
    /// The tour has ended.
    Ended,
    /// The number would leave its range.
    OutOfRange,
    /// The sign belongs to a recession, before its digits.
    SignOutOfPlace,
    /// A furcation lies in the middle of a side.
    Proximal,
    /// The site has findings but no depth.
    NoDepth,
    /// There is no key to take back.
    NothingToUndo,
    /// The first site has none before it.
    AtStart,
}
