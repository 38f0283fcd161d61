//! Depth and force over time: what the tip did, with the zones that it was in below, and the target band of force.

use std::fmt::Write as _;

use crate::grade::series::{STEP_S, Series};

const WIDTH: f64 = 760.0;
const LEFT: f64 = 60.0;
const RIGHT: f64 = 6.0;
const HIGH: f64 = 52.0;
/// What keeps words readable over bars.
const HALO: &str = "paint-order=\"stroke\" stroke=\"#fff\" stroke-width=\"3\"";
/// Most columns that a plot is made of.
const COLUMNS: usize = 1400;

/// One column: zone, deepest (mm), heaviest (N), whether the target was visible.
type Column = (Option<(u8, usize)>, f64, f64, Option<bool>);

/// The plot of a session; `band` is the target band of force, `trauma` the force from which healthy tissue of the scene bleeds, newtons.
/// Empty where there is nothing to draw.
pub fn svg(
    series: &Series,
    band: [f64; 2],
    trauma: Option<f64>,
    number: impl Fn(u8) -> String,
) -> String {
    let points = &series.0;
    if points.iter().all(|point| point.zone.is_none()) {
        return String::new();
    }
    let each = points.len().div_ceil(COLUMNS).max(1);
    let columns: Vec<Column> = points
        .chunks(each)
        .map(|chunk| {
            let most = |of: fn(&crate::grade::Point) -> f64| {
                chunk
                    .iter()
                    .map(of)
                    .fold(0.0, |a: f64, b| if b > a { b } else { a })
            };
            let last = chunk.last().and_then(|point| point.visible);
            let zone = chunk.iter().rev().find_map(|point| point.zone);
            (
                zone.map(|(tooth, site)| (tooth, site as usize)),
                most(|point| point.depth) * 1e3,
                most(|point| point.force),
                last,
            )
        })
        .collect();
    let seconds = points.len() as f64 * STEP_S;
    let x = |k: f64| LEFT + (WIDTH - LEFT - RIGHT) * k / columns.len() as f64;
    let deepest = columns.iter().map(|c| c.1).fold(4.0, f64::max).ceil();
    let heaviest = columns.iter().map(|c| c.2).fold(0.4, f64::max);
    let heaviest = (heaviest * 10.0).ceil() / 10.0;
    let sight = columns.iter().any(|c| c.3.is_some());
    let (force_top, depth_top) = (4.0, HIGH + 16.0);
    let zones_top = depth_top + HIGH + 4.0;
    let height = zones_top + 15.0 + if sight { 12.0 } else { 0.0 } + 16.0;
    let mut svg = format!(
        "<svg viewBox=\"0 0 {WIDTH} {height:.0}\" role=\"img\" aria-label=\"force and depth over time\" font-size=\"9.5\">\n"
    );
    // Force: up is heavier.
    let force_y = |n: f64| force_top + HIGH * (1.0 - n / heaviest);
    let (low, high) = (force_y(band[0]), force_y(band[1]));
    let _ = writeln!(
        svg,
        "<rect x=\"{LEFT}\" y=\"{high:.1}\" width=\"{:.1}\" height=\"{:.1}\" fill=\"#dcdcdc\"/>",
        WIDTH - LEFT - RIGHT,
        low - high
    );
    axis(&mut svg, force_top, "force, N", &[0.0, heaviest], &force_y);
    bars(
        &mut svg,
        &columns,
        &x,
        |c| (force_y(c.2), force_y(0.0)),
        "#333",
    );
    let _ = writeln!(
        svg,
        "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\" {HALO}>target {} to {} N</text>",
        WIDTH - RIGHT - 2.0,
        high - 2.0,
        band[0],
        band[1]
    );
    // From here on healthy tissue bleeds.
    if let Some(trauma) = trauma.filter(|trauma| heaviest >= *trauma) {
        let y = force_y(trauma);
        let _ = writeln!(
            svg,
            "<line x1=\"{LEFT}\" y1=\"{y:.1}\" x2=\"{0:.1}\" y2=\"{y:.1}\" stroke=\"#c4122f\" stroke-width=\"1.2\" stroke-dasharray=\"5 2\"/><text x=\"{1:.1}\" y=\"{2:.1}\" text-anchor=\"end\" {HALO}>trauma from {trauma} N</text>",
            WIDTH - RIGHT,
            WIDTH - RIGHT - 2.0,
            y - 2.0
        );
    }
    // Depth: down is deeper, as in the mouth.
    let depth_y = |mm: f64| depth_top + HIGH * mm / deepest;
    axis(
        &mut svg,
        depth_top,
        "depth, mm",
        &[0.0, 0.5 * deepest, deepest],
        &depth_y,
    );
    bars(
        &mut svg,
        &columns,
        &x,
        |c| (depth_y(0.0), depth_y(c.1)),
        "#123a8c",
    );
    zones(&mut svg, &columns, &x, zones_top, number);
    let mut below = zones_top + 15.0;
    if sight {
        let _ = write!(
            svg,
            "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">target seen</text>",
            LEFT - 3.0,
            below + 8.0
        );
        let mut from = 0;
        for run in columns.chunk_by(|a, b| a.3 == b.3) {
            let (a, b) = (x(from as f64), x((from + run.len()) as f64));
            if run[0].3 == Some(true) {
                let _ = write!(
                    svg,
                    "<rect x=\"{a:.1}\" y=\"{:.1}\" width=\"{:.1}\" height=\"6\" fill=\"#555\"/>",
                    below + 2.0,
                    b - a
                );
            }
            from += run.len();
        }
        below += 12.0;
    }
    time_axis(&mut svg, seconds, below, WIDTH - LEFT - RIGHT);
    svg + "</svg>\n"
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
        if column.0.is_some() && bottom - top > 0.05 {
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
    for run in columns.chunk_by(|a, b| a.0 == b.0) {
        let (a, b) = (x(from as f64), x((from + run.len()) as f64));
        if let Some((tooth, site)) = run[0].0 {
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
