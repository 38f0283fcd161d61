//! Lines of a chart: gingival margin and attachment, with the pocket between them.

use super::super::svg::{Element, Svg, points};
use super::{BLUE, RED};

/// Place of a site, with its recession and depth, mm.
#[derive(Clone, Copy)]
pub struct Spot {
    /// Place across the row.
    pub x: f64,
    /// Recession; none if it is not known.
    pub recession: Option<f64>,
    /// Depth; none if it is not known.
    pub depth: Option<f64>,
}

/// Margin and attachment through neighbouring sites, points of the drawing.
struct Run {
    margin: Vec<(f64, f64)>,
    floor: Vec<(f64, f64)>,
}

/// Lines of the calls. `y` is the height of a place, mm from the cemento-enamel junction towards the root.
pub fn called(svg: &mut Svg, spots: &[Option<Spot>], y: impl Fn(f64) -> f64) {
    for Run { margin, floor } in runs(spots, y) {
        let around = margin.iter().chain(floor.iter().rev());
        svg.element("polygon")
            .with("points", points(around.copied()))
            .with("fill", "url(#pocket)")
            .with("fill-opacity", 0.75)
            .end();
        line(svg, margin).stroke(RED, 2.4).end();
        line(svg, floor)
            .stroke(BLUE, 2.4)
            .with("stroke-dasharray", "7 2.5")
            .end();
    }
}

/// Lines of the prescribed values.
pub fn prescribed(svg: &mut Svg, spots: &[Option<Spot>], y: impl Fn(f64) -> f64) {
    for Run { margin, floor } in runs(spots, y) {
        for (all, colour) in [(margin, RED), (floor, "#000")] {
            line(svg, all)
                .stroke(colour, 1.1)
                .with("stroke-dasharray", "1.5 2.5")
                .end();
        }
    }
}

fn line(svg: &mut Svg, all: Vec<(f64, f64)>) -> Element<'_> {
    svg.element("polyline")
        .with("points", points(all))
        .with("fill", "none")
}

/// Runs of neighbouring sites whose margin and depth are known.
fn runs(spots: &[Option<Spot>], y: impl Fn(f64) -> f64) -> Vec<Run> {
    // Without a call of recession the margin is not known, nor the attachment below it.
    let known = |spot: &Option<Spot>| -> Option<(f64, f64, f64)> {
        let spot = (*spot)?;
        let margin = spot.recession?;
        Some((spot.x, y(margin), y(margin + spot.depth?)))
    };
    let all: Vec<Option<(f64, f64, f64)>> = spots.iter().map(known).collect();
    let mut runs = Vec::new();
    for run in all.split(Option::is_none) {
        let mut run: Vec<(f64, f64, f64)> = run.iter().flatten().copied().collect();
        // A single site has a width too.
        if let [(x, margin, floor)] = run[..] {
            run = vec![(x - 6.0, margin, floor), (x + 6.0, margin, floor)];
        }
        if !run.is_empty() {
            runs.push(Run {
                margin: run.iter().map(|at| (at.0, at.1)).collect(),
                floor: run.iter().map(|at| (at.0, at.2)).collect(),
            });
        }
    }
    runs
}
