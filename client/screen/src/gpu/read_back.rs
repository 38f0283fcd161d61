//! Pictures in the memory of the processor.

use super::adapter::Graphics;
use crate::error::ScreenError;

/// Picture: rows of pixels from the top, sRGB with alpha.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Image {
    /// Width, pixels.
    pub width: u32,
    /// Height, pixels.
    pub height: u32,
    /// Red, green, blue and alpha of each pixel.
    pub rgba: Vec<[u8; 4]>,
}

impl Image {
    /// Colour of a pixel, counted from the upper left corner.
    pub fn at(&self, x: u32, y: u32) -> [u8; 4] {
        self.rgba[(y * self.width + x) as usize]
    }

    /// The picture as PNG.
    ///
    /// # Errors
    /// The picture cannot be encoded.
    pub fn png(&self) -> Result<Vec<u8>, ScreenError> {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, self.width, self.height);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
        let rgb: Vec<u8> = self
            .rgba
            .iter()
            .flat_map(|[r, g, b, _]| [*r, *g, *b])
            .collect();
        let mut writer = encoder.write_header()?;
        writer.write_image_data(&rgb)?;
        writer.finish()?;
        Ok(bytes)
    }
}

/// Reads a texture of four bytes for each pixel, in the order red, green, blue, alpha.
pub(super) fn read(graphics: &Graphics, texture: &wgpu::Texture) -> Result<Image, ScreenError> {
    let (width, height) = (texture.width(), texture.height());
    let row = (4 * width).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
    let buffer = graphics.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("read back"),
        size: u64::from(row) * u64::from(height),
        usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
        mapped_at_creation: false,
    });
    let mut encoder = graphics
        .device
        .create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    encoder.copy_texture_to_buffer(
        texture.as_image_copy(),
        wgpu::TexelCopyBufferInfo {
            buffer: &buffer,
            layout: wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(row),
                rows_per_image: None,
            },
        },
        texture.size(),
    );
    graphics.queue.submit([encoder.finish()]);
    let lost = |error: &dyn std::fmt::Display| ScreenError::Lost(error.to_string());
    let slice = buffer.slice(..);
    // The driver's error of the mapping arrives with the poll.
    slice.map_async(wgpu::MapMode::Read, |_| ());
    let waited = graphics.device.poll(wgpu::PollType::wait_indefinitely());
    waited.map_err(|error| lost(&error))?;
    graphics.check()?;
    let mapped = slice.get_mapped_range().map_err(|error| lost(&error))?;
    let mut rgba = Vec::with_capacity((width * height) as usize);
    for line in mapped.chunks_exact(row as usize) {
        let pixels = line[..4 * width as usize].chunks_exact(4);
        rgba.extend(pixels.map(|pixel| [pixel[0], pixel[1], pixel[2], pixel[3]]));
    }
    Ok(Image {
        width,
        height,
        rgba,
    })
}
