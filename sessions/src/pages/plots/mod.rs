//! Force and depth over time, with the zones of the tip, the target band of force, and the times of a visible target.

mod axes;
mod columns;

use std::fmt::Write as _;

use super::jaw::Numbering;
use super::svg::Svg;
use crate::grade::Graded;
use crate::grade::motion::series::STEP_S;
use columns::{Column, columns};

const WIDTH: f64 = 760.0;
/// Width of the labels on the left.
const LEFT: f64 = 60.0;
/// Margin on the right.
const RIGHT: f64 = 6.0;
/// Height of one plot.
const HIGH: f64 = 46.0;
/// Upper edge of the plot of force.
const FORCE_TOP: f64 = 4.0;
/// Upper edge of the plot of depth.
const DEPTH_TOP: f64 = HIGH + 16.0;

/// Plot with its title, as the template takes it.
pub struct Plot {
    /// Title.
    pub title: String,
    /// Meaning of band and line; may be empty.
    pub key: String,
    /// Drawing.
    pub drawing: Svg,
}

/// Plot of a session. If a pocket was probed: force on the floor, and depth. Else: force on the leading tool.
/// None without force and without a probed pocket.
pub fn plot(graded: &Graded, numbering: Numbering) -> Option<Plot> {
    let points = &graded.series.0;
    let probed = points.iter().any(|point| point.zone.is_some());
    let columns = columns(points, probed);
    if columns
        .iter()
        .all(|column| column.force <= 0.0 && column.zone.is_none())
    {
        return None;
    }
    let largest = |least: f64, of: fn(&Column) -> f64| columns.iter().map(of).fold(least, f64::max);
    let heaviest = (largest(0.4, |column| column.force) * 10.0).ceil() / 10.0;
    let deepest = largest(4.0, |column| column.depth).ceil();
    let band = graded.grade.force_band_n.filter(|_| probed);
    let trauma = graded
        .trauma_n
        .filter(|trauma| probed && heaviest >= *trauma);
    let drawing = Drawing {
        columns,
        seconds: points.len() as f64 * STEP_S,
        probed,
        heaviest,
        deepest,
        band,
        trauma,
        numbering,
    };
    let key = [
        band.map(|[least, most]| format!("grey: target {least} to {most} N")),
        trauma.map(|trauma| format!("broken line: trauma from {trauma} N")),
    ];
    let key: Vec<String> = key.into_iter().flatten().collect();
    Some(Plot {
        title: match probed {
            true => "Force on the floor, and depth of the tip".into(),
            false => format!("Force on the {}", graded.leads),
        },
        key: key.join("; "),
        drawing: drawing.svg(),
    })
}

/// Content of the drawing.
struct Drawing {
    columns: Vec<Column>,
    seconds: f64,
    probed: bool,
    /// Upper end of the scale of force, newtons.
    heaviest: f64,
    /// Lower end of the scale of depth, mm.
    deepest: f64,
    /// Target band of force, newtons.
    band: Option<[f64; 2]>,
    /// Force from which healthy tissue bleeds, newtons.
    trauma: Option<f64>,
    numbering: Numbering,
}

impl Drawing {
    fn svg(&self) -> Svg {
        let sight = self.columns.iter().any(|column| column.visible.is_some());
        let zones_top = DEPTH_TOP + HIGH + 4.0;
        let sight_top = match self.probed {
            true => zones_top + 15.0,
            false => HIGH + 10.0,
        };
        let time_top = sight_top + if sight { 12.0 } else { 0.0 };
        let depth = if self.probed { " and depth" } else { "" };
        Svg::drawing(
            |svg| {
                svg.with(
                    "viewBox",
                    format_args!("0 0 {WIDTH} {:.0}", time_top + 16.0),
                )
                .with("role", "img")
                .with("aria-label", format_args!("force{depth} over time"))
                .with("font-size", 9.5)
            },
            |svg| {
                self.force(svg);
                if self.probed {
                    self.depth(svg);
                    self.zones(svg, zones_top);
                }
                if sight {
                    self.seen(svg, sight_top);
                }
                axes::time(svg, self.seconds, time_top);
            },
        )
    }

    /// Place of the beginning of column `k`.
    fn x(&self, k: usize) -> f64 {
        LEFT + (WIDTH - LEFT - RIGHT) * k as f64 / self.columns.len() as f64
    }

    /// Plot of force: up is heavier.
    fn force(&self, svg: &mut Svg) {
        let y = |n: f64| FORCE_TOP + HIGH * (1.0 - n / self.heaviest);
        if let Some([least, most]) = self.band {
            let (low, high) = (y(least), y(most));
            svg.element("rect")
                .with("x", LEFT)
                .at("y", high)
                .at("width", WIDTH - LEFT - RIGHT)
                .at("height", low - high)
                .with("fill", "#dcdcdc")
                .end();
        }
        axes::values(svg, FORCE_TOP, "force, N", &[0.0, self.heaviest], y);
        self.bars(svg, |column| (y(column.force), y(0.0)), "#333");
        if let Some(trauma) = self.trauma {
            svg.across(y(trauma), LEFT, format_args!("{:.1}", WIDTH - RIGHT))
                .stroke("#c4122f", 1.2)
                .with("stroke-dasharray", "5 2")
                .end();
        }
    }

    /// Plot of depth: down is deeper, as in the mouth.
    fn depth(&self, svg: &mut Svg) {
        let y = |mm: f64| DEPTH_TOP + HIGH * mm / self.deepest;
        let marks = [0.0, 0.5 * self.deepest, self.deepest];
        axes::values(svg, DEPTH_TOP, "depth, mm", &marks, y);
        self.bars(svg, |column| (y(0.0), y(column.depth)), "#123a8c");
    }

    /// All columns as one filled shape. A column below a twentieth of a unit is left out.
    fn bars(&self, svg: &mut Svg, span: impl Fn(&Column) -> (f64, f64), colour: &str) {
        let mut path = String::new();
        for (k, column) in self.columns.iter().enumerate() {
            let (top, bottom) = span(column);
            if bottom - top > 0.05 {
                let (a, b) = (self.x(k), self.x(k + 1));
                let _ = write!(path, "M{a:.1},{bottom:.1}V{top:.1}H{b:.1}V{bottom:.1}Z");
            }
        }
        svg.element("path")
            .with("d", path)
            .with("fill", colour)
            .end();
    }

    /// Zones of the tip as a line of boxes, with names in boxes that have room.
    fn zones(&self, svg: &mut Svg, top: f64) {
        const SHORT: [&str; 6] = ["MB", "B", "DB", "DL", "L", "ML"];
        for (first, (a, b)) in self.runs(|a, b| a.zone == b.zone) {
            let Some((tooth, site)) = first.zone else {
                continue;
            };
            svg.element("rect")
                .xy(a, top)
                .at("width", b - a)
                .with("height", 12)
                .with("fill", "#f0f0f0")
                .stroke("#777", 0.5)
                .end();
            let name = match b - a {
                wide if wide >= 30.0 => format!("{} {}", self.numbering.of(tooth), SHORT[site]),
                wide if wide >= 13.0 => SHORT[site].to_owned(),
                _ => continue,
            };
            svg.element("text")
                .xy(0.5 * (a + b), top + 9.5)
                .with("text-anchor", "middle")
                .text(name);
        }
    }

    /// Times of a visible target, as bars.
    fn seen(&self, svg: &mut Svg, top: f64) {
        svg.element("text")
            .xy(LEFT - 3.0, top + 8.0)
            .with("text-anchor", "end")
            .text("target seen");
        for (first, (a, b)) in self.runs(|a, b| a.visible == b.visible) {
            if first.visible == Some(true) {
                svg.element("rect")
                    .xy(a, top + 2.0)
                    .at("width", b - a)
                    .with("height", 6)
                    .with("fill", "#555")
                    .end();
            }
        }
    }

    /// Runs of alike columns: the first column, and the places of beginning and end.
    fn runs(
        &self,
        alike: impl Fn(&Column, &Column) -> bool,
    ) -> impl Iterator<Item = (&Column, (f64, f64))> {
        let mut from = 0;
        self.columns.chunk_by(alike).map(move |run| {
            let ends = (self.x(from), self.x(from + run.len()));
            from += run.len();
            (&run[0], ends)
        })
    }
}
