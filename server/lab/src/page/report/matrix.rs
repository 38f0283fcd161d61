//! Speed against error by level, tissue, solver and method: the plots of the table.

use super::Svg;
use crate::page::plot::{Plot, Series};
use crate::report::{Cell, TickUs};

/// Value of zero on a logarithmic axis, percent.
const NOTHING: f64 = 1e-3;
/// Least number of ticks with a 99.9th percentile.
const TAIL: usize = 1_000;

/// The plots of the table.
pub(super) struct Matrix {
    pub(super) figures: Vec<Figure>,
    /// Value of zero on the axis of errors, percent.
    pub(super) nothing: f64,
}

/// The plot of one solver.
pub(super) struct Figure {
    pub(super) plot: Svg,
    /// Name of the solver, for people.
    pub(super) solver: &'static str,
}

impl Matrix {
    /// The plots that have a point.
    pub(super) fn of(cells: &[Cell]) -> Self {
        let solvers = [
            (
                "active_set",
                "the tick's own solver",
                tail(cells).0,
                "force off, %",
            ),
            ("clarabel", "the judge", "p50", "force off at first, %"),
        ];
        let figure = |(solver, title, x, y): (&str, &'static str, &str, &str)| {
            let plot = Plot {
                x: format!("time of a tick at {x}, us: {title}"),
                y: y.into(),
                log: (true, true),
                series: series(cells, solver),
                limit: None,
            };
            Figure {
                plot: plot.svg(),
                solver: title,
            }
        };
        let figures = solvers.into_iter().map(figure);
        Self {
            figures: figures.filter(|figure| !figure.plot.is_empty()).collect(),
            nothing: NOTHING,
        }
    }

    /// The 99.9th percentile of a cell with enough ticks, microseconds.
    pub(super) fn tail(cell: &Cell) -> Option<f64> {
        (cell.times.ticks >= TAIL).then_some(cell.times.tick_us.p999)
    }
}

/// The highest percentile for which all cells by the own solver have enough ticks: its name and its value.
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
            None => all.push(Series::joined(name, vec![point])),
        }
    }
    all
}
