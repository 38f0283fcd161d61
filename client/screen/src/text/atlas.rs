//! Image of glyphs for upload to a graphics adapter: one byte of coverage per texel, and a rectangle per glyph.

use std::collections::{BTreeMap, BTreeSet};

use super::glyph::{self, Raster, Weight};

/// Width of the image, texels: within the limits of every adapter.
const WIDTH: u32 = 512;
/// Distance between two glyphs, texels. Bilinear sampling at a border reads no other glyph.
const GAP: u32 = 1;
/// Side of the white square, texels.
const WHITE: u32 = 4;

/// Key of a glyph in the image.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct GlyphKey {
    /// Height of the glyph.
    pub raster: Raster,
    /// Weight of the glyph.
    pub weight: Weight,
    /// Character.
    pub c: char,
}

/// Rectangle in the image, texels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AtlasRect {
    /// Top left corner.
    pub at: [u32; 2],
    /// Width and height.
    pub size: [u32; 2],
}

/// Image of glyphs.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Atlas {
    /// Width of the image, texels.
    pub width: u32,
    /// Height of the image, texels.
    pub height: u32,
    /// Coverage row by row, 0 to 255 (R8): `width` times `height` bytes.
    pub texels: Vec<u8>,
    /// Square of full coverage, for rectangles that are drawn with the same image.
    pub white: AtlasRect,
    rects: BTreeMap<GlyphKey, AtlasRect>,
    boxes: BTreeMap<Raster, AtlasRect>,
}

impl Atlas {
    /// Image of the glyphs `used`, and of the hollow box in each height that occurs.
    ///
    /// A character that the font lacks takes no place of its own.
    pub fn new(used: &BTreeSet<GlyphKey>) -> Self {
        let mut shelf = Shelf::default();
        let white = shelf.place(WHITE, WHITE, &[255; (WHITE * WHITE) as usize]);
        let (mut rects, mut boxes) = (BTreeMap::new(), BTreeMap::new());
        // Keys ascend by height first, so that a row of the image has one height.
        for &key in used {
            let (width, height) = (key.raster.width().into(), key.raster.height().into());
            let mut place = |bytes: &[u8]| shelf.place(width, height, bytes);
            boxes
                .entry(key.raster)
                .or_insert_with(|| place(&glyph::hollow_box(key.raster)));
            if glyph::is_known(key.c) {
                rects.insert(key, place(&glyph::coverage(key.c, key.weight, key.raster)));
            }
        }
        let height = shelf.top + shelf.row;
        let mut texels = shelf.texels;
        texels.resize((WIDTH * height) as usize, 0);
        Self {
            width: WIDTH,
            height,
            texels,
            white,
            rects,
            boxes,
        }
    }

    /// Image of all Latin-1 characters in both weights and the heights `rasters`. A panel with such an image never
    /// needs another upload.
    pub fn latin(rasters: &[Raster]) -> Self {
        let letters = || (' '..='~').chain('\u{a1}'..='\u{ff}');
        let weights = |raster| Weight::ALL.map(|weight| (raster, weight));
        let styles = rasters.iter().copied().flat_map(weights);
        let keys = styles
            .flat_map(|(raster, weight)| letters().map(move |c| GlyphKey { raster, weight, c }));
        Self::new(&keys.collect())
    }

    /// Rectangle of a glyph. A missing character gives the hollow box of the height; `None`: the image lacks the
    /// height.
    pub fn rect(&self, key: GlyphKey) -> Option<AtlasRect> {
        let found = self.rects.get(&key).or_else(|| self.boxes.get(&key.raster));
        found.copied()
    }

    /// Number of glyphs without the hollow boxes.
    pub fn len(&self) -> usize {
        self.rects.len()
    }

    /// Whether the image has no glyph.
    pub fn is_empty(&self) -> bool {
        self.rects.is_empty()
    }
}

/// Image that is filled row by row.
#[derive(Default)]
struct Shelf {
    texels: Vec<u8>,
    /// Left end of the free part of the row.
    left: u32,
    /// Top of the row.
    top: u32,
    /// Height of the row with the gap.
    row: u32,
}

impl Shelf {
    fn place(&mut self, width: u32, height: u32, bytes: &[u8]) -> AtlasRect {
        if self.left + width > WIDTH {
            self.top += self.row;
            (self.left, self.row) = (0, 0);
        }
        self.row = self.row.max(height + GAP);
        let needed = (WIDTH * (self.top + self.row)) as usize;
        if self.texels.len() < needed {
            self.texels.resize(needed, 0);
        }
        for (y, line) in (self.top..).zip(bytes.chunks(width as usize)) {
            let start = (y * WIDTH + self.left) as usize;
            self.texels[start..start + line.len()].copy_from_slice(line);
        }
        let at = [self.left, self.top];
        self.left += width + GAP;
        AtlasRect {
            at,
            size: [width, height],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Bytes of the image in a rectangle.
    fn read(atlas: &Atlas, rect: AtlasRect) -> Vec<u8> {
        let rows = rect.at[1]..rect.at[1] + rect.size[1];
        let row = |y: u32| {
            let start = (y * atlas.width + rect.at[0]) as usize;
            atlas.texels[start..start + rect.size[0] as usize].to_vec()
        };
        rows.flat_map(row).collect()
    }

    #[test]
    fn every_glyph_comes_back_from_its_rectangle() {
        let atlas = Atlas::latin(&Raster::ALL);
        assert_eq!(atlas.texels.len(), (atlas.width * atlas.height) as usize);
        assert!(atlas.height <= 2048, "{}", atlas.height);
        for raster in Raster::ALL {
            for weight in Weight::ALL {
                for c in (' '..='~').chain('\u{a1}'..='\u{ff}') {
                    let key = GlyphKey { raster, weight, c };
                    let rect = atlas.rect(key).expect("in the image");
                    assert_eq!(
                        read(&atlas, rect),
                        glyph::coverage(c, weight, raster),
                        "{key:?}"
                    );
                }
            }
        }
        assert_eq!(read(&atlas, atlas.white), vec![255; 16]);
    }

    #[test]
    fn rectangles_keep_their_distance() {
        let atlas = Atlas::latin(&[Raster::Px16, Raster::Px24]);
        let mut all: Vec<AtlasRect> = atlas.rects.values().copied().collect();
        all.extend(atlas.boxes.values());
        all.push(atlas.white);
        for (k, a) in all.iter().enumerate() {
            for b in &all[k + 1..] {
                let apart = |axis: usize| {
                    a.at[axis] + a.size[axis] + GAP <= b.at[axis]
                        || b.at[axis] + b.size[axis] + GAP <= a.at[axis]
                };
                assert!(apart(0) || apart(1), "{a:?} {b:?}");
            }
        }
    }

    #[test]
    fn a_missing_character_is_a_box_and_a_missing_height_is_nothing() {
        let key = |raster, c| GlyphKey {
            raster,
            weight: Weight::Regular,
            c,
        };
        let used = BTreeSet::from([key(Raster::Px16, 'a'), key(Raster::Px16, '\u{6df1}')]);
        let atlas = Atlas::new(&used);
        assert_eq!(atlas.len(), 1);
        for c in ['\u{6df1}', 'b'] {
            let rect = atlas.rect(key(Raster::Px16, c)).expect("a box");
            assert_eq!(read(&atlas, rect), glyph::hollow_box(Raster::Px16));
        }
        assert_eq!(atlas.rect(key(Raster::Px32, 'a')), None);
        assert!(Atlas::new(&BTreeSet::new()).is_empty());
    }
}
