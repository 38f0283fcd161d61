//! The pictures of a page: every level from three sides, its errors and its spheres.

use std::path::Path;

use anyhow::Context;
use sulcus_core::math::{fmax, fmin};
use sulcus_core::{Sphere, Vec3};
use sulcus_program::PathText;
use sulcus_scene::error::{surface_error, zone_patch};
use sulcus_scene::tree::zone::Zone;

use super::{LevelErrors, Subject};
use crate::picture::{
    Camera, Fragments, GREY, Image, SIDES, data_uri, diverging, draw_mesh, draw_spheres, ivory,
};

/// Longest side of a picture, pixels.
const LONGEST: f64 = 440.0;
/// Light in full shadow: much where colour must be read, little where shape must.
const SHADOW_ON_COLOUR: f64 = 0.62;
const SHADOW_ON_SPHERES: f64 = 0.30;

/// A picture of the page.
pub(super) struct Picture {
    pub(super) caption: String,
    pub(super) file: String,
    pub(super) uri: String,
    pub(super) width: usize,
    pub(super) height: usize,
    /// Length of a pixel, millimetres.
    pub(super) pixel_mm: f64,
}

/// The pictures of a level, or of a level in a zone.
pub(super) struct Gallery {
    /// Coloured by error.
    pub(super) errors: Vec<Picture>,
    /// The spheres.
    pub(super) spheres: Vec<Picture>,
}

/// The galleries of the whole object and of each zone, level by level.
pub(super) struct Galleries {
    pub(super) whole: Vec<Gallery>,
    pub(super) zones: Vec<Vec<Gallery>>,
}

/// Draws all pictures and writes them into the folder.
///
/// # Errors
/// If a file cannot be written.
pub(super) fn draw(
    folder: &Path,
    subject: &Subject,
    levels: &[LevelErrors],
    progress: &dyn Fn(&str),
) -> anyhow::Result<Galleries> {
    let (low, high) = with_spheres(subject.distance.mesh().bounds(), levels);
    let whole = draw_levels(folder, subject, levels, (low, high), None, progress)?;
    let mut zones = Vec::new();
    for zone in subject.zones {
        let (low, high) = zone_box(subject, zone);
        zones.push(draw_levels(
            folder,
            subject,
            levels,
            (low, high),
            Some(zone),
            progress,
        )?);
    }
    Ok(Galleries { whole, zones })
}

/// The box of the mesh, wider where spheres stick out of it, but by no more than a fifth.
fn with_spheres((low, high): (Vec3, Vec3), levels: &[LevelErrors]) -> (Vec3, Vec3) {
    let room = (high - low) * 0.2;
    let (mut wide_low, mut wide_high) = (low, high);
    for s in levels.iter().flat_map(|level| &level.spheres) {
        wide_low = wide_low.zip_map(&s.centre.map(|x| x - s.radius), fmin);
        wide_high = wide_high.zip_map(&s.centre.map(|x| x + s.radius), fmax);
    }
    let rim = Vec3::repeat(0.02 * (high - low).max());
    (
        wide_low.zip_map(&(low - room), fmax) - rim,
        wide_high.zip_map(&(high + room), fmin) + rim,
    )
}

/// The box of the mesh in a zone (which holds some of it), with a rim.
fn zone_box(subject: &Subject, zone: &Zone) -> (Vec3, Vec3) {
    let (low, high) = zone_patch(subject.distance.mesh(), zone).bounds();
    let rim = Vec3::repeat(fmax(0.08 * (high - low).max(), 1e-5));
    (low - rim, high + rim)
}

fn draw_levels(
    folder: &Path,
    subject: &Subject,
    levels: &[LevelErrors],
    (low, high): (Vec3, Vec3),
    zone: Option<&Zone>,
    progress: &dyn Fn(&str),
) -> anyhow::Result<Vec<Gallery>> {
    let pixel = (high - low).max() / LONGEST;
    let cameras = SIDES.map(|side| Camera::new(&side, &low, &high, pixel));
    // What each pixel shows of the mesh is the same at every level.
    let shown: Vec<Shown> = cameras
        .iter()
        .map(|camera| Shown::new(draw_mesh(camera, subject.distance), zone))
        .collect();
    let mut galleries = Vec::new();
    for level in levels {
        let place = zone.map_or_else(String::new, |zone| format!("-{}", file_name(&zone.name)));
        progress(&format!("drawing level {}{place}", level.level));
        let mut gallery = Gallery {
            errors: Vec::new(),
            spheres: Vec::new(),
        };
        for ((side, camera), shown) in SIDES.iter().zip(&cameras).zip(&shown) {
            let keep = |image: &Image, what: &str| -> anyhow::Result<Picture> {
                let file = format!("level{}{place}-{what}-{}.png", level.level, side.name);
                let path = folder.join(&file);
                let bytes = image.to_png()?;
                std::fs::write(&path, &bytes)
                    .with_context(|| format!("{}: cannot write the picture", path.shown()))?;
                Ok(Picture {
                    caption: side.caption.to_owned(),
                    file,
                    uri: data_uri("image/png", &bytes),
                    width: image.width,
                    height: image.height,
                    pixel_mm: 1e3 * camera.pixel,
                })
            };
            gallery.errors.push(keep(&shown.errors(level), "error")?);
            let spheres = spheres_picture(camera, &level.spheres);
            gallery.spheres.push(keep(&spheres, "spheres")?);
        }
        galleries.push(gallery);
    }
    Ok(galleries)
}

/// What the pixels show of the mesh.
struct Shown {
    fragments: Fragments,
    points: Vec<Vec3>,
    in_zone: Option<Vec<bool>>,
}

impl Shown {
    fn new(fragments: Fragments, zone: Option<&Zone>) -> Self {
        let points: Vec<Vec3> = fragments.seen.iter().map(|f| f.point).collect();
        Self {
            in_zone: zone.map(|zone| points.iter().map(|p| zone.contains(p)).collect()),
            points,
            fragments,
        }
    }

    /// Coloured by the error at each pixel's very point.
    fn errors(&self, level: &LevelErrors) -> Image {
        let errors = surface_error(&level.spheres, &self.points);
        self.fragments.picture(SHADOW_ON_COLOUR, |k| {
            if self.in_zone.as_ref().is_some_and(|inside| !inside[k]) {
                return GREY;
            }
            diverging(level.scale.part(1e3 * errors[k]))
        })
    }
}

fn spheres_picture(camera: &Camera, spheres: &[Sphere]) -> Image {
    let fragments = draw_spheres(camera, spheres);
    fragments.picture(SHADOW_ON_SPHERES, |k| ivory(fragments.seen[k].of))
}

/// A zone's name as part of a file's.
fn file_name(name: &str) -> String {
    name.chars()
        .map(|c| if c.is_ascii_alphanumeric() { c } else { '_' })
        .collect()
}
