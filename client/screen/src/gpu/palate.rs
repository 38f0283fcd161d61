//! Upper jaw in reflections: a mirror before the lower teeth shows palate and upper teeth behind them.

use wgpu::{ColorTargetState, Device, FrontFace, RenderPipeline};

use super::pipelines::{Layouts, Recipe, shader};

/// Corners of the mesh. The shader makes all vertices, and counts the same teeth, columns and rows.
pub(super) const CORNERS: u32 = 6 * (2 * 9 * 4) * 10;

/// Pipeline for a reflection, whose pictures have one sample.
pub(super) fn pipeline(
    device: &Device,
    layouts: &Layouts,
    target: &ColorTargetState,
) -> RenderPipeline {
    let source = concat!(include_str!("scene.wgsl"), include_str!("palate.wgsl"));
    Recipe {
        label: "palate",
        module: &shader(device, "palate", source),
        vertex: "palate_vertex",
        fragment: Some(("palate_pixel", target.clone())),
        buffers: &[],
        layouts: &[Some(&layouts.pass)],
        front: FrontFace::Ccw,
        // The outer side of the gum is seen from the cheek, the inner one from the tongue.
        cull: None,
        samples: 1,
        depth: true,
    }
    .pipeline(device)
}
