//! The built-in instruments as a display draws them: handles with knurled grips, and a finish for each vertex.
//!
//! Disc, working end and shank have the surface of the display mesh in the compiled scene. Only the handle, which
//! touches nothing, has another form.

mod grip;
mod mirror;
mod probe;
mod turned;

use sulcus_core::Tool;

use super::{Marking, Mirror, Probe};
use crate::mesh::TriMesh;

/// Finish of the steel at a vertex.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Steel {
    /// Polished steel of the working end and of the shank.
    Polished,
    /// Satin steel of the handle and of a mirror's back.
    Satin,
    /// Ridge of a knurled grip.
    Ridge,
    /// Bottom between two ridges of a grip.
    Groove,
    /// Bright rim of a mirror.
    Rim,
    /// Matt black of a probe's bands and lines.
    Black,
}

/// Instrument for a display.
#[derive(Clone, Debug, PartialEq)]
pub struct DrawnTool {
    /// Surface, tool frame, metres. Edges with two finishes or a crease have two vertices in one place.
    pub mesh: TriMesh,
    /// Finish of each vertex.
    pub steel: Vec<Steel>,
    /// Radius of a mirror's glass inside its rim, metres; `None` for a probe.
    pub glass_radius: Option<f64>,
}

/// Returns the drawn instrument of a compiled tool; `None` unless the tool is a built-in one of the usual sizes.
///
/// A tool is known by its bands, its tip and its whole display mesh.
pub fn drawn_tool(tool: &Tool) -> Option<DrawnTool> {
    let colour = tool.mesh.colour;
    for marking in Marking::ALL {
        let probe = Probe {
            marking,
            ..Probe::default()
        };
        let ends = (probe.tip(), probe.tip_axis(), probe.bands());
        if ends == (tool.tip, tool.tip_axis, tool.bands.clone())
            && probe.display(colour) == tool.mesh
        {
            return Some(probe.drawn());
        }
    }
    for number in [4, 5] {
        let mirror = Mirror {
            number,
            ..Mirror::default()
        };
        let ends = (mirror.tip(), mirror.tip_axis());
        if ends == (tool.tip, tool.tip_axis)
            && tool.bands.is_empty()
            && mirror.display_mesh().to_display(colour) == tool.mesh
        {
            return Some(mirror.drawn());
        }
    }
    None
}

#[cfg(test)]
mod tests;
