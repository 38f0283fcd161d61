//! The table of long proofs.

use super::Long;

/// Every long proof, in the order of their slices.
pub const LONG: &[Long] = &[];
