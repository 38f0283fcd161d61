//! Pointer over the picture at the site to be read.

use crate::camera::{PassCamera, Vector};
use crate::panel::Primitive;

/// Width and height of the triangle at scale 1, pixels.
const SIZE: [f32; 2] = [18.0, 16.0];
/// Distance of the triangle's tip from the site at scale 1, pixels.
const OFF: f32 = 10.0;
/// Number of rows of the triangle.
const ROWS: u8 = 8;
/// Yellow of the palette of Okabe and Ito, and its dark rim.
const FILL: [u8; 4] = [240, 228, 66, 255];
const RIM: [u8; 4] = [0, 0, 0, 255];

/// Triangle that points down at a place, mm, in a window of `size` pixels. Empty if the place is out of the picture.
pub fn pointer(pass: &PassCamera, place: &Vector, size: [u32; 2], scale: f32) -> Vec<Primitive> {
    let [width, height] = size.map(|n| n as f32);
    let Some(seen) = pass.seen(place) else {
        return Vec::new();
    };
    let x = (0.5 + 0.5 * seen.x as f32) * width;
    let y = (0.5 - 0.5 * seen.y as f32) * height - OFF * scale;
    let [w, h] = SIZE.map(|n| n * scale);
    let is_inside = x - w > 0.0 && x + w < width && y - 1.3 * h > 0.0 && y < height;
    if !is_inside {
        return Vec::new();
    }
    let triangle = |grown: f32, rgba| {
        (0..ROWS).map(move |k| {
            let [from, to] = [k, k + 1].map(|k| f32::from(k) / f32::from(ROWS));
            // Rows from the tip upwards.
            let half = 0.5 * w * to + grown;
            Primitive::Rect {
                min: [x - half, y - h * to - grown],
                max: [x + half, y - h * from + grown],
                rgba,
            }
        })
    };
    triangle(2.0 * scale, RIM)
        .chain(triangle(0.0, FILL))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::Camera;

    #[test]
    fn the_triangle_ends_over_the_place_and_hides_out_of_the_picture() {
        let pass = Camera::looking(
            Vector::new(300.0, 0.0, 0.0),
            Vector::zeros(),
            Vector::z(),
            16.0,
            1.6,
        )
        .pass();
        let list = pointer(&pass, &Vector::zeros(), [1280, 800], 1.0);
        let bounds = list.iter().map(Primitive::bounds);
        let lowest = bounds.clone().map(|[_, max]| max[1]).fold(0.0, f32::max);
        assert!((lowest - (400.0 - OFF + 2.0)).abs() < 1e-3, "{lowest}");
        for [min, max] in bounds {
            assert!((0.5 * (min[0] + max[0]) - 640.0).abs() < 1e-3);
        }
        for away in [Vector::new(0.0, 90.0, 0.0), Vector::new(600.0, 0.0, 0.0)] {
            assert!(pointer(&pass, &away, [1280, 800], 1.0).is_empty(), "{away}");
        }
    }
}
