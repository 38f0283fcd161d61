//! Settings of the measurement: the thresholds that a rubric sets.

use serde::{Deserialize, Serialize};

/// Thresholds of the measurement. The table `[settings]` of a rubric.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Settings {
    /// Target band of the force on a floor, N. Range 0.02 to 5. Schools teach 10 to 25 g.
    pub force_n: [f64; 2],
    /// Distance to the prescribed depth within which the floor counts as reached, mm. Range 0.1 to 5.
    pub reached_mm: f64,
    /// Difference between the called depth and the depth of the tip from which a call is a misreading, mm. Range 0.5
    /// to 5.
    pub misread_mm: f64,
    /// Distance to its place half a second before within which a mirror counts as steady, mm. Range 0.1 to 20.
    pub steady_mm: f64,
    /// Whether recession must be called. If true, a session without any call of recession scores 0 for it.
    /// If false, recession counts from its first call.
    #[serde(default, skip_serializing_if = "is_no")]
    pub ask_recession: bool,
    /// Whether bleeding must be called, by the same rule.
    #[serde(default, skip_serializing_if = "is_no")]
    pub ask_bleeding: bool,
    /// Whether furcation must be called, by the same rule.
    #[serde(default, skip_serializing_if = "is_no")]
    pub ask_furcation: bool,
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "as serde calls it")]
fn is_no(yes: &bool) -> bool {
    !yes
}
