//! Text of the screen: sizes of glyphs, width of a line, wrapped lines, and an image of all glyphs.
//!
//! The font is Noto Sans Mono (SIL Open Font License), drawn beforehand in four heights. All glyphs of a height have
//! the same width. The font covers Latin-1: English, German, Spanish and French. Another character, such as a Chinese
//! one, is drawn as a hollow box and needs another font in [`glyph`] and [`atlas`].

pub mod atlas;
pub mod glyph;
mod wrap;

pub use atlas::{Atlas, AtlasRect, GlyphKey};
pub use glyph::{Raster, Weight};
pub use wrap::{fit, wrap};

/// Largest whole factor by which a drawn glyph is enlarged.
const MOST_TIMES: u8 = 4;

/// Size of a text: height of the drawn glyphs, and the whole factor of their enlargement on the screen.
///
/// A whole factor keeps the edges of glyphs sharp on displays of high density.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct TextSize {
    /// Drawn glyphs.
    pub raster: Raster,
    /// Factor of enlargement, 1 to 4.
    pub times: u8,
}

impl TextSize {
    /// Smallest size, 16 px.
    pub const SMALLEST: Self = Self {
        raster: Raster::Px16,
        times: 1,
    };

    /// Largest size of at most `height` physical pixels. A smaller height, or NaN, gives [`TextSize::SMALLEST`].
    ///
    /// Of two equal heights the one with the smaller factor is chosen, because its glyphs have more detail.
    pub fn at_most(height: f32) -> Self {
        let mut best = Self::SMALLEST;
        for times in 1..=MOST_TIMES {
            for raster in Raster::ALL {
                let size = Self { raster, times };
                if size.height() <= height && size.height() > best.height() {
                    best = size;
                }
            }
        }
        best
    }

    /// Height of a line without leading, pixels.
    pub fn height(self) -> f32 {
        f32::from(self.raster.height()) * f32::from(self.times)
    }

    /// Width of one character, pixels.
    pub fn advance(self) -> f32 {
        f32::from(self.raster.width()) * f32::from(self.times)
    }

    /// Width and height of a line of text, pixels.
    pub fn measure(self, text: &str) -> [f32; 2] {
        [self.advance() * text.chars().count() as f32, self.height()]
    }

    /// Number of characters that fit into a width of `pixels`; 0 for a negative width or NaN.
    pub fn columns(self, pixels: f32) -> usize {
        // The conversion limits to the range of the integer, and NaN becomes 0.
        (pixels / self.advance()).floor() as usize
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_follow_the_height_without_exceeding_it() {
        let mut before = 0.0;
        for height in 0..400 {
            let height = height as f32;
            let size = TextSize::at_most(height);
            assert!(size.height() <= height.max(16.0), "{height}");
            assert!(size.height() >= before, "{height}");
            assert!((1..=MOST_TIMES).contains(&size.times));
            before = size.height();
        }
        let px = |height| TextSize::at_most(height).height();
        assert_eq!(
            [px(19.9), px(24.0), px(39.0), px(48.0)],
            [16.0, 24.0, 32.0, 48.0]
        );
        assert_eq!(px(128.0), 128.0);
        assert_eq!(TextSize::at_most(32.0).times, 1, "of 16 twice and 32 once");
        assert_eq!(TextSize::at_most(f32::NAN), TextSize::SMALLEST);
        assert_eq!(TextSize::at_most(-1.0), TextSize::SMALLEST);
    }

    #[test]
    fn a_line_is_as_wide_as_its_characters_not_its_bytes() {
        let size = TextSize::at_most(24.0);
        assert_eq!(size.measure("für"), size.measure("fur"));
        assert_eq!(size.measure(""), [0.0, 24.0]);
        let text = "0.22 N";
        let [width, _] = size.measure(text);
        assert_eq!(size.columns(width), text.len());
        assert_eq!(size.columns(width - 1.0), text.len() - 1);
        assert_eq!(size.columns(-5.0), 0);
        assert_eq!(size.columns(f32::NAN), 0);
    }
}
