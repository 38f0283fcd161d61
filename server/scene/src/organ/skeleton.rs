//! Skeleton of a tree: nodes, neighbours, fixed nodes, stiffness by region and direction, skin weights.
//!
//! The stiffness of the fine level is matched to that of the coarse one.

mod graph;
mod skin;
mod statics;

use std::path::PathBuf;

use serde::{Deserialize, Serialize};
use sulcus_core::tissue::skeleton::{Skeleton, SkeletonLevel, SkeletonParams, Spring, StretchLaw};
use sulcus_core::{SphereTree, Vec3};

use crate::mesh::TriMesh;
use crate::mesh::distance::MeshDistance;
use crate::mesh::implicit::ramp;

pub use statics::pressed;

/// Level of the tree for the coarse skeleton, then for the fine one.
const COARSE: u8 = 2;
const FINE: u8 = 3;

/// `[object.skeleton]`: deformation of an organ as a whole.
///
/// Stiffness and damping are those of the coarse skeleton with up to 64 nodes. The fine skeleton follows from them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct SkeletonOptions {
    /// Stiffness of a spring along x (longitudinal), y (transverse) and z (vertical), N/mm. With the default, a mouth
    /// mirror at 1 to 2 N moves 10 mm.
    pub stiffness_n_per_mm: [f64; 3],
    /// Factor of the stiffness at the root, the hindmost fifth. It falls smoothly to 1 in the middle.
    pub root_factor: f64,
    /// Factor of the stiffness at the tip, the foremost fifth, from 1 in the middle.
    pub tip_factor: f64,
    /// Ratio of the stiffness of a strongly stretched spring to that at rest.
    pub stretch_limit: f64,
    /// Stretch, in rest lengths, at which half of that growth is reached.
    pub stretch_half: f64,
    /// Damping of a node, N s/m.
    pub damping_n_s_per_m: f64,
    /// Density, g/cm3.
    pub density_g_per_cm3: f64,
    /// Share of the length, from the hindmost end, whose nodes are fixed: the root.
    pub fixed_root: f64,
    /// Share of the height, from below, whose nodes are fixed: the bottom layer.
    pub fixed_bottom: f64,
    /// Share of the length, from the foremost end, with a free bottom: the tip.
    pub free_tip: f64,
    /// Whether there is also a fine skeleton.
    pub fine: bool,
    /// File of springs that `sulcus-server tissue fit` fitted to this surface, relative to the scene file.
    ///
    /// Its springs and held nodes replace the values above. Then there is no fine skeleton.
    pub springs_file: Option<PathBuf>,
    /// Young's modulus of this tissue, kPa. The fitted stiffness is proportional to it.
    pub springs_young_kpa: f64,
}

impl Default for SkeletonOptions {
    fn default() -> Self {
        let holds = Holds::default();
        Self {
            stiffness_n_per_mm: [0.0065, 0.0055, 0.0055],
            root_factor: 2.0,
            tip_factor: 0.7,
            stretch_limit: 2.0,
            stretch_half: 0.8,
            damping_n_s_per_m: 0.3,
            density_g_per_cm3: 1.04,
            fixed_root: holds.root,
            fixed_bottom: holds.bottom,
            free_tip: holds.free_tip,
            fine: true,
            springs_file: None,
            springs_young_kpa: 10.0,
        }
    }
}

/// Reason why a skeleton cannot be made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SkeletonError {
    /// No node is fixed, or none is free.
    #[error(
        "found {fixed} fixed of {nodes} skeleton nodes, expected at least one and not all: see `fixed_root`, `fixed_bottom`"
    )]
    Fixed {
        /// Fixed nodes.
        fixed: usize,
        /// All nodes.
        nodes: usize,
    },
    /// A node is connected to no fixed node.
    #[error(
        "skeleton node {node} at ({:.1}, {:.1}, {:.1}) mm of level {level} is connected to no fixed node, expected a chain of springs to one",
        at_mm[0], at_mm[1], at_mm[2]
    )]
    Isolated {
        /// Level of the tree.
        level: u8,
        /// Index of the node in the skeleton.
        node: usize,
        /// Place of the node, in the mesh's frame.
        at_mm: [f64; 3],
    },
}

/// Held parts of an organ, as shares of its box.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Holds {
    /// Share of the length, from the hindmost end: the root.
    pub root: f64,
    /// Share of the height, from below: the bottom layer.
    pub bottom: f64,
    /// Share of the length, from the foremost end, with a free bottom: the tip.
    pub free_tip: f64,
}

impl Default for Holds {
    fn default() -> Self {
        Self {
            root: 0.12,
            bottom: 0.25,
            free_tip: 0.3,
        }
    }
}

impl Holds {
    /// Returns whether a place is held.
    pub fn is_fixed(&self, share: &Vec3) -> bool {
        share.x < self.root || (share.z < self.bottom && share.x < 1.0 - self.free_tip)
    }
}

/// Box of an organ, for the place of a point in it, 0 to 1 along each axis.
pub(crate) struct Frame {
    low: Vec3,
    size: Vec3,
}

impl Frame {
    /// Returns the box between two corners.
    pub fn new(low: Vec3, high: Vec3) -> Self {
        Self {
            low,
            size: high - low,
        }
    }

    pub fn share(&self, p: &Vec3) -> Vec3 {
        (p - self.low).component_div(&self.size)
    }
}

impl SkeletonOptions {
    fn holds(&self) -> Holds {
        Holds {
            root: self.fixed_root,
            bottom: self.fixed_bottom,
            free_tip: self.free_tip,
        }
    }

    fn region(&self, share: &Vec3) -> f64 {
        let root = 1.0 - ramp(share.x, 0.2, 0.5);
        let tip = ramp(share.x, 0.5, 0.8);
        1.0 + root * (self.root_factor - 1.0) + tip * (self.tip_factor - 1.0)
    }
}

/// Makes the skeleton of a volumetric tree of `mesh`. It has a fine level if the options request it and the tree is
/// deep enough.
///
/// # Errors
/// [`SkeletonError`] with the level or node, if no node is fixed or free, or a node is connected to no fixed node.
pub fn skeleton(
    tree: &SphereTree,
    mesh: &TriMesh,
    options: &SkeletonOptions,
) -> Result<Skeleton, SkeletonError> {
    skeleton_held(tree, mesh, options, &|_, share| {
        options.holds().is_fixed(share)
    })
}

/// Makes a skeleton as [`skeleton`] does, with the fixed nodes of `held`.
///
/// `held` receives a place in metres, and as shares of the mesh's box, 0 to 1.
///
/// # Errors
/// [`SkeletonError`] as for [`skeleton`].
pub fn skeleton_held(
    tree: &SphereTree,
    mesh: &TriMesh,
    options: &SkeletonOptions,
    held: &dyn Fn(&Vec3, &Vec3) -> bool,
) -> Result<Skeleton, SkeletonError> {
    let distance = MeshDistance::new(mesh.clone());
    let level = |at: u8| level(tree, &distance, options, held, at);
    let coarse = level(COARSE)?;
    if !options.fine || tree.depth() < FINE {
        return Ok(Skeleton { coarse, fine: None });
    }
    let mut fine = level(FINE)?;
    // The organ stays the same: equal damping in all, and equal displacement under a mirror.
    fine.params.damping *= coarse.free() as f64 / fine.free() as f64;
    let (soft, stiff) = (pressed(&coarse, tree), pressed(&fine, tree));
    // A level without spheres under the discs cannot be matched and keeps its own stiffness.
    let factor = if soft > 0.0 && stiff > 0.0 {
        soft / stiff
    } else {
        1.0
    };
    for spring in &mut fine.springs {
        spring.stiffness = spring.stiffness.map(|k| k * factor);
    }
    Ok(Skeleton {
        coarse,
        fine: Some(fine),
    })
}

fn level(
    tree: &SphereTree,
    distance: &MeshDistance,
    options: &SkeletonOptions,
    held: &dyn Fn(&Vec3, &Vec3) -> bool,
    level: u8,
) -> Result<SkeletonLevel, SkeletonError> {
    let all = tree.nodes();
    // Fitted spheres of level 3 line the surface. Those of level 2 below fill the remaining volume.
    let nodes: Vec<u32> = (0..all.len() as u32)
        .filter(|&k| {
            let node = &all[k as usize];
            node.is_shape_at(level) || (level > COARSE && node.level == COARSE)
        })
        .collect();
    let places: Vec<Vec3> = nodes.iter().map(|&k| all[k as usize].centre).collect();
    let (low, high) = distance.mesh().bounds();
    let frame = Frame::new(low, high);
    let fixed: Vec<bool> = places.iter().map(|p| held(p, &frame.share(p))).collect();
    let held = fixed.iter().filter(|fixed| **fixed).count();
    if held == 0 || held == nodes.len() {
        return Err(SkeletonError::Fixed {
            fixed: held,
            nodes: nodes.len(),
        });
    }
    let springs = graph::edges(&places, &fixed, distance)
        .into_iter()
        .map(|(a, b)| {
            let region = options.region(&frame.share(&((places[a] + places[b]) * 0.5)));
            Spring {
                a: a as u16,
                b: b as u16,
                stiffness: options.stiffness_n_per_mm.map(|k| k * 1e3 * region),
                coupling: [0.0; 3],
            }
        })
        .collect();
    let made = SkeletonLevel {
        skin: all
            .iter()
            .map(|node| skin::skin(&node.centre, &places))
            .collect(),
        params: SkeletonParams {
            mass: options.density_g_per_cm3 * 1e3 * distance.mesh().signed_volume()
                / nodes.len() as f64,
            damping: options.damping_n_s_per_m,
            law: StretchLaw {
                limit: options.stretch_limit,
                half: options.stretch_half,
            },
        },
        nodes,
        fixed,
        springs,
    };
    match made.lost() {
        Some(node) => Err(SkeletonError::Isolated {
            level,
            node,
            at_mm: (places[node] * 1e3).into(),
        }),
        None => Ok(made),
    }
}
