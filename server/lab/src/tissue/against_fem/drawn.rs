//! A model's shape under a load beside that of the finite elements, as one picture that explains itself.

use sulcus_core::Vec3;

use super::reference::Reference;
use crate::picture::text::{INK, extent, write};
use crate::picture::{Camera, Fragments, GREY, Image, SIDES, diverging, draw_mesh};
use crate::tissue::organ::Organ;

/// Longest side of a view, pixels.
const LONGEST: f64 = 380.0;
/// Room about everything, pixels.
const GAP: usize = 12;
/// Pixels of a dot of a letter.
const DOT: usize = 2;
/// Light in full shadow: colour must be read.
const SHADOW: f64 = 0.72;
/// Room round the shapes, metres.
const RIM: f64 = 3e-3;
/// Farthest that a view goes beyond rest and finite elements for a model's sake, metres.
const BEYOND: f64 = 40e-3;
/// Between the colours of errors, millimetres. The same in every picture and in steps that double or more, so that pictures can be held against one
/// another and both a good and a bad model show where they err.
const STEPS_MM: [f64; 7] = [0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0];
/// Colour of the finite elements' own shape: no error is looked at there.
const PLAIN: [u8; 3] = [222, 203, 201];
/// Colour of it where the push is strongest, and of the outline at rest.
const PUSHED: [u8; 3] = [70, 120, 190];

/// Colour of an error, millimetres.
fn colour(error_mm: f64) -> [u8; 3] {
    let step = STEPS_MM.iter().filter(|most| error_mm > **most).count();
    band(step)
}

/// The colours, from that of the least errors.
fn band(step: usize) -> [u8; 3] {
    diverging(-(step as f64) / STEPS_MM.len() as f64)
}

/// The picture, as a PNG file: from the side and from above, on the left the finite elements, on the right the model in the
/// colours of its error, with the outline of the finite elements over it.
pub(super) fn picture(
    model: &str,
    organ: &Organ,
    reference: &Reference,
    found: &[Vec3],
) -> anyhow::Result<Vec<u8>> {
    let rest = organ.moved(&[]);
    let (wanted_shape, model_shape) = (organ.moved(&reference.moved), organ.moved(found));
    let both = found.iter().zip(&reference.moved);
    let off_mm: Vec<f64> = both.map(|(a, b)| 1e3 * (a - b).norm()).collect();

    let push = pressure(organ, &reference.forces);
    let strongest = push.iter().copied().fold(f64::MIN_POSITIVE, f64::max);

    let bounds = [&rest, &wanted_shape, &model_shape].map(|shape| shape.mesh().bounds());
    let (low, high) = (bounds[0].0.inf(&bounds[1].0), bounds[0].1.sup(&bounds[1].1));
    let rim = Vec3::repeat(RIM);
    let low = low.inf(&bounds[2].0.sup(&(low - Vec3::repeat(BEYOND)))) - rim;
    let high = high.sup(&bounds[2].1.inf(&(high + Vec3::repeat(BEYOND)))) + rim;
    let pixel = (high - low).max() / LONGEST;
    // From the side and from above.
    let rows = SIDES[1..].iter().map(|side| {
        let camera = Camera::new(side, &low, &high, pixel);
        let [rest, wanted, found] =
            [&rest, &wanted_shape, &model_shape].map(|s| draw_mesh(&camera, s));
        let mut left = wanted.picture(SHADOW, |k| {
            pushed(wanted.value(k, wanted_shape.mesh(), &push) / strongest)
        });
        rest.outline(&mut left, PUSHED);
        let error = |seen: &Fragments, k| seen.value(k, model_shape.mesh(), &off_mm);
        let mut right = found.picture(SHADOW, |k| colour(error(&found, k)));
        wanted.outline(&mut right, INK);
        [left, right]
    });
    let rows: Vec<[Image; 2]> = rows.collect();
    let captions = [
        ["finite elements", "blue: push, blue line: at rest"],
        [model, "line: finite elements"],
    ];
    Ok(together(&reference.name(), &rows, &captions, pixel).to_png()?)
}

/// What acts on the vertices of the surface, by area: pascals.
fn pressure(organ: &Organ, forces: &[Vec3]) -> Vec<f64> {
    let mut areas = vec![0.0; forces.len()];
    for (f, triangle) in organ.surface.triangles.iter().enumerate() {
        let third = organ.surface.area_vector(f).norm() / 3.0;
        triangle.iter().for_each(|v| areas[*v as usize] += third);
    }
    let both = forces.iter().zip(&areas);
    both.map(|(force, area)| force.norm() / area).collect()
}

/// Colour of the finite elements where this share of the strongest push acts.
fn pushed(share: f64) -> [u8; 3] {
    std::array::from_fn(|k| {
        let (a, b) = (f64::from(PLAIN[k]), f64::from(PUSHED[k]));
        (a + (b - a) * share.clamp(0.0, 1.0)).round() as u8
    })
}

/// Two columns of views under title and captions, and the legend below.
fn together(title: &str, rows: &[[Image; 2]], captions: &[[&str; 2]; 2], pixel: f64) -> Image {
    let letters = captions.as_flattened().iter();
    let column = letters
        .map(|text| extent(text, DOT).0)
        .chain(rows.iter().flatten().map(|view| view.width))
        .max()
        .unwrap_or(0);
    let line = extent("", DOT).1 + DOT;
    let legend = 3 * line;
    let views: usize = rows.iter().map(|row| row[0].height + GAP).sum();
    let top = GAP + line + GAP;
    let below = top + 2 * line + GAP + views;
    let wide = (2 * column + 3 * GAP).max(extent(title, DOT).0 + 2 * GAP);
    let mut image = Image::white(wide, below + legend + GAP);
    write(&mut image, title, (GAP, GAP), DOT);
    for (k, caption) in captions.iter().enumerate() {
        let x = GAP + k * (column + GAP);
        let mut y = top;
        for text in caption {
            write(&mut image, text, (x, y), DOT);
            y += line;
        }
        y += GAP;
        for row in rows {
            image.paste(&row[k], (x + (column - row[k].width) / 2, y));
            y += row[k].height + GAP;
        }
    }
    let y = below;
    scale(&mut image, (GAP, y), pixel);
    let text = "error, mm";
    // The legend of colours ends where the pictures do.
    let (wide, tall) = (44, line);
    let x = image.width - GAP - wide * (STEPS_MM.len() + 1);
    write(&mut image, text, (x, y), DOT);
    for k in 0..=STEPS_MM.len() {
        let left = x + k * wide;
        image.fill((left, y + line), (wide, tall), GREY);
        image.fill((left, y + line + 1), (wide - 1, tall - 2), band(k));
        if let Some(step) = STEPS_MM.get(k) {
            let text = step.to_string();
            let half = extent(&text, DOT).0 / 2;
            write(
                &mut image,
                &text,
                (left + wide - half, y + 2 * line + DOT),
                DOT,
            );
        }
    }
    image
}

/// A bar of ten millimetres.
fn scale(image: &mut Image, (x, y): (usize, usize), pixel: f64) {
    let long = (10e-3 / pixel).round() as usize;
    let line = extent("", DOT).1 + DOT;
    write(image, "10 mm", (x, y), DOT);
    image.fill((x, y + line + 6), (long, 2), INK);
    for end in [x, x + long - 2] {
        image.fill((end, y + line), (2, 14), INK);
    }
}
