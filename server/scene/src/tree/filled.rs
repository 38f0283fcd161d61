//! Check that a tree fills the volume of its mesh.
//!
//! A surface that folds onto or crosses itself passes every check of its edges. The spheres of its tree fill the span
//! of the folds, many times the enclosed volume.
//!
//! Users: the builder, for every tree, and the cache, for every tree that it reads.

use sulcus_core::{Sphere, SphereTree};

use crate::mesh::TriMesh;
use crate::tree::build::{TreeBuildError, TreeOptions};
use crate::tree::rays::union_volume;

/// Number of rays through the spheres. They give the volume to half a percent.
const RAYS: usize = 10_000;
/// Largest number of cuts of rays through spheres. Deep trees get fewer rays, so the check takes milliseconds.
const MOST_CUTS: f64 = 1e6;

/// Tolerances below and above the mesh's volume, as shares of it, by the finest level.
///
/// Trees of real teeth, tongues, jaws and instruments are within 0.005 from level 3 on, within 0.1 at level 2, and
/// within 0.3 at level 1.
///
/// The exception at level 1 is a probe 170 times as long as thick, which eight spheres cannot represent.
const TOLERANCES: [(f64, f64); 4] = [(0.75, 4.0), (0.6, 1.0), (0.3, 0.3), (0.1, 0.1)];
/// The same for weighted places: only few spheres are far from the weighty ones.
const WEIGHTED: (f64, f64) = (0.5, 0.5);
/// Tolerance below the volume for the second level of a volumetric tree. Its inner spheres represent cells and do not
/// overlap.
const VOLUMETRIC_LESS: f64 = 0.9;

/// Returns the volume of the spheres of a tree's finest level, cubic metres.
pub fn filled(tree: &SphereTree) -> f64 {
    let spheres: Vec<Sphere> = tree
        .shape_at(tree.depth())
        .map(|(_, node)| node.sphere())
        .collect();
    union_volume(&spheres, RAYS, MOST_CUTS)
}

/// Returns the tolerances below and above the mesh's volume for a tree of these options, as shares. `depth` is the
/// finest level of the tree.
pub fn tolerance(depth: u8, options: &TreeOptions, weighted: bool) -> (f64, f64) {
    let (mut less, mut more) = TOLERANCES[usize::from(depth).min(TOLERANCES.len() - 1)];
    if weighted {
        (less, more) = (less.max(WEIGHTED.0), more.max(WEIGHTED.1));
    }
    if options.volumetric && depth <= 2 {
        less = less.max(VOLUMETRIC_LESS);
    }
    (less, more)
}

/// Checks that the finest level of a tree fills about the volume that its mesh encloses.
///
/// # Errors
/// [`TreeBuildError::Volume`] with both volumes and the tolerance.
pub(crate) fn check_filled(
    tree: &SphereTree,
    mesh: &TriMesh,
    options: &TreeOptions,
    weighted: bool,
) -> Result<(), TreeBuildError> {
    let (of_tree, of_mesh) = (filled(tree), mesh.signed_volume());
    let depth = tree.depth();
    let (less, more) = tolerance(depth, options, weighted);
    let share = of_tree / of_mesh;
    // The comparison fails for a NaN.
    if share >= 1.0 - less && share <= 1.0 + more {
        return Ok(());
    }
    Err(TreeBuildError::Volume {
        tree_mm3: of_tree * 1e9,
        mesh_mm3: of_mesh * 1e9,
        level: depth,
        less_percent: 100.0 * less,
        more_percent: 100.0 * more,
    })
}
