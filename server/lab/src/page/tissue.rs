//! The page about a tissue model judged by finite elements: rest, finite elements and model, case by case.
//!
//! `tissue.html` needs no other file; its pictures are also beside it as PNG files.

use std::path::{Path, PathBuf};

use anyhow::Context;
use askama::Template;
use sulcus_core::Vec3;
use sulcus_program::PathText;
use sulcus_scene::mesh::distance::MeshDistance;

use super::filters;
use crate::picture::{Camera, SIDES, Scale, data_uri, diverging, draw_mesh, hex};
use crate::tissue::judge::{Outcome, TickTime};
use crate::tissue::organ::Organ;

/// Longest side of a picture, pixels.
const LONGEST: f64 = 360.0;
/// Light in full shadow: colour must be read.
const SHADOW: f64 = 0.62;
/// Room round the shapes, metres.
const RIM: f64 = 4e-3;

/// Content of the page.
pub(crate) struct Subject<'a> {
    /// Folder of the cases.
    pub(crate) folder: &'a Path,
    /// The organ.
    pub(crate) organ: &'a Organ,
    /// The judged cases.
    pub(crate) outcomes: &'a [Outcome],
    /// Name of the model, for people.
    pub(crate) fitted: &'a str,
    /// Time of a tick of the model.
    pub(crate) tick_us: TickTime,
}

#[derive(Template)]
#[template(path = "tissue.html")]
struct Page<'a> {
    subject: &'a Subject<'a>,
    folder: String,
    /// Colour of a large error.
    orange: String,
    cases: Vec<Case<'a>>,
}

/// One case and its pictures.
struct Case<'a> {
    outcome: &'a Outcome,
    /// Error with full colour, millimetres.
    full_mm: f64,
    /// From the side and from above: rest, finite elements, model.
    views: Vec<Vec<Picture>>,
}

/// One picture.
struct Picture {
    uri: String,
    /// Pixels.
    width: usize,
    /// Pixels.
    height: usize,
    caption: String,
    /// Name of the file beside the page.
    file: String,
}

/// Writes the page and its pictures into a folder; returns the path of the page. `progress` gets the case in work.
///
/// # Errors
/// If a file cannot be written.
pub(crate) fn write(
    folder: &Path,
    subject: &Subject,
    progress: &dyn Fn(&str),
) -> anyhow::Result<PathBuf> {
    let cases = subject.outcomes.iter().map(|outcome| {
        progress(&format!("drawing {}", outcome.error.name));
        draw(folder, subject.organ, outcome)
    });
    let page = Page {
        subject,
        folder: subject.folder.shown().to_string(),
        orange: hex(diverging(-0.8)),
        cases: cases.collect::<anyhow::Result<_>>()?,
    };
    let path = folder.join("tissue.html");
    std::fs::write(&path, page.render()?)
        .with_context(|| format!("{}: cannot write the page", path.shown()))?;
    Ok(path)
}

/// Draws the pictures of a case and writes them into the folder.
fn draw<'a>(folder: &Path, organ: &Organ, outcome: &'a Outcome) -> anyhow::Result<Case<'a>> {
    let both = outcome.found.iter().zip(&outcome.wanted);
    let off: Vec<f64> = both.map(|(a, b)| 1e3 * (a - b).norm()).collect();
    let free: Vec<(f64, f64)> = organ.free.iter().map(|&v| (off[v], 1.0)).collect();
    let scale = Scale::fit(&free);
    let shapes = [
        ("rest", "at rest", organ.moved(&[])),
        ("fem", "finite elements", organ.moved(&outcome.wanted)),
        ("model", "model", organ.moved(&outcome.found)),
    ];
    // Rest and elements set the view; a model that goes beyond is cut off.
    let bounds = [&shapes[0], &shapes[1]].map(|shape| shape.2.mesh().bounds());
    let rim = Vec3::repeat(RIM);
    let low = bounds[0].0.inf(&bounds[1].0) - rim;
    let high = bounds[0].1.sup(&bounds[1].1) + rim;
    let pixel = (high - low).max() / LONGEST;
    // From the side and from above.
    let view = |side| -> anyhow::Result<Vec<Picture>> {
        let camera = Camera::new(side, &low, &high, pixel);
        let picture = |(name, caption, shape): &(&str, &str, MeshDistance)| {
            let seen = draw_mesh(&camera, shape);
            let image = seen.picture(SHADOW, |k| {
                let error = seen.value(k, shape.mesh(), &off);
                diverging(-scale.part(error))
            });
            let png = image.to_png()?;
            let file = format!("{}-{}-{name}.png", outcome.error.name, side.name);
            let path = folder.join(&file);
            std::fs::write(&path, &png)
                .with_context(|| format!("{}: cannot write the picture", path.shown()))?;
            Ok(Picture {
                uri: data_uri("image/png", &png),
                width: image.width,
                height: image.height,
                caption: format!("{caption}, {}", side.caption),
                file,
            })
        };
        shapes.iter().map(picture).collect()
    };
    Ok(Case {
        outcome,
        full_mm: scale.full_mm,
        views: SIDES[1..].iter().map(view).collect::<anyhow::Result<_>>()?,
    })
}
