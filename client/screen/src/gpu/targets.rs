//! Textures that passes draw into.

use wgpu::{Device, Texture, TextureFormat, TextureUsages, TextureView};

/// Format of all depth textures.
pub(super) const DEPTH: TextureFormat = TextureFormat::Depth32Float;
/// Edges of the textures of a reflection, texels. A software adapter pays for clearing a texture that is too large.
pub(super) const REFLECTION: [u32; 3] = [256, 512, 768];

/// Textures of a picture of one size.
pub(super) struct Targets {
    pub size: [u32; 2],
    /// Samples of the picture before they are resolved; `None` for one sample.
    pub samples: Option<TextureView>,
    pub depth: TextureView,
}

impl Targets {
    pub fn new(device: &Device, format: TextureFormat, size: [u32; 2], samples: u32) -> Self {
        let usage = TextureUsages::RENDER_ATTACHMENT;
        let many = (samples > 1).then(|| texture(device, "samples", format, size, samples, usage));
        Self {
            size,
            samples: many.as_ref().map(view),
            depth: view(&texture(device, "depth", DEPTH, size, samples, usage)),
        }
    }
}

/// Textures of the reflection in one glass, of one size.
pub(super) struct Reflection {
    pub picture: TextureView,
    pub depth: TextureView,
}

impl Reflection {
    pub fn new(device: &Device, format: TextureFormat, edge: u32) -> Self {
        let (size, usage) = ([edge; 2], TextureUsages::RENDER_ATTACHMENT);
        let both = usage | TextureUsages::TEXTURE_BINDING;
        Self {
            picture: view(&texture(device, "reflection", format, size, 1, both)),
            depth: view(&texture(
                device,
                "depth of the reflection",
                DEPTH,
                size,
                1,
                usage,
            )),
        }
    }
}

/// Shadow map of an edge in texels.
pub(super) fn shadow_map(device: &Device, edge: u32) -> TextureView {
    let usage = TextureUsages::RENDER_ATTACHMENT | TextureUsages::TEXTURE_BINDING;
    view(&texture(
        device,
        "shadows",
        DEPTH,
        [edge.max(1); 2],
        1,
        usage,
    ))
}

pub(super) fn texture(
    device: &Device,
    label: &str,
    format: TextureFormat,
    [width, height]: [u32; 2],
    sample_count: u32,
    usage: TextureUsages,
) -> Texture {
    device.create_texture(&wgpu::TextureDescriptor {
        label: Some(label),
        size: wgpu::Extent3d {
            width,
            height,
            depth_or_array_layers: 1,
        },
        mip_level_count: 1,
        sample_count,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage,
        view_formats: &[],
    })
}

pub(super) fn view(texture: &Texture) -> TextureView {
    texture.create_view(&wgpu::TextureViewDescriptor::default())
}
