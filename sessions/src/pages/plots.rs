//! Depth and force over time: what the tip did, with the zones that it was in below, and the target band of force.

use std::fmt::Write as _;

use super::escaped;
use crate::grade::Graded;
use crate::grade::motion::series::{Point, STEP_S};

const WIDTH: f64 = 760.0;
const LEFT: f64 = 60.0;
const RIGHT: f64 = 6.0;
const HIGH: f64 = 46.0;
/// Most columns that a plot is made of.
const COLUMNS: usize = 1400;

/// One column of a plot.
struct Column {
    zone: Option<(u8, usize)>,
    /// Deepest, mm.
    depth: f64,
    /// Heaviest, newtons.
    force: f64,
    visible: Option<bool>,
}

/// A plot, and what it shows.
pub struct Plot {
    /// What it shows, as HTML.
    pub title: String,
    /// The picture.
    pub svg: String,
}

/// The plot of a session: force on the floor and depth where a pocket was probed, else the force on the leading tool; none where there is
/// nothing to draw.
pub fn plot(graded: &Graded, number: impl Fn(u8) -> String) -> Option<Plot> {
    let points = &graded.series.0;
    let probed = points.iter().any(|point| point.zone.is_some());
    let each = points.len().div_ceil(COLUMNS).max(1);
    let columns: Vec<Column> = points
        .chunks(each)
        .map(|chunk| {
            let most = |of: fn(&Point) -> f64| {
                let larger = |a: f64, b| if b > a { b } else { a };
                chunk.iter().map(of).fold(0.0, larger)
            };
            let zone = chunk.iter().rev().find_map(|point| point.zone);
            Column {
                zone: zone.map(|(tooth, site)| (tooth, site as usize)),
                depth: most(|point| point.depth) * 1e3,
                force: most(if probed {
                    |point| point.force
                } else {
                    |point| point.push
                }),
                visible: chunk.last().and_then(|point| point.visible),
            }
        })
        .collect();
    if columns
        .iter()
        .all(|column| column.force <= 0.0 && column.zone.is_none())
    {
        return None;
    }
    let seconds = points.len() as f64 * STEP_S;
    let x = |k: f64| LEFT + (WIDTH - LEFT - RIGHT) * k / columns.len() as f64;
    let largest = |least: f64, of: fn(&Column) -> f64| columns.iter().map(of).fold(least, f64::max);
    let deepest = largest(4.0, |column| column.depth).ceil();
    let heaviest = (largest(0.4, |column| column.force) * 10.0).ceil() / 10.0;
    let sight = columns.iter().any(|column| column.visible.is_some());
    let (force_top, depth_top) = (4.0, HIGH + 16.0);
    let zones_top = depth_top + HIGH + 4.0;
    let sight_top = if probed {
        zones_top + 15.0
    } else {
        HIGH + 10.0
    };
    let time_top = sight_top + if sight { 12.0 } else { 0.0 };
    let mut svg = format!(
        "<svg viewBox=\"0 0 {WIDTH} {:.0}\" role=\"img\" aria-label=\"force{} over time\" font-size=\"9.5\">\n",
        time_top + 16.0,
        if probed { " and depth" } else { "" }
    );
    // Force: up is heavier.
    let force_y = |n: f64| force_top + HIGH * (1.0 - n / heaviest);
    let band = graded.grade.force_band_n.filter(|_| probed);
    if let Some([least, most]) = band {
        let (low, high) = (force_y(least), force_y(most));
        let _ = writeln!(
            svg,
            "<rect x=\"{LEFT}\" y=\"{high:.1}\" width=\"{:.1}\" height=\"{:.1}\" fill=\"#dcdcdc\"/>",
            WIDTH - LEFT - RIGHT,
            low - high
        );
    }
    axis(&mut svg, force_top, "force, N", &[0.0, heaviest], &force_y);
    let up = |column: &Column| (force_y(column.force), force_y(0.0));
    bars(&mut svg, &columns, &x, up, "#333");
    // From here on healthy tissue bleeds.
    let trauma = graded
        .trauma_n
        .filter(|trauma| probed && heaviest >= *trauma);
    if let Some(trauma) = trauma {
        let y = force_y(trauma);
        let _ = writeln!(
            svg,
            "<line x1=\"{LEFT}\" y1=\"{y:.1}\" x2=\"{:.1}\" y2=\"{y:.1}\" stroke=\"#c4122f\" stroke-width=\"1.2\" stroke-dasharray=\"5 2\"/>",
            WIDTH - RIGHT
        );
    }
    if probed {
        // Depth: down is deeper, as in the mouth.
        let depth_y = |mm: f64| depth_top + HIGH * mm / deepest;
        let marks = [0.0, 0.5 * deepest, deepest];
        axis(&mut svg, depth_top, "depth, mm", &marks, &depth_y);
        let down = |column: &Column| (depth_y(0.0), depth_y(column.depth));
        bars(&mut svg, &columns, &x, down, "#123a8c");
        zones(&mut svg, &columns, &x, zones_top, number);
    }
    if sight {
        seen(&mut svg, &columns, &x, sight_top);
    }
    time_axis(&mut svg, seconds, time_top, WIDTH - LEFT - RIGHT);
    svg.push_str("</svg>\n");
    let said = [
        band.map(|[least, most]| format!("grey: target {least} to {most} N")),
        trauma.map(|trauma| format!("broken line: trauma from {trauma} N")),
    ];
    let said: Vec<String> = said.into_iter().flatten().collect();
    let key = match said[..] {
        [] => String::new(),
        _ => format!(" <span class=\"small\">{}</span>", said.join("; ")),
    };
    let title = match probed {
        true => format!("Force on the floor, and depth of the tip{key}"),
        false => format!("Force on the {}", escaped(&graded.leads)),
    };
    Some(Plot { title, svg })
}

/// When the target was seen, as a bar.
fn seen(svg: &mut String, columns: &[Column], x: &dyn Fn(f64) -> f64, top: f64) {
    let _ = write!(
        svg,
        "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">target seen</text>",
        LEFT - 3.0,
        top + 8.0
    );
    let mut from = 0;
    for run in columns.chunk_by(|a, b| a.visible == b.visible) {
        let (a, b) = (x(from as f64), x((from + run.len()) as f64));
        if run[0].visible == Some(true) {
            let _ = write!(
                svg,
                "<rect x=\"{a:.1}\" y=\"{:.1}\" width=\"{:.1}\" height=\"6\" fill=\"#555\"/>",
                top + 2.0,
                b - a
            );
        }
        from += run.len();
    }
    svg.push('\n');
}

fn axis(svg: &mut String, top: f64, name: &str, marks: &[f64], y: &dyn Fn(f64) -> f64) {
    let _ = write!(
        svg,
        "<text transform=\"translate(24,{:.1}) rotate(-90)\" text-anchor=\"middle\">{name}</text>",
        top + 0.5 * HIGH
    );
    for mark in marks {
        let at = y(*mark);
        let _ = write!(
            svg,
            "<line x1=\"{LEFT}\" y1=\"{at:.1}\" x2=\"{:.1}\" y2=\"{at:.1}\" stroke=\"#999\" stroke-width=\"0.6\"/><text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">{mark}</text>",
            WIDTH - RIGHT,
            LEFT - 3.0,
            at + 3.0
        );
    }
    svg.push('\n');
}

/// The columns as one filled shape; those of nothing are left out.
fn bars(
    svg: &mut String,
    columns: &[Column],
    x: &dyn Fn(f64) -> f64,
    span: impl Fn(&Column) -> (f64, f64),
    colour: &str,
) {
    let mut path = String::new();
    for (k, column) in columns.iter().enumerate() {
        let (top, bottom) = span(column);
        if bottom - top > 0.05 {
            let (a, b) = (x(k as f64), x(k as f64 + 1.0));
            let _ = write!(path, "M{a:.1},{bottom:.1}V{top:.1}H{b:.1}V{bottom:.1}Z");
        }
    }
    let _ = writeln!(svg, "<path d=\"{path}\" fill=\"{colour}\"/>");
}

/// Which zone the tip was in, as a line of names.
fn zones(
    svg: &mut String,
    columns: &[Column],
    x: &dyn Fn(f64) -> f64,
    top: f64,
    number: impl Fn(u8) -> String,
) {
    const SHORT: [&str; 6] = ["MB", "B", "DB", "DL", "L", "ML"];
    let mut from = 0;
    for run in columns.chunk_by(|a, b| a.zone == b.zone) {
        let (a, b) = (x(from as f64), x((from + run.len()) as f64));
        if let Some((tooth, site)) = run[0].zone {
            let _ = write!(
                svg,
                "<rect x=\"{a:.1}\" y=\"{top:.1}\" width=\"{:.1}\" height=\"12\" fill=\"#f0f0f0\" stroke=\"#777\" stroke-width=\"0.5\"/>",
                b - a
            );
            // A name where it has room.
            if b - a >= 30.0 {
                let _ = write!(
                    svg,
                    "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{} {}</text>",
                    0.5 * (a + b),
                    top + 9.5,
                    number(tooth),
                    SHORT[site]
                );
            } else if b - a >= 13.0 {
                let _ = write!(
                    svg,
                    "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{}</text>",
                    0.5 * (a + b),
                    top + 9.5,
                    SHORT[site]
                );
            }
        }
        from += run.len();
    }
    svg.push('\n');
}

fn time_axis(svg: &mut String, seconds: f64, top: f64, width: f64) {
    let step = [1.0, 2.0, 5.0, 10.0, 30.0, 60.0, 300.0, 600.0, 1800.0]
        .into_iter()
        .find(|step| seconds / step <= 12.0)
        .unwrap_or(3600.0);
    let mut at = 0.0;
    while at <= seconds {
        let _ = write!(
            svg,
            "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{at} s</text>",
            LEFT + width * at / seconds,
            top + 12.0
        );
        at += step;
    }
}
