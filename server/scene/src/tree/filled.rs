//! Whether a tree fills the volume of its mesh. A surface that folds onto or crosses itself passes every check of its
//! edges; the spheres of its tree fill what the folds span, many times the volume that the surface encloses.

use sulcus_core::{Sphere, SphereTree};

use crate::error::union_volume;
use crate::mesh::TriMesh;
use crate::tree::build::{TreeBuildError, TreeOptions};

/// Rays along which the spheres are cut: the volume is known to half a percent.
const RAYS: usize = 10_000;
/// Most cuts of rays through spheres. Deep trees get fewer rays, so that the check takes milliseconds.
const MOST_CUTS: f64 = 1e6;

/// How much less and more than its mesh a tree may fill, shares of the mesh's volume, by the number of its finest level:
/// trees of real teeth, tongues, jaws and instruments are within 0.005 from level 3 on, within 0.1 at level 2, and at
/// level 1 within 0.3 but for a probe 170 times as long as thick, of which eight spheres are no shape.
const TOLERANCES: [(f64, f64); 4] = [(0.75, 4.0), (0.6, 1.0), (0.3, 0.3), (0.1, 0.1)];
/// The same where places count differently: far from what counts, few spheres are left.
const WEIGHTED: (f64, f64) = (0.5, 0.5);
/// How much less the second level of a volumetric tree may fill: its inner spheres stand for cells, and do not overlap.
const VOLUMETRIC_LESS: f64 = 0.9;

/// Volume of the spheres of a tree's finest level, cubic metres.
pub fn filled(tree: &SphereTree) -> f64 {
    let spheres: Vec<Sphere> = tree
        .shape_at(tree.depth())
        .map(|(_, node)| node.sphere())
        .collect();
    union_volume(&spheres, RAYS, MOST_CUTS)
}

/// How much less and more than its mesh the tree of these options may fill, shares of the mesh's volume. `depth` is the
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

/// Makes sure that the finest level of a tree fills about the volume that its mesh encloses.
///
/// # Errors
/// Both volumes and the tolerance.
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
    // Written so that NaN fails.
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
