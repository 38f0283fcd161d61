//! What a hand holds: tool, bands of a probe, mesh to look at.

use serde::{Deserialize, Serialize};

use crate::math::{Pose, Vec3};
use crate::tree::SphereTree;

/// A triangle mesh to look at; the tick never reads it.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct DisplayMesh {
    /// Vertices in the object's frame, metres.
    pub vertices: Vec<[f32; 3]>,
    /// Triangles as vertex indices, outward by the right hand.
    pub triangles: Vec<[u32; 3]>,
    /// Colour of the whole mesh, sRGB with alpha.
    pub colour: [u8; 4],
    /// Colours of the vertices, where they differ: one each, or none. A triangle's colour runs smoothly between its corners'.
    pub vertex_colours: Vec<[u8; 4]>,
}

/// A band on a periodontal probe, measured from the tip.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Band {
    /// Where the band begins, metres from the tip.
    pub from: f64,
    /// Where it ends.
    pub to: f64,
    /// Whether it is dark.
    pub dark: bool,
}

/// A tool held by a hand. Its frame's origin is the device point (where the device holds it).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Tool {
    /// Name, for people.
    pub name: String,
    /// Spheres that touch, in the tool's frame.
    pub tree: SphereTree,
    /// Level of the tree in contact unless the input says otherwise.
    pub level: u8,
    /// Reference point of the optimisation: the working end, in the tool's frame, metres.
    pub working_point: Vec3,
    /// Very tip, in the tool's frame, metres.
    pub tip: Vec3,
    /// Unit vector along the working end, pointing out of the tip, in the tool's frame.
    pub tip_axis: Vec3,
    /// Coupling stiffness in translation `k_t`, N/m. Default 500 (the paper's limit for a
    /// Phantom Premium: 900).
    pub stiffness_n_per_m: f64,
    /// Coupling stiffness in rotation `k_r`, N m/rad. Default 0.5 for a probe.
    pub stiffness_nm_per_rad: f64,
    /// Where the graphic tool waits before its first entry, outside everything: `world_from_tool`.
    pub park: Pose,
    /// Bands of a probe; empty for other tools.
    pub bands: Vec<Band>,
    /// To look at.
    pub mesh: DisplayMesh,
}
