//! Shapes that say a state without colour, made of rectangles.

use super::canvas::{Area, Canvas};
use super::colour::Rgba;

/// Shape in a square.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mark {
    /// Filled square: as it should be.
    Full,
    /// Frame: off, none.
    Hollow,
    /// Diagonal cross: failed.
    Cross,
    /// Two upright bars: paused.
    Bars,
    /// Triangle that points down: press more.
    Down,
    /// Triangle that points up: ease off.
    Up,
}

/// Number of rows of a triangle and of a cross.
const ROWS: u8 = 8;

impl Mark {
    /// Adds the shape into the square `area`.
    pub fn draw(self, canvas: &mut Canvas, area: Area, rgba: Rgba) {
        let side = area.width().min(area.height());
        let part = |x: [f32; 2], y: [f32; 2]| Area {
            min: [area.min[0] + side * x[0], area.min[1] + side * y[0]],
            max: [area.min[0] + side * x[1], area.min[1] + side * y[1]],
        };
        let parts = match self {
            Self::Full => vec![part([0.0, 1.0], [0.0, 1.0])],
            Self::Hollow => vec![
                part([0.0, 1.0], [0.0, 0.2]),
                part([0.0, 1.0], [0.8, 1.0]),
                part([0.0, 0.2], [0.2, 0.8]),
                part([0.8, 1.0], [0.2, 0.8]),
            ],
            Self::Bars => vec![
                part([0.05, 0.35], [0.0, 1.0]),
                part([0.65, 0.95], [0.0, 1.0]),
            ],
            Self::Cross | Self::Down | Self::Up => (0..ROWS)
                .flat_map(|k| {
                    let (from, to) = (
                        f32::from(k) / f32::from(ROWS),
                        f32::from(k + 1) / f32::from(ROWS),
                    );
                    let y = [from, to];
                    match self {
                        Self::Down => vec![part([0.5 * from, 1.0 - 0.5 * from], y)],
                        Self::Up => vec![part([0.5 - 0.5 * to, 0.5 + 0.5 * to], y)],
                        _ => {
                            let arm = |x: f32| part([(x - 0.12).max(0.0), (x + 0.12).min(1.0)], y);
                            let middle = 0.5 * (from + to);
                            vec![arm(middle), arm(1.0 - middle)]
                        }
                    }
                })
                .collect(),
        };
        for area in parts {
            canvas.rect(area, rgba);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::canvas::Metrics;
    use super::super::colour::WHITE;
    use super::super::primitive::Primitive;
    use super::*;

    /// Filled cells of a mark, drawn into 40 by 40 cells.
    fn cells(mark: Mark) -> Vec<bool> {
        let metrics = Metrics::of([640, 360], 1.0);
        let mut canvas = Canvas {
            list: vec![],
            metrics,
        };
        let area = Area {
            min: [3.0, 5.0],
            max: [43.0, 45.0],
        };
        mark.draw(&mut canvas, area, WHITE);
        let mut cells = vec![false; 1600];
        for one in &canvas.list {
            let Primitive::Rect { min, max, .. } = one else {
                continue;
            };
            assert!(
                min[0] >= 3.0 && min[1] >= 5.0 && max[0] <= 43.0 && max[1] <= 45.0,
                "{mark:?}"
            );
            for (k, cell) in cells.iter_mut().enumerate() {
                let (x, y) = (3.5 + (k % 40) as f32, 5.5 + (k / 40) as f32);
                *cell |= min[0] <= x && x < max[0] && min[1] <= y && y < max[1];
            }
        }
        cells
    }

    #[test]
    fn shapes_differ_in_much_of_their_area() {
        let all = [
            Mark::Full,
            Mark::Hollow,
            Mark::Cross,
            Mark::Bars,
            Mark::Down,
            Mark::Up,
        ];
        for (k, a) in all.iter().enumerate() {
            for b in &all[k + 1..] {
                let apart = cells(*a)
                    .iter()
                    .zip(cells(*b))
                    .filter(|(a, b)| **a != *b)
                    .count();
                assert!(apart > 320, "{a:?} {b:?} {apart}");
            }
        }
    }
}
