//! Drawn glyphs: coverage of one character in one height and weight.

use noto_sans_mono_bitmap::{FontWeight, RasterHeight, get_raster, get_raster_width};

/// Height of drawn glyphs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Raster {
    /// 16 px.
    Px16,
    /// 20 px.
    Px20,
    /// 24 px.
    Px24,
    /// 32 px.
    Px32,
}

impl Raster {
    /// All heights, ascending.
    pub const ALL: [Self; 4] = [Self::Px16, Self::Px20, Self::Px24, Self::Px32];

    const fn of_font(self) -> RasterHeight {
        match self {
            Self::Px16 => RasterHeight::Size16,
            Self::Px20 => RasterHeight::Size20,
            Self::Px24 => RasterHeight::Size24,
            Self::Px32 => RasterHeight::Size32,
        }
    }

    /// Height of a glyph's box, pixels.
    pub const fn height(self) -> u8 {
        self.of_font().val() as u8
    }

    /// Width of a glyph's box, pixels; the same for both weights.
    pub const fn width(self) -> u8 {
        get_raster_width(FontWeight::Regular, self.of_font()) as u8
    }
}

/// Weight of a text.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Weight {
    /// Running text.
    #[default]
    Regular,
    /// Numbers and headings.
    Bold,
}

impl Weight {
    /// Both weights.
    pub const ALL: [Self; 2] = [Self::Regular, Self::Bold];

    const fn of_font(self) -> FontWeight {
        match self {
            Self::Regular => FontWeight::Regular,
            Self::Bold => FontWeight::Bold,
        }
    }
}

/// Whether the font has a glyph for `c`.
pub fn is_known(c: char) -> bool {
    get_raster(c, FontWeight::Regular, RasterHeight::Size16).is_some()
}

/// Coverage of `c`, row by row from the top left, 0 to 255: [`Raster::height`] rows of [`Raster::width`] bytes.
///
/// A character that the font lacks gives [`hollow_box`].
pub fn coverage(c: char, weight: Weight, raster: Raster) -> Vec<u8> {
    match get_raster(c, weight.of_font(), raster.of_font()) {
        Some(drawn) => drawn
            .raster()
            .iter()
            .flat_map(|row| row.iter().copied())
            .collect(),
        None => hollow_box(raster),
    }
}

/// Glyph of all characters that the font lacks: a box with an empty middle, as high as a capital letter.
pub fn hollow_box(raster: Raster) -> Vec<u8> {
    let (width, height) = (usize::from(raster.width()), usize::from(raster.height()));
    let (left, right) = (1, width - 2);
    let (top, bottom) = (height / 5, height - height / 5);
    let mut bytes = vec![0; width * height];
    for y in top..=bottom {
        for x in left..=right {
            if y == top || y == bottom || x == left || x == right {
                bytes[y * width + x] = 255;
            }
        }
    }
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_glyphs_of_a_height_fill_the_same_box() {
        for raster in Raster::ALL {
            let area = usize::from(raster.width()) * usize::from(raster.height());
            for weight in Weight::ALL {
                let width = get_raster_width(weight.of_font(), raster.of_font());
                assert_eq!(width, usize::from(raster.width()));
                for c in (' '..='~').chain('\u{a1}'..='\u{ff}').chain(['\u{6df1}']) {
                    assert_eq!(coverage(c, weight, raster).len(), area, "{c:?}");
                }
            }
        }
    }

    #[test]
    fn what_the_font_lacks_is_a_box_and_what_german_and_spanish_need_is_not() {
        for c in ['\u{6df1}', '\u{2026}', '\u{0}'] {
            assert!(!is_known(c), "{c:?}");
            assert_eq!(
                coverage(c, Weight::Bold, Raster::Px24),
                hollow_box(Raster::Px24)
            );
        }
        for c in "ÄÖÜäöüßñÑáéíóú¿¡µ°±".chars() {
            assert!(is_known(c), "{c}");
            assert_ne!(
                coverage(c, Weight::Regular, Raster::Px16),
                hollow_box(Raster::Px16),
                "{c}"
            );
        }
        let inked = |bytes: &[u8]| bytes.iter().filter(|byte| **byte > 0).count();
        assert!(inked(&hollow_box(Raster::Px16)) > 20);
        assert_eq!(inked(&coverage(' ', Weight::Regular, Raster::Px16)), 0);
    }
}
