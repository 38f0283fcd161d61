//! Areas of the window, and primitives that stay inside their area.

use super::colour::Rgba;
use super::primitive::Primitive;
use crate::text::{TextSize, Weight, fit, wrap};

/// Rectangle of whole pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Area {
    /// Top left corner.
    pub min: [f32; 2],
    /// Bottom right corner.
    pub max: [f32; 2],
}

impl Area {
    /// Width, pixels.
    pub fn width(&self) -> f32 {
        self.max[0] - self.min[0]
    }

    /// Height, pixels.
    pub fn height(&self) -> f32 {
        self.max[1] - self.min[1]
    }

    /// Takes a row of `height` off the top; `None`: there is no room, and nothing is taken.
    pub fn cut_top(&mut self, height: f32) -> Option<Self> {
        let y = self.min[1] + height.floor();
        (y <= self.max[1]).then(|| {
            let cut = Self {
                max: [self.max[0], y],
                ..*self
            };
            self.min[1] = y;
            cut
        })
    }

    /// Takes a row of `height` off the bottom; `None`: there is no room, and nothing is taken.
    pub fn cut_bottom(&mut self, height: f32) -> Option<Self> {
        let y = self.max[1] - height.floor();
        (y >= self.min[1]).then(|| {
            let cut = Self {
                min: [self.min[0], y],
                ..*self
            };
            self.max[1] = y;
            cut
        })
    }

    /// Takes a column of `width` off the left; `None`: there is no room, and nothing is taken.
    pub fn cut_left(&mut self, width: f32) -> Option<Self> {
        let x = self.min[0] + width.floor();
        (x <= self.max[0]).then(|| {
            let cut = Self {
                max: [x, self.max[1]],
                ..*self
            };
            self.min[0] = x;
            cut
        })
    }

    /// Takes a column of `width` off the right; `None`: there is no room, and nothing is taken.
    pub fn cut_right(&mut self, width: f32) -> Option<Self> {
        let x = self.max[0] - width.floor();
        (x >= self.min[0]).then(|| {
            let cut = Self {
                min: [x, self.min[1]],
                ..*self
            };
            self.max[0] = x;
            cut
        })
    }

    /// The area without a border of `by` pixels; empty if the border fills the area.
    pub fn inset(self, by: f32) -> Self {
        let by = by.floor();
        let along = |k: usize| by.min((0.5 * (self.max[k] - self.min[k])).floor());
        let (x, y) = (along(0), along(1));
        Self {
            min: [self.min[0] + x, self.min[1] + y],
            max: [self.max[0] - x, self.max[1] - y],
        }
    }
}

/// Sizes of a layout, pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Metrics {
    /// Size of the text.
    pub size: TextSize,
    /// Height of a row of text with leading.
    pub row: f32,
    /// Border of a block.
    pub pad: f32,
}

impl Metrics {
    /// Sizes for a window of `width` and `height` physical pixels at a display's scale factor.
    ///
    /// Text is 16 px times the scale factor, and at least 1/36 of the window's height: a large window is seen from a
    /// distance. At most 1/22 of the height and 1/40 of the width leave room for all rows.
    pub fn of([width, height]: [u32; 2], scale: f32) -> Self {
        let (width, height) = (width as f32, height as f32);
        let wanted = (16.0 * scale).max(height / 36.0);
        let size = TextSize::at_most(wanted.min(height / 22.0).min(width / 40.0));
        Self {
            size,
            row: (1.25 * size.height()).floor(),
            pad: (0.5 * size.height()).floor(),
        }
    }
}

/// List of primitives that grows.
#[derive(Clone, Debug)]
pub struct Canvas {
    /// Primitives so far.
    pub list: Vec<Primitive>,
    /// Sizes.
    pub metrics: Metrics,
}

impl Canvas {
    /// Empty canvas of a window of `window` physical pixels on a display with the scale factor `scale`, and the area of
    /// the whole window.
    pub fn over(window: [u32; 2], scale: f32) -> (Self, Area) {
        let canvas = Self {
            list: Vec::new(),
            metrics: Metrics::of(window, scale),
        };
        let whole = Area {
            min: [0.0; 2],
            max: window.map(|pixels| pixels as f32),
        };
        (canvas, whole)
    }

    /// Adds a filled rectangle. An empty one is left out.
    pub fn rect(&mut self, area: Area, rgba: Rgba) {
        let Area { min, max } = area;
        if min[0] < max[0] && min[1] < max[1] {
            self.list.push(Primitive::Rect { min, max, rgba });
        }
    }

    /// Adds a line of text at the left of a row, shortened to the row. A row that is too low gets none. Returns the
    /// width of the line.
    pub fn text(&mut self, row: Area, text: &str, weight: Weight, rgba: Rgba) -> f32 {
        let size = self.metrics.size;
        let text = fit(text, size.columns(row.width()));
        if text.is_empty() || row.height() < size.height() {
            return 0.0;
        }
        let [width, height] = size.measure(&text);
        let y = row.min[1] + (0.5 * (row.height() - height)).floor();
        let at = [row.min[0], y];
        self.list.push(Primitive::Glyphs {
            at,
            size,
            weight,
            text,
            rgba,
        });
        width
    }

    /// Adds a row with a text, off the top of `rows`. Without room nothing is added.
    pub fn line(&mut self, rows: &mut Area, text: &str, weight: Weight, rgba: Rgba) {
        if let Some(row) = rows.cut_top(self.metrics.row) {
            self.text(row, text, weight, rgba);
        }
    }

    /// Adds a text in at most `most` rows, off the top of `rows`, as far as there is room.
    pub fn paragraph(
        &mut self,
        rows: &mut Area,
        text: &str,
        most: usize,
        weight: Weight,
        rgba: Rgba,
    ) {
        let room = (rows.height() / self.metrics.row).floor() as usize;
        let columns = self.metrics.size.columns(rows.width());
        for line in wrap(text, columns, most.min(room)) {
            self.line(rows, &line, weight, rgba);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cuts_divide_an_area_and_refuse_what_does_not_fit() {
        let whole = Area {
            min: [0.0, 0.0],
            max: [100.0, 50.0],
        };
        let mut rest = whole;
        let top = rest.cut_top(20.7).expect("room");
        let right = rest.cut_right(30.0).expect("room");
        assert_eq!(
            (top.height(), right.width(), right.height()),
            (20.0, 30.0, 30.0)
        );
        assert_eq!((rest.width(), rest.height()), (70.0, 30.0));
        let before = rest;
        assert_eq!((rest.cut_bottom(31.0), rest.cut_left(71.0)), (None, None));
        assert_eq!(rest, before);
        let nothing = whole.inset(80.0);
        assert_eq!((nothing.width(), nothing.height()), (0.0, 0.0));
    }

    #[test]
    fn text_grows_with_the_display_as_far_as_rows_fit() {
        let height = |window, scale| Metrics::of(window, scale).size.height();
        assert_eq!(height([640, 360], 1.0), 16.0);
        assert_eq!(height([640, 360], 3.0), 16.0);
        assert_eq!(height([1280, 720], 1.5), 24.0);
        assert_eq!(height([1920, 1080], 1.0), 24.0);
        assert_eq!(height([1280, 720], 1.0), 20.0);
        assert_eq!(height([3840, 2160], 1.0), 60.0);
        assert_eq!(height([3840, 2160], 4.0), 64.0);
        assert_eq!(height([2560, 1440], 2.5), 40.0);
        assert_eq!(height([0, 0], f32::NAN), 16.0);
    }
}
