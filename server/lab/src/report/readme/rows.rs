//! Tables of the hard cases and of the random poses.

use super::table::{Table, number, tick_cells};
use super::{COMMAND, yes_no};
use crate::report::{Report, Row};

/// Number of slowest cases in the table.
const SLOWEST: usize = 12;

/// The case with the largest value, and the value.
fn most<'a>(rows: &[&'a Row], value: fn(&Row) -> f64) -> (f64, &'a str) {
    let all = rows.iter().map(|row| (value(row), row.case));
    all.fold(
        (0.0, "none"),
        |most, now| if now.0 > most.0 { now } else { most },
    )
}

/// Hard cases by method, solver and tissue: number that hold, and the largest value of each measure.
pub(super) fn summary(report: &Report) -> Table {
    let mut groups: Vec<(&str, &str, &str)> = report
        .rows
        .iter()
        .map(|row| (row.method, row.solver, row.tissue.as_str()))
        .collect();
    groups.sort_unstable();
    groups.dedup();
    let rows = groups.into_iter().map(|(method, solver, tissue)| {
        let of =
            |row: &&Row| (row.method, row.solver, row.tissue.as_str()) == (method, solver, tissue);
        let group: Vec<&Row> = report.rows.iter().filter(of).collect();
        let holds = group.iter().filter(|row| row.status == "holds").count();
        let (residual, deepest) = most(&group, |row| row.residual_um);
        let (p999, slowest) = most(&group, |row| row.times.tick_us.p999);
        let largest = |value: fn(&Row) -> f64| number(most(&group, value).0);
        vec![
            method.to_owned(),
            solver.replace('_', " "),
            tissue.replace('_', " "),
            format!("{holds} of {}", group.len()),
            largest(|row| row.times.tick_us.p50),
            largest(|row| row.times.tick_us.p99),
            format!("{} (`{slowest}`)", number(p999)),
            format!("{} (`{deepest}`)", number(residual)),
            largest(|row| row.slow_force_step_n * 1e3),
            largest(|row| row.buzz_n * 1e3),
            largest(|row| row.energy_mj),
            format!(
                "{}",
                group.iter().map(|row| row.exhausted_ticks).sum::<u64>()
            ),
        ]
    });
    Table {
        caption: "Case: all hard cases by method, solver and tissue; reference: the bounds of each case; quantities: number of cases that hold every bound, and the largest value of each measure over the cases of the row, times over ticks in contact.".to_owned(),
        command: COMMAND.to_owned(),
        columns: vec![
            "method",
            "solver",
            "tissue",
            "cases that hold",
            "tick p50, us",
            "tick p99, us",
            "tick p99.9, us (case)",
            "residual of converged ticks, um (case)",
            "slow force step, mN",
            "buzz, mN",
            "energy put out, mJ",
            "exhausted ticks",
        ],
        rows: rows.collect(),
        notes: Vec::new(),
    }
}

/// The slowest hard cases by the coupled method with the tick's own solver.
pub(super) fn slowest(report: &Report) -> Table {
    let own = |row: &&Row| row.method == "coupled" && row.solver == "active_set";
    let mut slow: Vec<&Row> = report.rows.iter().filter(own).collect();
    slow.sort_by(|a, b| b.times.tick_us.p999.total_cmp(&a.times.tick_us.p999));
    let rows = slow.iter().take(SLOWEST).map(|row| {
        let [p50, p99, p999] = tick_cells(&row.times);
        let (bound, used) = &row.nearest;
        vec![
            format!("`{}`", row.case),
            p50,
            p99,
            p999,
            number(f64::from(row.work.p50) * 1e-3),
            number(f64::from(row.work.p999) * 1e-3),
            number(f64::from(row.work.max) * 1e-3),
            number(row.residual_um),
            number(row.exhausted_residual_um),
            number(row.passes_mean),
            format!("{bound}, {used:.0} %"),
            yes_no(row.broken.is_empty()),
        ]
    });
    Table {
        caption: format!(
            "Case: the {SLOWEST} hard cases with the longest tick at p99.9, coupled method, own solver; reference: the bounds of each case; quantities: CPU time and counted operations of a tick in contact, overlap of converged and of exhausted ticks, mean number of passes, and the bound that is used most."
        ),
        command: COMMAND.to_owned(),
        columns: vec![
            "case",
            "tick p50, us",
            "tick p99, us",
            "tick p99.9, us",
            "operations p50, thousands",
            "operations p99.9, thousands",
            "operations max, thousands",
            "residual, um",
            "residual of exhausted ticks, um",
            "passes",
            "nearest bound, share used",
            "holds",
        ],
        rows: rows.collect(),
        notes: Vec::new(),
    }
}

/// Random poses, scene by scene.
pub(super) fn random_poses(report: &Report) -> Table {
    let rows = report.random_poses.iter().map(|rough| {
        vec![
            rough.scene.replace('_', " "),
            format!("{}", rough.ticks),
            format!("{}", rough.contact_ticks),
            format!("{}", rough.not_finite),
            format!("{}", rough.faults),
            number(rough.exhausted_percent),
            number(rough.residual_um),
            number(rough.exhausted_residual_um),
            number(rough.slow_force_step_n * 1e3),
            number(rough.max_force_n),
            yes_no(rough.holds()),
        ]
    });
    Table {
        caption: "Case: a random walk with leaps, turns, absences and invalid numbers in each scene; reference: the bounds of the walk; quantities: number of values that are not finite, of faults and of exhausted ticks, overlap, step of the force under a slow hand, and largest force.".to_owned(),
        command: COMMAND.to_owned(),
        columns: vec![
            "scene",
            "ticks",
            "ticks in contact",
            "values not finite",
            "faults",
            "exhausted ticks, %",
            "residual, um",
            "residual of exhausted ticks, um",
            "slow force step, mN",
            "force max, N",
            "holds",
        ],
        rows: rows.collect(),
        notes: Vec::new(),
    }
}
