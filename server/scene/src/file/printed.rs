//! Entries of tissue as printed: the same tongue or gingiva, run by the paper's own equations for comparison.

use serde::{Deserialize, Serialize};

use crate::file::TissueEntry;

/// `[object.printed_skeleton]`: what differs from the defaults of [`sulcus_core::tissue::printed::PrintedSkeleton`], in clinical units. Which
/// spheres are joined and held comes from `[object.skeleton]`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct PrintedSkeletonEntry {
    /// Stiffness of every spring, N/mm; by default the mean of the coupled skeleton's.
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

/// `[object.printed_gingiva]`: what differs from the defaults of [`sulcus_core::tissue::printed::PrintedGingiva`], in clinical units.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct PrintedGingivaEntry {
    /// Stiffness `k_d` of a fringe sphere, N/mm; by default the wall's of the coupled gingiva.
    pub stiffness_n_per_mm: Option<f64>,
    /// Penalty stiffness `K_p`, N/mm; by default half of `k_d`.
    pub penalty_n_per_mm: Option<f64>,
    /// Attenuation `a`, per mm.
    pub attenuation_per_mm: Option<f64>,
    /// Distance beyond which a neighbour stays, mm.
    pub neighbourhood_mm: Option<f64>,
    /// Diameter `2R` of the tool's tip, mm.
    pub tip_diameter_mm: Option<f64>,
    /// Distance of contact prediction, mm.
    pub contact_distance_mm: Option<f64>,
}

impl TissueEntry {
    /// Whether it stands on a skeleton of springs, by either method.
    pub fn is_skeleton(self) -> bool {
        matches!(self, Self::Skeleton | Self::PrintedSkeleton)
    }

    /// Whether it deforms as a whole, by whatever method.
    pub fn is_organ(self) -> bool {
        self.is_skeleton() || self == Self::SurfaceCompliance
    }

    /// Whether it is a gingiva, by either method.
    pub fn is_gingiva(self) -> bool {
        matches!(self, Self::Gingiva | Self::PrintedGingiva)
    }
}
