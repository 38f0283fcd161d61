//! The page about a tissue model judged by finite elements: at rest, as the elements say and as the model says, case by case.
//!
//! `tissue.html` needs nothing but itself; its pictures also lie beside it as PNG files.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use anyhow::Context;
use sulcus_core::Vec3;
use sulcus_program::PathText;
use sulcus_scene::mesh::TriMesh;
use sulcus_scene::mesh::distance::MeshDistance;

use super::Scale;
use super::html::{STYLE, escaped};
use crate::picture::{Camera, SIDES, data_uri, diverging, draw_mesh, hex};
use crate::tissue::judge::{Outcome, TickTime};
use crate::tissue::organ::Organ;

/// Longest side of a picture, pixels.
const LONGEST: f64 = 360.0;
/// Light in full shadow: colour must be read.
const SHADOW: f64 = 0.62;

/// What the page is about.
pub(crate) struct Subject<'a> {
    /// Folder of the cases.
    pub(crate) folder: &'a Path,
    /// The organ.
    pub(crate) organ: &'a Organ,
    /// The judged cases.
    pub(crate) outcomes: &'a [Outcome],
    /// What the model is.
    pub(crate) fitted: &'a str,
    /// What a tick of it costs.
    pub(crate) tick_us: TickTime,
}

/// Writes the page and its pictures into a folder; gives the page's path. `progress` gets what is being drawn.
///
/// # Errors
/// If a file cannot be written.
pub(crate) fn write(
    folder: &Path,
    subject: &Subject,
    progress: &dyn Fn(&str),
) -> anyhow::Result<PathBuf> {
    let mut html = format!(
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" content=\"width=device-width\">\n<title>Tissue against finite elements</title>\n<style>{STYLE}</style></head>\n<body><main>\n<h1>Tissue against finite elements</h1>\n"
    );
    table(&mut html, subject);
    for outcome in subject.outcomes {
        progress(&format!("drawing {}", outcome.error.name));
        section(&mut html, folder, subject, outcome)?;
    }
    html.push_str("</main></body></html>\n");
    let page = folder.join("tissue.html");
    std::fs::write(&page, html)
        .with_context(|| format!("{}: cannot write the page", page.shown()))?;
    Ok(page)
}

fn table(html: &mut String, subject: &Subject) {
    let _ = write!(
        html,
        "<section><div class=\"facts\"><div><span class=\"soft\">cases of</span> <b>{}</b></div><div><span class=\"soft\">judged at</span> <b>{} free vertices</b></div><div><span class=\"soft\">tissue per tick</span> <b>{:.1} µs p50, {:.1} µs p99.9</b></div></div><p>Model: {}.</p>\n<div class=\"wide\"><table><thead><tr><th>case</th><th>rms, %</th><th>rel. L2, %</th><th>max, %</th><th>elements, mm</th><th>model, mm</th></tr></thead><tbody>\n",
        escaped(&subject.folder.shown().to_string()),
        subject.organ.free.len(),
        subject.tick_us.p50,
        subject.tick_us.p999,
        escaped(subject.fitted),
    );
    for e in subject.outcomes.iter().map(|outcome| &outcome.error) {
        let _ = writeln!(
            html,
            "<tr><td>{}</td><td>{:.2}</td><td>{:.1}</td><td>{:.1}</td><td>{:.3}</td><td>{:.3}</td></tr>",
            escaped(&e.name),
            e.rms_percent,
            e.rel_l2_percent,
            e.max_percent,
            e.max_displacement_mm,
            e.model_max_displacement_mm
        );
    }
    html.push_str("</tbody></table></div>\n<p class=\"note\"><b>rms</b> and <b>max</b>: error at the free vertices in percent of the case's largest displacement. <b>rel. L2</b>: root mean square of the error over that of the displacement; a model that never moves has 100 %. The last columns are the largest displacements.</p></section>\n");
}

fn section(
    html: &mut String,
    folder: &Path,
    subject: &Subject,
    outcome: &Outcome,
) -> anyhow::Result<()> {
    let organ = subject.organ;
    let e = &outcome.error;
    let off: Vec<f64> = outcome
        .found
        .iter()
        .zip(&outcome.wanted)
        .map(|(a, b)| 1e3 * (a - b).norm())
        .collect();
    let free: Vec<(f64, f64)> = organ.free.iter().map(|&v| (off[v], 1.0)).collect();
    let scale = Scale::fit(&free);
    let moved = |by: Option<&[Vec3]>| -> MeshDistance {
        let mut mesh: TriMesh = organ.surface.clone();
        if let Some(by) = by {
            mesh.vertices.iter_mut().zip(by).for_each(|(v, u)| *v += u);
        }
        MeshDistance::new(mesh)
    };
    let shapes = [
        ("rest", "at rest", moved(None)),
        ("fem", "finite elements", moved(Some(&outcome.wanted))),
        ("model", "model", moved(Some(&outcome.found))),
    ];
    // Rest and elements set the view; a model that goes beyond is cut off.
    let bounds = [&shapes[0], &shapes[1]].map(|shape| shape.2.mesh().bounds());
    let rim = Vec3::repeat(4e-3);
    let low = bounds[0].0.inf(&bounds[1].0) - rim;
    let high = bounds[0].1.sup(&bounds[1].1) + rim;
    let pixel = (high - low).max() / LONGEST;
    let _ = writeln!(
        html,
        "<section><h2>{}</h2><p>Error {:.2} % rms, {:.1} % of the displacement. Full <b style=\"color:{}\">orange</b> is an error of {} mm or more, grey is none.</p>",
        escaped(&e.name),
        e.rms_percent,
        e.rel_l2_percent,
        hex(diverging(-0.8)),
        scale.full_mm
    );
    // From the side and from above.
    for side in &SIDES[1..] {
        let camera = Camera::new(side, &low, &high, pixel);
        html.push_str("<div class=\"pictures\">");
        for (name, caption, shape) in &shapes {
            let seen = draw_mesh(&camera, shape);
            let image = seen.picture(SHADOW, |k| {
                let error = seen.value(k, shape.mesh(), &off);
                diverging(-scale.part(error))
            });
            let png = image.to_png()?;
            let file = format!("{}-{}-{name}.png", e.name, side.name);
            let path = folder.join(&file);
            std::fs::write(&path, &png)
                .with_context(|| format!("{}: cannot write the picture", path.shown()))?;
            let _ = write!(
                html,
                "<figure><img src=\"{}\" width=\"{}\" height=\"{}\" alt=\"{caption}, {}\" title=\"{}\"><figcaption>{caption}, {}</figcaption></figure>",
                data_uri("image/png", &png),
                image.width,
                image.height,
                side.caption,
                escaped(&file),
                side.caption,
            );
        }
        html.push_str("</div>\n");
    }
    html.push_str("</section>\n");
    Ok(())
}
