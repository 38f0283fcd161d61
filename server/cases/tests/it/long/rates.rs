//! The same scenes under the same hands at 1, 2 and 4 kHz.

use sulcus_support::long;

use crate::rates::{feels_the_same, hold};

/// Rigid and soft, by hand and by script, slow and fast.
const CASES: [&str; 11] = [
    "thin-plate-0.5",
    "thin-plate-2",
    "teleport",
    "sharp-edge",
    "wedge",
    "tumble",
    "pocket-0.4",
    "two-probes",
    "tongue-10-k2",
    "tongue-edge-0.5",
    "organ-10-k2",
];

#[test]
fn every_bound_of_a_case_holds_at_2_and_4_khz() {
    if long::selected("rates") {
        hold(&CASES, &[2000, 4000]);
    }
}

#[test]
fn a_press_feels_the_same_at_any_rate() {
    if long::selected("a-press-at-any-rate") {
        for name in ["pocket-0.5", "tongue-10-k2", "organ-10-k2"] {
            feels_the_same(name, &[2000, 4000]);
        }
    }
}
