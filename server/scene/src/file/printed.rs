//! Entries of printed tissue: the same tongue or gingiva, run by the paper's own equations for comparison.

use serde::{Deserialize, Serialize};

/// `[object.printed_skeleton]`: deviations from the defaults of [`sulcus_core::tissue::printed::PrintedSkeleton`], in
/// clinical units.
///
/// `[object.skeleton]` decides which spheres are joined and held.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct PrintedSkeletonEntry {
    /// Stiffness of every spring, N/mm. Default: the mean of the coupled skeleton's.
    pub spring_n_per_mm: Option<f64>,
    /// Damping of every sphere, N s/m.
    pub damping_n_s_per_m: Option<f64>,
    /// Mass of every sphere, g.
    pub mass_g: Option<f64>,
    /// Penalty stiffness for each pair of spheres, N/mm.
    pub penalty_n_per_mm: Option<f64>,
    /// Distance of contact prediction, mm.
    pub contact_distance_mm: Option<f64>,
}

/// `[object.printed_gingiva]`: deviations from the defaults of [`sulcus_core::tissue::printed::PrintedGingiva`], in
/// clinical units.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct PrintedGingivaEntry {
    /// Stiffness `k_d` of a fringe sphere, N/mm. Default: that of the coupled gingiva's wall.
    pub stiffness_n_per_mm: Option<f64>,
    /// Penalty stiffness `K_p`, N/mm. Default: half of `k_d`.
    pub penalty_n_per_mm: Option<f64>,
    /// Attenuation `a`, per mm.
    pub attenuation_per_mm: Option<f64>,
    /// Distance beyond which a neighbour does not move, mm.
    pub neighbourhood_mm: Option<f64>,
    /// Diameter `2R` of the tool's tip, mm.
    pub tip_diameter_mm: Option<f64>,
    /// Distance of contact prediction, mm.
    pub contact_distance_mm: Option<f64>,
}
