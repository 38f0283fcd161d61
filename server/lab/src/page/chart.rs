//! Charts as SVG: the histogram of a level, error against number of spheres, the colour bar.

use std::fmt::Write;

use sulcus_scene::error::LevelError;

use super::LevelErrors;
use crate::picture::{diverging, hex};

/// Bins of a histogram.
const BINS: usize = 61;

/// The share of the surface at each signed error, coloured like the pictures, over a colour scale.
pub(super) fn histogram(level: &LevelErrors) -> String {
    let full = level.scale.full_mm;
    let mut bins = [0.0; BINS];
    let total: f64 = level.weighted_mm.iter().map(|p| p.1).sum();
    for (error, area) in &level.weighted_mm {
        let at = (level.scale.part(*error).clamp(-1.0, 1.0) + 1.0) * 0.5 * BINS as f64;
        bins[(at as usize).min(BINS - 1)] += 100.0 * area / total;
    }
    let most = bins.iter().fold(0.0, |most: f64, bin| most.max(*bin));
    let (left, top, width, height) = (46.0, 12.0, 366.0, 120.0);
    let step = width / BINS as f64;
    let mut svg = String::from(
        r##"<svg viewBox="0 0 430 212" role="img" aria-label="histogram of the signed error">"##,
    );
    for (k, share) in bins.iter().enumerate() {
        let tall = height * share / most;
        let colour = hex(diverging(2.0 * (k as f64 + 0.5) / BINS as f64 - 1.0));
        let x = left + step * k as f64;
        let _ = write!(
            svg,
            r##"<rect x="{x:.2}" y="{:.2}" width="{:.2}" height="{tall:.2}" fill="{colour}" stroke="#8a9097" stroke-width=".4"/>"##,
            top + height - tall,
            step,
        );
        // The colour bar below.
        let _ = write!(
            svg,
            r##"<rect x="{x:.2}" y="150" width="{:.2}" height="14" fill="{colour}"/>"##,
            step + 0.3,
        );
    }
    let _ = write!(
        svg,
        r##"<rect x="{left}" y="150" width="{width}" height="14" fill="none" stroke="#555"/><path d="M{left} {top}v{height}h{width}" fill="none" stroke="#555"/><text x="40" y="{:.1}" text-anchor="end">{most:.0} %</text><text x="40" y="{:.1}" text-anchor="end">0</text><text transform="translate(12 {:.1}) rotate(-90)" text-anchor="middle">share of area</text>"##,
        top + 9.0,
        top + height,
        top + height * 0.5,
    );
    for (part, anchor) in [
        (-1.0, "start"),
        (-0.5, "middle"),
        (0.0, "middle"),
        (0.5, "middle"),
        (1.0, "end"),
    ] {
        let x = left + width * (part + 1.0) * 0.5;
        let sign = if part > 0.0 { "+" } else { "" };
        let unit = if part == 0.0 { " mm" } else { "" };
        let value = plain(part * full);
        let _ = write!(
            svg,
            r##"<path d="M{x:.1} 164v4" stroke="#555"/><text x="{x:.1}" y="180" text-anchor="{anchor}">{sign}{value}{unit}</text>"##
        );
    }
    let _ = write!(
        svg,
        r##"<text x="{left}" y="200" class="bulge">◀ bulge: spheres stick out</text><text x="{:.0}" y="200" text-anchor="end" class="gap">gap: mesh sticks out ▶</text></svg>"##,
        left + width,
    );
    svg
}

/// Mean and maximum, both ways, against the number of spheres; both axes logarithmic.
pub(super) fn convergence(levels: &[LevelError]) -> String {
    let lines: [(&str, &str, &str, Vec<f64>); 4] = [
        (
            "mesh to spheres, max",
            "#1c5ea8",
            "",
            column(levels, |l| l.mesh_to_spheres_mm.max),
        ),
        (
            "mesh to spheres, mean",
            "#1c5ea8",
            "5 4",
            column(levels, |l| l.mesh_to_spheres_mm.mean),
        ),
        (
            "spheres to mesh, max",
            "#c76107",
            "",
            column(levels, |l| l.spheres_to_mesh_mm.max),
        ),
        (
            "spheres to mesh, mean",
            "#c76107",
            "5 4",
            column(levels, |l| l.spheres_to_mesh_mm.mean),
        ),
    ];
    let values = lines.iter().flat_map(|line| &line.3).copied();
    let values: Vec<f64> = values.filter(|v| *v > 0.0).collect();
    let least = values.iter().copied().fold(f64::INFINITY, f64::min);
    let most = values.iter().copied().fold(0.0, f64::max);
    if !(least > 0.0 && least.is_finite()) {
        return String::new();
    }
    let (low, high) = (
        least.log10().floor(),
        most.log10().ceil().max(least.log10().floor() + 1.0),
    );
    let (left, top, width, height) = (60.0, 12.0, 420.0, 220.0);
    let spheres = |l: &LevelError| (l.spheres as f64).log10();
    let last = levels.iter().map(spheres).fold(0.5, f64::max);
    let x = |l: &LevelError| left + width * spheres(l) / last;
    let y = |mm: f64| top + height * (high - mm.log10()) / (high - low);
    let mut svg = String::from(
        r##"<svg viewBox="0 0 690 290" role="img" aria-label="error against number of spheres">"##,
    );
    let mut decade = low;
    while decade <= high {
        let at = y(10_f64.powf(decade));
        let _ = write!(
            svg,
            r##"<path d="M{left} {at:.1}h{width}" stroke="#d9dce0"/><text x="54" y="{:.1}" text-anchor="end">{}</text>"##,
            at + 4.0,
            plain(10_f64.powf(decade)),
        );
        decade += 1.0;
    }
    for level in levels {
        let _ = write!(
            svg,
            r##"<text x="{:.1}" y="250" text-anchor="middle">{}</text><text x="{0:.1}" y="265" text-anchor="middle" class="soft">L{}</text>"##,
            x(level),
            level.spheres,
            level.level
        );
    }
    for (k, (name, colour, dash, values)) in lines.iter().enumerate() {
        let points: Vec<String> = levels
            .iter()
            .zip(values)
            .map(|(level, mm)| format!("{:.1},{:.1}", x(level), y(mm.max(least))))
            .collect();
        let row = top + 14.0 + 20.0 * k as f64;
        let _ = write!(
            svg,
            r##"<polyline points="{}" fill="none" stroke="{colour}" stroke-width="2" stroke-dasharray="{dash}"/><path d="M505 {row}h28" stroke="{colour}" stroke-width="2" stroke-dasharray="{dash}"/><text x="540" y="{}">{name}</text>"##,
            points.join(" "),
            row + 4.0,
        );
    }
    let _ = write!(
        svg,
        r##"<path d="M{left} {top}v{height}h{width}" fill="none" stroke="#555"/><text x="{:.0}" y="284" text-anchor="middle">spheres at the level</text><text transform="translate(14 {:.0}) rotate(-90)" text-anchor="middle">error, mm</text></svg>"##,
        left + width * 0.5,
        top + height * 0.5,
    );
    svg
}

fn column(levels: &[LevelError], of: impl Fn(&LevelError) -> f64) -> Vec<f64> {
    levels.iter().map(of).collect()
}

/// A number without needless zeros.
fn plain(x: f64) -> String {
    let text = format!("{x:.5}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0" } else { text }.replace('-', "−")
}
