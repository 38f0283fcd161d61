//! Constants of the measures that several modules share: thresholds of force and time, and tolerances.
//!
//! [`Settings`](super::settings::Settings) holds the thresholds that a rubric may change. Constants of a single
//! module stay in that module.

/// Force from which a tool touches, newtons: on the floor of a pocket, on a tooth or on tissue. Chosen.
pub const TOUCH_N: f64 = 0.02;
/// Force above the target band that still counts as correct, newtons. A hand's tremor adds this much.
pub const TREMOR_N: f64 = 0.05;
/// Time of the tip below the margin of a zone from which the zone is probed, seconds. A shorter time is a passage.
pub const PROBED_S: f64 = 0.2;
/// Largest error of a call that is within a millimetre, mm: one millimetre, and the rounding of a tie.
pub const WITHIN_MM: f64 = 1.0 + 1e-9;
/// Largest error of an exact call, mm: half a millimetre, and the rounding of a tie.
pub const EXACT_MM: f64 = 0.5 + 1e-9;
/// Tolerance for rounding in comparisons, in the unit of the comparison.
pub const TIE: f64 = 1e-9;
/// Share of an exercise's length from which an activity has a value: a single touch or look has none. Chosen.
pub const LEAST_SHARE: f64 = 0.25;
/// Time from which an activity has a value in a long exercise, seconds. Chosen.
pub const LEAST_S: f64 = 5.0;
/// Time from which an activity can be a critical error, seconds: a knock is none. Chosen.
pub const CRITICAL_S: f64 = 1.0;
