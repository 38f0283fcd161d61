//! Table of every combination of level, tissue, solver and method.

use super::COMMAND;
use super::table::{Table, number, tick_cells};
use crate::report::Report;

/// Time of a tick beside the difference of the force, combination by combination.
pub(super) fn matrix(report: &Report) -> Table {
    let rows = report.matrix.iter().map(|cell| {
        let [p50, p99, p999] = tick_cells(&cell.times);
        let role = match (cell.shipped, cell.reference) {
            (true, true) => "shipped, reference",
            (true, false) => "shipped",
            (false, true) => "reference",
            (false, false) => "",
        };
        vec![
            cell.scene.to_owned(),
            cell.tissue.replace('_', " "),
            cell.method.to_owned(),
            cell.solver.replace('_', " "),
            format!("{}", cell.level),
            role.to_owned(),
            format!("{}", cell.spheres),
            format!("{}", cell.times.ticks),
            p50,
            p99,
            p999,
            number(cell.shape_error_um),
            number(cell.force_off_percent),
            cell.force_off_at_first_percent
                .map_or_else(|| "–".to_owned(), number),
            number(cell.residual_um),
            number(cell.buzz_n * 1e3),
        ]
    });
    Table {
        caption: "Case: one recorded hand in each scene; reference: the finest level by the coupled method with the judge, the solver Clarabel; quantities: CPU time of a tick in contact, distance of the touched shape from the drawn one, and rms difference of the raw force over the rms force, over all ticks and over the first ticks, which every solver ran.".to_owned(),
        command: COMMAND.to_owned(),
        columns: vec![
            "scene",
            "tissue",
            "method",
            "solver",
            "level",
            "role",
            "spheres",
            "ticks",
            "tick p50, us",
            "tick p99, us",
            "tick p99.9, us",
            "shape error mean, um",
            "force difference, %",
            "force difference of the first ticks, %",
            "residual max, um",
            "buzz, mN",
        ],
        rows: rows.collect(),
        notes: Vec::new(),
    }
}
