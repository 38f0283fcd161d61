//! Colours and finishes of instruments.
//!
//! Roughness and reflectance of steel are chosen. A screen draws vertices of a tool as metal of the given colour.

use sulcus_core::Tool;
use sulcus_proto::CodecError;
use sulcus_proto::display::{DisplayMesh, Finish};
use sulcus_scene::instruments::drawn::{DrawnTool, Steel, drawn_tool};

use super::enamel::share_255;
use crate::display::f32s;

/// Colour of a finish: steel reflects 0.56 of the light, less between ridges; black has L* 15.
fn colour(steel: Steel) -> [u8; 4] {
    match steel {
        Steel::Polished | Steel::Rim => [198, 199, 200, 255],
        Steel::Satin => [190, 191, 192, 255],
        Steel::Ridge => [186, 187, 188, 255],
        Steel::Groove => [104, 105, 107, 255],
        Steel::Black => [38, 38, 39, 255],
    }
}

/// Perceptual roughness of a finish.
fn roughness(steel: Steel) -> f64 {
    match steel {
        Steel::Rim => 0.10,
        Steel::Polished => 0.12,
        Steel::Satin => 0.28,
        Steel::Ridge | Steel::Groove => 0.40,
        Steel::Black => 0.60,
    }
}

fn finish(roughness: f64) -> Finish {
    Finish {
        roughness: share_255(roughness),
        stipple: 0,
        thin: 0,
    }
}

/// Returns the display mesh of a tool, and the radius of its glass inside the rim, metres, if that is known.
///
/// A tool that is not built-in keeps its mesh and its colours. Its dark vertices are matt.
///
/// # Errors
/// The mesh is beyond the limits of a display.
pub fn tool(tool: &Tool) -> Result<(DisplayMesh, Option<f64>), CodecError> {
    if let Some(drawn) = drawn_tool(tool) {
        return Ok((built_in(&drawn)?, drawn.glass_radius));
    }
    let mesh = &tool.mesh;
    let kept = DisplayMesh::new(
        &mesh.vertices,
        &mesh.triangles,
        mesh.colour,
        &mesh.vertex_colours,
    )?;
    let of = |k: usize| {
        let [r, g, b, _] = mesh.vertex_colours.get(k).copied().unwrap_or(mesh.colour);
        let is_dark = u32::from(r) + u32::from(g) + u32::from(b) < 3 * 64;
        let steel = if is_dark { Steel::Black } else { Steel::Satin };
        finish(roughness(steel))
    };
    let finishes = (0..kept.len()).map(of).collect();
    Ok((kept.with_finishes(finishes)?, None))
}

fn built_in(drawn: &DrawnTool) -> Result<DisplayMesh, CodecError> {
    let vertices: Vec<[f32; 3]> = drawn.mesh.vertices.iter().map(f32s).collect();
    let colours: Vec<[u8; 4]> = drawn.steel.iter().map(|steel| colour(*steel)).collect();
    let finishes = drawn.steel.iter().map(|steel| finish(roughness(*steel)));
    DisplayMesh::new(
        &vertices,
        &drawn.mesh.triangles,
        colour(Steel::Satin),
        &colours,
    )?
    .with_finishes(finishes.collect())
}
