//! The panel over a picture: quads of an atlas of glyphs.

use bytemuck::{Pod, Zeroable, cast_slice};
use wgpu::{BindGroup, Buffer, BufferUsages, RenderPipeline, TextureFormat, TextureView};

use super::buffers::empty;
use super::pipelines::{Recipe, shader};
use super::targets::{texture, view};
use crate::panel::{Primitive, quads, used};
use crate::text::Atlas;

/// Corner of a quad, as the shader reads it.
#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C)]
struct Corner {
    at: [f32; 2],
    texel: [f32; 2],
    colour: [f32; 4],
}

/// Number of corners of a quad: two triangles.
const CORNERS: u64 = 6;
/// Number of quads of the first buffer.
const QUADS: u64 = 1024;

/// Drawer of panels.
pub(super) struct PanelDrawer {
    pipeline: RenderPipeline,
    layout: wgpu::BindGroupLayout,
    size: Buffer,
    corners: Buffer,
    atlas: Option<(Atlas, BindGroup)>,
    /// Whether the target takes light, and codes it as sRGB itself.
    takes_light: bool,
}

impl PanelDrawer {
    pub fn new(device: &wgpu::Device, format: TextureFormat) -> Self {
        let visible = wgpu::ShaderStages::VERTEX_FRAGMENT;
        let entry = |binding, ty| wgpu::BindGroupLayoutEntry {
            binding,
            visibility: visible,
            ty,
            count: None,
        };
        let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("panel"),
            entries: &[
                entry(
                    0,
                    wgpu::BindingType::Buffer {
                        ty: wgpu::BufferBindingType::Uniform,
                        has_dynamic_offset: false,
                        min_binding_size: None,
                    },
                ),
                entry(
                    1,
                    wgpu::BindingType::Texture {
                        sample_type: wgpu::TextureSampleType::Float { filterable: true },
                        view_dimension: wgpu::TextureViewDimension::D2,
                        multisampled: false,
                    },
                ),
            ],
        });
        const ATTRIBUTES: [wgpu::VertexAttribute; 3] =
            wgpu::vertex_attr_array![0 => Float32x2, 1 => Float32x2, 2 => Float32x4];
        let corner = wgpu::VertexBufferLayout {
            array_stride: size_of::<Corner>() as u64,
            step_mode: wgpu::VertexStepMode::Vertex,
            attributes: &ATTRIBUTES,
        };
        let target = wgpu::ColorTargetState {
            format,
            blend: Some(wgpu::BlendState::ALPHA_BLENDING),
            write_mask: wgpu::ColorWrites::ALL,
        };
        let pipeline = Recipe {
            label: "panel",
            module: &shader(device, "panel", include_str!("panel.wgsl")),
            vertex: "vertex",
            fragment: Some(("pixel", target)),
            buffers: &[Some(corner)],
            layouts: &[Some(&layout)],
            front: wgpu::FrontFace::Ccw,
            cull: None,
            samples: 1,
            depth: false,
        }
        .pipeline(device);
        Self {
            pipeline,
            layout,
            size: empty(device, "size of the panel", BufferUsages::UNIFORM, 16),
            corners: quad_buffer(device, QUADS),
            atlas: None,
            takes_light: format.is_srgb(),
        }
    }

    /// Draws a list over the picture in `target`, which has `size` pixels.
    pub fn draw(
        &mut self,
        graphics: &super::Graphics,
        encoder: &mut wgpu::CommandEncoder,
        list: &[Primitive],
        target: &TextureView,
        size: [u32; 2],
    ) {
        let (device, queue) = (&graphics.device, &graphics.queue);
        self.provide(device, queue, list);
        let Some((atlas, group)) = &self.atlas else {
            return;
        };
        let corners: Vec<Corner> = quads(list, atlas)
            .iter()
            .flat_map(|quad| {
                let [u, v] = quad.texels.at.map(|x| x as f32);
                let [w, h] = quad.texels.size.map(|x| x as f32);
                let colour = if self.takes_light {
                    linear(quad.rgba)
                } else {
                    quad.rgba.map(|c| f32::from(c) / 255.0)
                };
                let corner = move |right: bool, low: bool| Corner {
                    at: [
                        if right { quad.max[0] } else { quad.min[0] },
                        if low { quad.max[1] } else { quad.min[1] },
                    ],
                    texel: [if right { u + w } else { u }, if low { v + h } else { v }],
                    colour,
                };
                let [a, b, c, d] = [(false, false), (true, false), (true, true), (false, true)];
                [a, b, c, a, c, d].map(|(right, low)| corner(right, low))
            })
            .collect();
        if corners.is_empty() {
            return;
        }
        let bytes: &[u8] = cast_slice(&corners);
        if bytes.len() as u64 > self.corners.size() {
            self.corners = quad_buffer(device, 2 * corners.len() as u64 / CORNERS);
        }
        let [w, h] = size.map(|n| n as f32);
        queue.write_buffer(&self.corners, 0, bytes);
        queue.write_buffer(&self.size, 0, cast_slice(&[w, h, 0.0, 0.0]));
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("panel"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: target,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Load,
                    store: wgpu::StoreOp::Store,
                },
            })],
            ..Default::default()
        });
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, group, &[]);
        pass.set_vertex_buffer(0, self.corners.slice(..));
        pass.draw(0..corners.len() as u32, 0..1);
    }

    /// Makes an atlas with all glyphs of the list, unless the present one has them.
    fn provide(&mut self, device: &wgpu::Device, queue: &wgpu::Queue, list: &[Primitive]) {
        let wanted = used(list);
        let has_all =
            |(atlas, _): &(Atlas, BindGroup)| wanted.iter().all(|key| atlas.rect(*key).is_some());
        if self.atlas.as_ref().is_some_and(has_all) {
            return;
        }
        // All Latin letters of the heights in use: the text of a gauge changes with every frame.
        let mut rasters: Vec<_> = wanted.iter().map(|key| key.raster).collect();
        rasters.dedup();
        let latin = Atlas::latin(&rasters);
        let is_enough = wanted.iter().all(|key| latin.rect(*key).is_some());
        let atlas = if is_enough {
            latin
        } else {
            Atlas::new(&wanted)
        };
        let usage = wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST;
        let size = [atlas.width, atlas.height];
        let image = texture(device, "atlas", TextureFormat::R8Unorm, size, 1, usage);
        queue.write_texture(
            image.as_image_copy(),
            &atlas.texels,
            wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(atlas.width),
                rows_per_image: None,
            },
            image.size(),
        );
        let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("panel"),
            layout: &self.layout,
            entries: &[
                wgpu::BindGroupEntry {
                    binding: 0,
                    resource: self.size.as_entire_binding(),
                },
                wgpu::BindGroupEntry {
                    binding: 1,
                    resource: wgpu::BindingResource::TextureView(&view(&image)),
                },
            ],
        });
        self.atlas = Some((atlas, group));
    }
}

fn quad_buffer(device: &wgpu::Device, quads: u64) -> Buffer {
    let bytes = quads * CORNERS * size_of::<Corner>() as u64;
    empty(device, "quads", BufferUsages::VERTEX, bytes)
}

/// Linear light of an sRGB colour with alpha.
fn linear(rgba: [u8; 4]) -> [f32; 4] {
    let [r, g, b, a] = rgba.map(|c| f32::from(c) / 255.0);
    let to_linear = |c: f32| {
        if c <= 0.04045 {
            c / 12.92
        } else {
            ((c + 0.055) / 1.055).powf(2.4)
        }
    };
    [to_linear(r), to_linear(g), to_linear(b), a]
}
