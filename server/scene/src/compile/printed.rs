//! Printed tissue of a scene file: the tongue or gingiva of the coupled method, run by the paper's own equations for
//! comparison.
//!
//! The scene's validation checks the numbers, because the stable limit needs the springs.

use sulcus_core::SphereTree;
use sulcus_core::tissue::gingiva::Gingiva;
use sulcus_core::tissue::printed::{PrintedGingiva, PrintedSkeleton};
use sulcus_core::tissue::skeleton::Skeleton;

use crate::file::ObjectEntry;

fn set(to: &mut f64, from: Option<f64>, unit: f64) {
    if let Some(x) = from {
        *to = x * unit;
    }
}

/// Returns the printed tongue of `entry`, from its coupled skeleton.
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

/// Returns the printed gingiva of `entry`, from its coupled model and the index of its tooth.
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
