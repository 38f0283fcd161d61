//! Tissue as printed in a scene file: the same tongue or gingiva as the coupled method's, run by the paper's own
//! equations for comparison. Numbers are checked where the scene is: the stable limit needs the springs.

use serde::{Deserialize, Serialize};
use sulcus_core::SphereTree;
use sulcus_core::tissue::gingiva::Gingiva;
use sulcus_core::tissue::printed::{PrintedGingiva, PrintedSkeleton};
use sulcus_core::tissue::skeleton::Skeleton;

use crate::file::{ObjectEntry, TissueEntry};

/// `[object.printed_skeleton]`: what differs from the defaults of [`PrintedSkeleton`], in clinical units. Which
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

/// `[object.printed_gingiva]`: what differs from the defaults of [`PrintedGingiva`], in clinical units.
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

fn set(to: &mut f64, from: Option<f64>, unit: f64) {
    if let Some(x) = from {
        *to = x * unit;
    }
}

/// The tongue of `entry` as printed, from its coupled skeleton.
pub(crate) fn printed_skeleton(
    coupled: &Skeleton,
    tree: &SphereTree,
    entry: &ObjectEntry,
) -> PrintedSkeleton {
    let given = entry.printed_skeleton.clone().unwrap_or_default();
    let mut made = PrintedSkeleton::of(&coupled.coarse, tree);
    set(&mut made.spring_n_per_m, given.spring_n_per_mm, 1e3);
    set(&mut made.damping_n_s_per_m, given.damping_n_s_per_m, 1.0);
    set(&mut made.mass_kg, given.mass_g, 1e-3);
    set(&mut made.penalty_n_per_m, given.penalty_n_per_mm, 1e3);
    set(
        &mut made.contact_distance_m,
        given.contact_distance_mm,
        1e-3,
    );
    made
}

/// The gingiva of `entry` as printed, from its coupled model and the index of its tooth.
pub(crate) fn printed_gingiva(
    coupled: &Gingiva,
    tree: &SphereTree,
    tooth: usize,
    entry: &ObjectEntry,
) -> PrintedGingiva {
    let given = entry.printed_gingiva.clone().unwrap_or_default();
    let mut made = PrintedGingiva::of(coupled, tree, tooth as u16);
    set(&mut made.stiffness_n_per_m, given.stiffness_n_per_mm, 1e3);
    if given.penalty_n_per_mm.is_none() {
        made.penalty_n_per_m = 0.5 * made.stiffness_n_per_m;
    }
    set(&mut made.penalty_n_per_m, given.penalty_n_per_mm, 1e3);
    set(&mut made.attenuation_per_mm, given.attenuation_per_mm, 1.0);
    set(&mut made.neighbourhood_m, given.neighbourhood_mm, 1e-3);
    set(&mut made.tip_diameter_m, given.tip_diameter_mm, 1e-3);
    set(
        &mut made.contact_distance_m,
        given.contact_distance_mm,
        1e-3,
    );
    made
}
