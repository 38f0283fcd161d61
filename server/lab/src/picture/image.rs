//! A picture as rows of pixels, and as PNG.

use std::io;

/// Rows of sRGB pixels.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Image {
    /// Pixels.
    pub(crate) width: usize,
    /// Pixels.
    pub(crate) height: usize,
    bytes: Vec<u8>,
}

impl Image {
    pub(crate) fn white(width: usize, height: usize) -> Self {
        Self {
            width,
            height,
            bytes: vec![255; 3 * width * height],
        }
    }

    pub(crate) fn set(&mut self, x: usize, y: usize, colour: [u8; 3]) {
        let at = 3 * (y * self.width + x);
        self.bytes[at..at + 3].copy_from_slice(&colour);
    }

    /// Fills a box whose upper left corner is at (x, y); what is beyond the picture is left out.
    pub(crate) fn fill(
        &mut self,
        (x, y): (usize, usize),
        (width, height): (usize, usize),
        colour: [u8; 3],
    ) {
        for row in y..(y + height).min(self.height) {
            for column in x..(x + width).min(self.width) {
                self.set(column, row, colour);
            }
        }
    }

    /// Puts another picture in, its upper left corner at (x, y); what is beyond this one is left out.
    pub(crate) fn paste(&mut self, other: &Self, (x, y): (usize, usize)) {
        for row in 0..other.height.min(self.height.saturating_sub(y)) {
            for column in 0..other.width.min(self.width.saturating_sub(x)) {
                self.set(x + column, y + row, other.at(column, row));
            }
        }
    }

    /// Colour of a pixel.
    pub(crate) fn at(&self, x: usize, y: usize) -> [u8; 3] {
        let at = 3 * (y * self.width + x);
        [self.bytes[at], self.bytes[at + 1], self.bytes[at + 2]]
    }

    /// The bytes of a PNG file.
    ///
    /// # Errors
    /// Never in practice: memory is written to.
    pub(crate) fn to_png(&self) -> io::Result<Vec<u8>> {
        let mut file = Vec::new();
        let mut encoder = png::Encoder::new(&mut file, self.width as u32, self.height as u32);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_depth(png::BitDepth::Eight);
        let mut writer = encoder.write_header()?;
        writer.write_image_data(&self.bytes)?;
        writer.finish()?;
        Ok(file)
    }
}

/// A file as an address that holds it (RFC 2397), in base 64 (RFC 4648).
pub(crate) fn data_uri(kind: &str, bytes: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = format!("data:{kind};base64,");
    for three in bytes.chunks(3) {
        let at = |k: usize| u32::from(three.get(k).copied().unwrap_or(0));
        let bits = (at(0) << 16) | (at(1) << 8) | at(2);
        for k in 0..4 {
            text.push(if k > three.len() {
                '='
            } else {
                DIGITS[(bits >> (18 - 6 * k)) as usize & 63] as char
            });
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_png_comes_back_as_it_was() {
        let mut image = Image::white(5, 3);
        image.set(4, 2, [1, 2, 3]);
        let file = image.to_png().expect("a PNG");
        let decoder = png::Decoder::new(io::Cursor::new(&file));
        let mut reader = decoder.read_info().expect("a PNG");
        let mut bytes = vec![0; reader.output_buffer_size().expect("small")];
        reader.next_frame(&mut bytes).expect("a picture");
        assert_eq!(bytes, image.bytes);
    }

    #[test]
    fn base_64_as_the_standard_has_it() {
        for (plain, coded) in [
            ("", ""),
            ("f", "Zg=="),
            ("fo", "Zm8="),
            ("foo", "Zm9v"),
            ("foobar", "Zm9vYmFy"),
        ] {
            assert_eq!(
                data_uri("x/y", plain.as_bytes()),
                format!("data:x/y;base64,{coded}")
            );
        }
    }
}
