//! Heat map of a class: calls within 1 mm and mean error, for every site.

use sulcus_core::tissue::gingiva::Site;

use super::super::jaw::{Jaw, Numbering, across};
use super::super::svg::Svg;
use crate::grade::class::Session;
use crate::grade::stats::{mean, percent, rounded};

/// Width of a cell.
const CELL: f64 = 40.0;
/// Height of a cell.
const HIGH: f64 = 27.0;
/// Width of the labels on the left.
const LEFT: f64 = 54.0;
/// Width of a tooth: three cells and a gap.
const TOOTH: f64 = 3.0 * CELL + 10.0;

/// Calls of a class at one site.
struct Calls {
    /// Calls within 1 mm of the prescribed depth, percent of the sessions. A missed site counts as not within.
    within: Option<f64>,
    /// Mean of called minus prescribed depth, mm.
    bias: Option<f64>,
}

impl Calls {
    /// Calls at a site of the exercise; none if no session asks for the site.
    fn of(all: &[&Session], tooth: u8, site: Site) -> Option<Self> {
        let zones: Vec<_> = all
            .iter()
            .flat_map(|session| &session.grade.sites)
            .filter(|one| one.asked && (one.tooth, one.site) == (tooth, site))
            .collect();
        if zones.is_empty() {
            return None;
        }
        let errors: Vec<f64> = zones.iter().filter_map(|one| one.error_mm()).collect();
        let near = errors
            .iter()
            .filter(|error| error.abs() <= 1.0 + 1e-9)
            .count();
        Some(Self {
            within: percent(near, zones.len()),
            bias: mean(&errors),
        })
    }
}

/// Maps of the jaws with teeth of the exercise, six cells to a tooth, arranged as on a chart.
pub fn maps(all: &[&Session], numbering: Numbering) -> Vec<Svg> {
    let mut maps = Vec::new();
    for jaw in [Jaw::Upper, Jaw::Lower] {
        let is_asked = |fdi: &u8| {
            let mut sites = Site::ALL.iter();
            sites.any(|site| Calls::of(all, *fdi, *site).is_some())
        };
        let teeth: Vec<u8> = jaw.teeth().into_iter().filter(is_asked).collect();
        if !teeth.is_empty() {
            maps.push(map(all, jaw, &teeth, numbering));
        }
    }
    maps
}

fn map(all: &[&Session], jaw: Jaw, teeth: &[u8], numbering: Numbering) -> Svg {
    let width = 60.0 + TOOTH * teeth.len() as f64;
    let height = 2.0 * HIGH + 20.0;
    Svg::drawing(
        |svg| {
            svg.with("viewBox", format_args!("0 0 {width:.0} {height:.0}"))
                .with("style", format_args!("max-width:{width:.0}px"))
                .with("role", "img")
                .with(
                    "aria-label",
                    format_args!("heat map of sites, {}", jaw.name()),
                )
                .with("font-size", 10)
        },
        |svg| {
            let tops = [0.0, HIGH + 18.0];
            for ((buccal, name), top) in jaw.rows().into_iter().zip(tops) {
                svg.element("text")
                    .with("x", 0)
                    .at("y", top + 0.6 * HIGH)
                    .text(name);
                for (k, fdi) in teeth.iter().enumerate() {
                    for (j, site) in across(*fdi, buccal).into_iter().enumerate() {
                        let x = LEFT + TOOTH * k as f64 + CELL * j as f64;
                        cell(svg, Calls::of(all, *fdi, site), (x, top));
                    }
                }
            }
            for (k, fdi) in teeth.iter().enumerate() {
                svg.element("text")
                    .xy(LEFT + TOOTH * k as f64 + 1.5 * CELL, HIGH + 13.0)
                    .with("font-size", 12)
                    .with("font-weight", 700)
                    .with("text-anchor", "middle")
                    .text(numbering.of(*fdi));
            }
        },
    )
}

/// Cell of a site: darker with fewer calls within 1 mm, empty if the site is not asked for.
fn cell(svg: &mut Svg, calls: Option<Calls>, (x, y): (f64, f64)) {
    let frame = svg
        .element("rect")
        .xy(x, y)
        .with("width", CELL)
        .with("height", HIGH);
    let Some(calls) = calls else {
        frame.with("fill", "none").with("stroke", "#ccc").end();
        return;
    };
    let within = calls.within.unwrap_or_default();
    // From white to a red that is nearly black in grey.
    let mix = |full: f64| (255.0 - (255.0 - full) * (1.0 - within / 100.0)).round() as u8;
    let (r, g, b) = (mix(122.0), mix(10.0), mix(30.0));
    frame
        .with("fill", format_args!("rgb({r},{g},{b})"))
        .with("stroke", "#333")
        .end();
    let ink = if within < 55.0 { "#fff" } else { "#000" };
    svg.element("text")
        .xy(x + 0.5 * CELL, y + 12.0)
        .with("text-anchor", "middle")
        .with("font-weight", 700)
        .with("fill", ink)
        .text(format_args!("{within:.0} %"));
    let bias = calls.bias.map_or("–".into(), |bias| {
        format!("{:+.1}", rounded(bias, 1)).replace('-', "−")
    });
    svg.element("text")
        .xy(x + 0.5 * CELL, y + 23.0)
        .with("text-anchor", "middle")
        .with("font-size", 9)
        .with("fill", ink)
        .text(bias);
}
