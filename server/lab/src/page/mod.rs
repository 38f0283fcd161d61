//! The page about one sphere tree: what it is, how far it is from its mesh, and where.
//!
//! `tree.html` needs nothing but itself; its pictures also lie beside it as PNG files.

mod chart;
mod gallery;
mod html;
mod plot;
pub(crate) mod report;
mod scale;
pub(crate) mod tissue;

use std::path::{Path, PathBuf};

use anyhow::Context;
use sulcus_core::{Sphere, SphereTree};
use sulcus_program::PathText;
use sulcus_scene::error::{TreeReport, surface_error, surface_points};
use sulcus_scene::mesh::distance::MeshDistance;
use sulcus_scene::tree::zone::Zone;

pub(crate) use scale::Scale;

/// Points whose errors make the histogram and the scale of a level.
const POINTS: usize = 50_000;

/// What the page is about.
pub(crate) struct Subject<'a> {
    /// Name of the mesh.
    pub(crate) name: String,
    /// Its file.
    pub(crate) file: &'a Path,
    /// The mesh.
    pub(crate) distance: &'a MeshDistance,
    /// The tree.
    pub(crate) tree: &'a SphereTree,
    /// Zones that were measured apart.
    pub(crate) zones: &'a [Zone],
    /// The measured errors.
    pub(crate) report: &'a TreeReport,
    /// Seconds that the build took.
    pub(crate) build_s: f64,
    /// Seconds that measuring took.
    pub(crate) measure_s: f64,
}

/// Signed errors of one level, millimetres, over the points of a surface.
pub(crate) struct LevelErrors {
    /// The level.
    pub(crate) level: u8,
    /// The spheres that are the shape.
    pub(crate) spheres: Vec<Sphere>,
    /// Error and area (square metres).
    pub(crate) weighted_mm: Vec<(f64, f64)>,
    /// What full colour means.
    pub(crate) scale: Scale,
}

/// The errors of every level, coarse to fine.
pub(crate) fn level_errors(subject: &Subject) -> Vec<LevelErrors> {
    let points = surface_points(subject.distance.mesh(), POINTS);
    let places: Vec<_> = points.iter().map(|p| p.point).collect();
    (0..=subject.tree.depth())
        .map(|level| {
            let shape = subject.tree.shape_at(level);
            let spheres: Vec<Sphere> = shape.map(|(_, node)| node.sphere()).collect();
            let errors = surface_error(&spheres, &places);
            let weighted_mm: Vec<(f64, f64)> = errors
                .iter()
                .zip(&points)
                .map(|(error, point)| (1e3 * error, point.area))
                .collect();
            LevelErrors {
                level,
                scale: Scale::fit(&weighted_mm),
                spheres,
                weighted_mm,
            }
        })
        .collect()
}

/// Writes the page and its pictures into a folder; gives the page's path. `progress` gets what is
/// being drawn.
///
/// # Errors
/// If a file cannot be written.
pub(crate) fn write(
    folder: &Path,
    subject: &Subject,
    levels: &[LevelErrors],
    progress: &dyn Fn(&str),
) -> anyhow::Result<PathBuf> {
    let galleries = gallery::draw(folder, subject, levels, progress)?;
    let page = folder.join("tree.html");
    std::fs::write(&page, html::page(subject, levels, &galleries))
        .with_context(|| format!("{}: cannot write the page", page.shown()))?;
    Ok(page)
}
