//! Broken invariants with an open issue. The list can only shrink.

/// A known fault: number of the invariant, and the issue that mends it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Known {
    /// Number of the invariant.
    pub invariant: u8,
    /// Title of the issue.
    pub issue: &'static str,
}

/// Known faults. The program fails for any other one, and for a listed one that none of [`MANY`] seeds shows.
pub const KNOWN: &[Known] = &[Known {
    // The client judges the silence of the server, and not yet the age of the pose behind a wrench.
    invariant: 16,
    issue: "Stations that an exam can stand on, 5",
}];

/// Number of seeds from which on a listed fault must show.
pub const MANY: u64 = 20;

/// The known fault of an invariant, if it has one.
pub fn known(invariant: u8) -> Option<&'static Known> {
    KNOWN.iter().find(|known| known.invariant == invariant)
}
