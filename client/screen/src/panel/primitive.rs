//! Primitives of the panel: rectangles and lines of text in physical pixels, from the top left of the window.

use std::collections::BTreeSet;

use super::colour::Rgba;
use crate::text::{Atlas, AtlasRect, GlyphKey, TextSize, Weight};

/// Primitive. Later primitives of a list cover earlier ones.
#[derive(Clone, Debug, PartialEq)]
pub enum Primitive {
    /// Filled rectangle.
    Rect {
        /// Top left corner, pixels.
        min: [f32; 2],
        /// Bottom right corner, pixels.
        max: [f32; 2],
        /// Colour.
        rgba: Rgba,
    },
    /// Line of text.
    Glyphs {
        /// Top left corner of the first character's box, pixels.
        at: [f32; 2],
        /// Size of the text.
        size: TextSize,
        /// Weight of the text.
        weight: Weight,
        /// Characters, left to right.
        text: String,
        /// Colour.
        rgba: Rgba,
    },
}

impl Primitive {
    /// Top left and bottom right corner, pixels.
    pub fn bounds(&self) -> [[f32; 2]; 2] {
        match self {
            Self::Rect { min, max, .. } => [*min, *max],
            Self::Glyphs { at, size, text, .. } => {
                let [width, height] = size.measure(text);
                [*at, [at[0] + width, at[1] + height]]
            }
        }
    }
}

/// Glyphs that a list needs, for an [`Atlas`].
pub fn used(list: &[Primitive]) -> BTreeSet<GlyphKey> {
    let mut keys = BTreeSet::new();
    for one in list {
        if let Primitive::Glyphs {
            size, weight, text, ..
        } = one
        {
            let (raster, weight) = (size.raster, *weight);
            keys.extend(text.chars().map(|c| GlyphKey { raster, weight, c }));
        }
    }
    keys
}

/// Rectangle on the screen that a rectangle of an [`Atlas`] covers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quad {
    /// Top left corner on the screen, pixels.
    pub min: [f32; 2],
    /// Bottom right corner on the screen, pixels.
    pub max: [f32; 2],
    /// Place of the coverage in the atlas, texels.
    pub texels: AtlasRect,
    /// Colour.
    pub rgba: Rgba,
}

/// Quads of a list, in its order. Blanks have none. A height that the atlas lacks has none.
pub fn quads(list: &[Primitive], atlas: &Atlas) -> Vec<Quad> {
    let mut quads = Vec::new();
    for one in list {
        match one {
            Primitive::Rect { min, max, rgba } => quads.push(Quad {
                min: *min,
                max: *max,
                texels: atlas.white,
                rgba: *rgba,
            }),
            Primitive::Glyphs {
                at,
                size,
                weight,
                text,
                rgba,
            } => {
                let (raster, weight) = (size.raster, *weight);
                for (k, c) in text.chars().enumerate().filter(|(_, c)| *c != ' ') {
                    let Some(texels) = atlas.rect(GlyphKey { raster, weight, c }) else {
                        continue;
                    };
                    let min = [at[0] + k as f32 * size.advance(), at[1]];
                    let max = [min[0] + size.advance(), min[1] + size.height()];
                    let rgba = *rgba;
                    quads.push(Quad {
                        min,
                        max,
                        texels,
                        rgba,
                    });
                }
            }
        }
    }
    quads
}

#[cfg(test)]
mod tests {
    use super::super::colour::{BLACK, WHITE};
    use super::*;

    #[test]
    fn a_list_becomes_quads_of_its_own_atlas() {
        let size = TextSize::at_most(48.0);
        let text = Primitive::Glyphs {
            at: [10.0, 20.0],
            size,
            weight: Weight::Bold,
            text: "3 \u{6df1}".into(),
            rgba: BLACK,
        };
        let ground = Primitive::Rect {
            min: [0.0, 0.0],
            max: [90.0, 80.0],
            rgba: WHITE,
        };
        let list = [ground, text];
        let keys = used(&list);
        assert_eq!(keys.len(), 3);
        let atlas = Atlas::new(&keys);
        let quads = quads(&list, &atlas);
        assert_eq!(quads.len(), 3, "the blank has no quad");
        assert_eq!((quads[0].texels, quads[0].max), (atlas.white, [90.0, 80.0]));
        assert_eq!(
            (quads[1].min, quads[1].max),
            ([10.0, 20.0], [10.0 + size.advance(), 68.0])
        );
        assert_eq!(quads[2].min[0], 10.0 + 2.0 * size.advance());
        // 24 px, twice as large.
        assert_eq!(quads[1].texels.size, [11, 24]);
        assert_eq!(list[1].bounds()[1], [10.0 + 3.0 * size.advance(), 68.0]);
    }
}
