//! Speed against error by level, tissue, solver and method: the plot and its table.

use std::fmt::Write;

use super::super::html::escaped;
use super::super::plot::{Plot, Series};
use crate::report::{Cell, Report, TickUs};

/// What serves as nothing on a logarithmic axis, percent.
const NOTHING: f64 = 1e-3;
/// Ticks from which there is a slowest of a thousand.
const TAIL: usize = 1_000;

pub(super) fn matrix(html: &mut String, report: &Report) {
    let cells = &report.matrix;
    if cells.is_empty() {
        return;
    }
    html.push_str("<section id=\"matrix\"><h2>Level, tissue, solver, method</h2>\n<p class=\"note\">One hand a scene, recorded in the scene as it is shipped; every combination is given that same hand. <b>Force off</b>: rms difference of the raw force to that of the reference (the finest level, coupled, by the judge; in a quick report by the tick's own solver) in percent of it. <b>Shape off</b>: what is touched against what is drawn, at rest, mean. The judge is slow: but for the reference it solves the first ticks at work alone (<b>ticks</b>); <b>at first</b> is what all are off by over just these, so that solvers can be compared. Of fewer than 1,000 ticks there is no p99.9. Times are CPU time of ticks in contact. <b>Printed</b>: tissue as the paper has it; where nothing yields there is nothing to print.</p>\n<div class=\"two\">");
    for (solver, title, x, y) in [
        (
            "active_set",
            "the tick's own solver",
            tail(cells).0,
            "force off, %",
        ),
        ("clarabel", "the judge", "p50", "force off at first, %"),
    ] {
        let plot = Plot {
            x: format!("time of a tick at {x}, us: {title}"),
            y: y.into(),
            log: (true, true),
            series: series(cells, solver),
            limit: None,
        };
        let svg = plot.svg();
        if !svg.is_empty() {
            let _ = write!(
                html,
                "<figure>{svg}<figcaption>By {title}. Points of a line are levels, coarse to fine. Good is down and left; 1,000 µs is the limit at 1 kHz. (The reference itself stands at {NOTHING} %.)</figcaption></figure>"
            );
        }
    }
    html.push_str("</div>\n<div class=\"wide\"><table class=\"small\"><thead><tr><th>scene</th><th>yields</th><th>method</th><th>solver</th><th>level</th><th>spheres</th><th>ticks</th><th>p50, µs</th><th>p99</th><th>p99.9</th><th>shape off, µm</th><th>force off, %</th><th>at first</th><th>residual, µm</th><th>jump, µm</th><th>click, N</th><th>buzz, N</th><th>outrun</th></tr></thead><tbody>\n");
    for cell in cells {
        let t = &cell.times.tick_us;
        let mark = match (cell.shipped, cell.reference) {
            (true, true) => " (shipped, reference)",
            (true, false) => " (shipped)",
            (false, true) => " (reference)",
            (false, false) => "",
        };
        let _ = writeln!(
            html,
            "<tr><td>{}</td><td class=\"text\">{}</td><td class=\"text\">{}</td><td class=\"text\">{}</td><td>{}{mark}</td><td>{}</td><td>{}</td><td>{:.1}</td><td>{:.1}</td><td>{}</td><td>{:.0}</td><td>{:.2}</td><td>{}</td><td>{:.3}</td><td>{:.0}</td><td>{:.4}</td><td>{:.4}</td><td>{}</td></tr>",
            cell.scene,
            escaped(&cell.tissue.replace('_', " ")),
            cell.method,
            if cell.solver == "clarabel" {
                "judge"
            } else {
                "own"
            },
            cell.level,
            cell.spheres,
            cell.times.ticks,
            t.p50,
            t.p99,
            if cell.times.ticks < TAIL {
                "–".to_owned()
            } else {
                format!("{:.1}", t.p999)
            },
            cell.shape_error_um,
            cell.force_off_percent,
            cell.force_off_at_first_percent
                .map_or("–".to_owned(), |off| format!("{off:.2}")),
            cell.residual_um,
            cell.graphic_jump_um,
            cell.slow_force_step_n,
            cell.buzz_n,
            cell.exhausted_ticks,
        );
    }
    html.push_str("</tbody></table></div>\n<p class=\"note\">Error of the tissue models themselves, against finite elements, stands <a href=\"#elements\">below</a>.</p></section>\n");
}

/// The rarest of slow ticks that all cells by the own solver have enough ticks for: its name and its value.
fn tail(cells: &[Cell]) -> (&'static str, fn(&TickUs) -> f64) {
    let mut own = cells.iter().filter(|cell| cell.solver != "clarabel");
    match own.all(|cell| cell.times.ticks >= TAIL) {
        true => ("p99.9", |us| us.p999),
        false => ("p99", |us| us.p99),
    }
}

/// A line for each scene and method, its points the levels.
fn series(cells: &[Cell], solver: &str) -> Vec<Series> {
    let of_tail = tail(cells).1;
    let mut all: Vec<Series> = Vec::new();
    let mut cells: Vec<&Cell> = cells.iter().filter(|cell| cell.solver == solver).collect();
    cells.sort_by_key(|cell| cell.level);
    for cell in cells {
        let name = format!("{}, {}", cell.scene, cell.method);
        let us = &cell.times.tick_us;
        let (us, off) = match solver {
            "clarabel" => (us.p50, cell.force_off_at_first_percent),
            _ => (of_tail(us), Some(cell.force_off_percent)),
        };
        let Some(off) = off.filter(|off| off.is_finite()) else {
            continue;
        };
        let point = (us, off.max(NOTHING));
        match all.iter_mut().find(|line| line.name == name) {
            Some(line) => line.points.push(point),
            None => all.push(Series {
                name,
                points: vec![point],
                joined: true,
            }),
        }
    }
    all
}
