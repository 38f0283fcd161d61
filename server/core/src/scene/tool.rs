//! Tool in a hand: sphere tree, bands of a probe, display mesh.

use serde::{Deserialize, Serialize};

use crate::math::{Pose, Vec3};
use crate::tree::SphereTree;

/// Triangle mesh for display only; the tick never reads the mesh.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct DisplayMesh {
    /// Vertices, metres: in the tool's frame for a tool, in world axes at rest for an object.
    pub vertices: Vec<[f32; 3]>,
    /// Triangles as vertex indices; the outward normal follows the right-hand rule.
    pub triangles: Vec<[u32; 3]>,
    /// Colour of the whole mesh, sRGB with alpha.
    pub colour: [u8; 4],
    /// Colours of the vertices, sRGB with alpha: one per vertex, or none for a mesh of one colour. A triangle
    /// interpolates the colours of its corners.
    pub vertex_colours: Vec<[u8; 4]>,
}

/// Band on a periodontal probe, measured from the tip along the probe.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Band {
    /// Start of the band, metres from the tip.
    pub from: f64,
    /// End of the band, metres from the tip.
    pub to: f64,
    /// Whether the band is dark.
    pub dark: bool,
}

/// Tool in a hand. The origin of its frame is the device point, at which the device holds the tool.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Tool {
    /// Name for display.
    pub name: String,
    /// Sphere tree, in the tool's frame, metres.
    pub tree: SphereTree,
    /// Level of the tree in contact; 0 is the root.
    pub level: u8,
    /// Reference point of the optimisation: the working end, in the tool's frame, metres.
    pub working_point: Vec3,
    /// Outermost point of the tip, in the tool's frame, metres.
    pub tip: Vec3,
    /// Unit vector along the working end, pointing out of the tip, in the tool's frame.
    pub tip_axis: Vec3,
    /// Coupling stiffness in translation `k_t`, N/m, range 1 to 1e5. Default 500; the paper's limit for a Phantom
    /// Premium is 900.
    pub stiffness_n_per_m: f64,
    /// Coupling stiffness in rotation `k_r`, N m/rad, range 1e-4 to 1e3. Default 0.5 for a probe.
    pub stiffness_nm_per_rad: f64,
    /// Pose of the graphic tool before its first entry, outside all objects: `world_from_tool`.
    pub park: Pose,
    /// Bands of a probe; empty for other tools.
    pub bands: Vec<Band>,
    /// Display mesh, in the tool's frame, metres.
    pub mesh: DisplayMesh,
}
