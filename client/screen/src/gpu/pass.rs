//! Blocks of constants and the begin of a pass.

use wgpu::{Buffer, RenderPass, TextureView};

use super::uniforms::STRIDE;

/// Blocks of constants, one every [`STRIDE`] bytes.
#[derive(Default)]
pub(super) struct Blocks(Vec<u8>);

impl Blocks {
    /// All blocks.
    pub fn bytes(&self) -> &[u8] {
        &self.0
    }

    /// Writes a block.
    pub fn put<T: bytemuck::Pod>(&mut self, number: usize, block: &T) {
        let bytes = bytemuck::bytes_of(block);
        let begin = STRIDE as usize * number;
        self.0.resize(begin + STRIDE as usize, 0);
        self.0[begin..begin + bytes.len()].copy_from_slice(bytes);
    }
}

/// Offset of a block, bytes.
pub(super) fn offset(block: usize) -> u32 {
    (STRIDE * block as u64) as u32
}

/// Entry of a bind group.
pub(super) fn entry(binding: u32, resource: wgpu::BindingResource<'_>) -> wgpu::BindGroupEntry<'_> {
    wgpu::BindGroupEntry { binding, resource }
}

/// Block of a buffer of blocks; the offset is given with each use.
pub(super) fn constants(buffer: &Buffer) -> wgpu::BindingResource<'_> {
    wgpu::BindingResource::Buffer(wgpu::BufferBinding {
        buffer,
        offset: 0,
        size: std::num::NonZeroU64::new(STRIDE),
    })
}

/// Begins a pass that clears its targets: colour with an optional resolve target, and depth.
pub(super) fn begin<'e>(
    encoder: &'e mut wgpu::CommandEncoder,
    colour: Option<(&TextureView, Option<&TextureView>)>,
    depth: &TextureView,
    clear: wgpu::Color,
) -> RenderPass<'e> {
    let colour = colour.map(|(view, resolve_target)| {
        Some(wgpu::RenderPassColorAttachment {
            view,
            depth_slice: None,
            resolve_target,
            ops: wgpu::Operations {
                load: wgpu::LoadOp::Clear(clear),
                store: wgpu::StoreOp::Store,
            },
        })
    });
    encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: None,
        color_attachments: colour.as_slice(),
        depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
            view: depth,
            depth_ops: Some(wgpu::Operations {
                load: wgpu::LoadOp::Clear(1.0),
                store: wgpu::StoreOp::Store,
            }),
            stencil_ops: None,
        }),
        ..Default::default()
    })
}
