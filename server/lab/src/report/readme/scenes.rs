//! Tables of the shipped scenes: the whole mouth, the rates, and the growth of times with the scene.

use super::table::{Table, number, tick_cells};
use super::{COMMAND, bound_cells, yes_no};
use crate::report::Report;

/// The whole mouth, level by level: time of a tick beside the error of the touched shape.
pub(super) fn mouth(report: &Report) -> Table {
    let mouth = &report.mouth;
    let (runs, ticks) = mouth
        .levels
        .first()
        .map_or((0, 0), |level| (level.times.runs, level.times.ticks));
    let rows = mouth.levels.iter().map(|level| {
        let [p50, p99, p999] = tick_cells(&level.times);
        let contact: Vec<String> = level
            .in_contact_percent
            .iter()
            .map(|x| number(*x))
            .collect();
        vec![
            format!("{}", level.level),
            format!("{}", level.spheres),
            number(level.tooth_error_mean_um),
            number(level.tooth_error_max_um),
            p50,
            p99,
            p999,
            number(level.times.tick_us.max),
            number(level.times.over_1_ms_percent),
            number(level.max_hz * 1e-3),
            contact.join(", "),
        ]
    });
    Table {
        caption: format!(
            "Case: two tools at work in the generated mouth of patient {}, {} objects, the same recorded hands at every level; reference: the drawn molar; quantities: distance of the touched molar from the drawn one, and CPU time of a tick, mean and 95 % interval over {runs} runs of {ticks} ticks.",
            mouth.patient, mouth.objects
        ),
        command: COMMAND.to_owned(),
        columns: vec![
            "level",
            "spheres of the molar",
            "shape error mean, um",
            "shape error max, um",
            "tick p50, us",
            "tick p99, us",
            "tick p99.9, us",
            "tick max, us",
            "ticks over 1 ms of wall time, %",
            "rate that 99.9 % of ticks hold, kHz",
            "ticks in contact by tool, %",
        ],
        rows: rows.collect(),
        notes: Vec::new(),
    }
}

/// The shipped scenes at 1 to 8 kHz.
pub(super) fn rates(report: &Report) -> Table {
    let rows = report.rates.iter().map(|rate| {
        let [p50, p99, p999] = tick_cells(&rate.times);
        vec![
            rate.scene.to_owned(),
            number(f64::from(rate.rate_hz) * 1e-3),
            number(rate.period_us),
            p50,
            p99,
            p999,
            yes_no(rate.holds),
            number(rate.force_n),
            number(rate.residual_um),
            number(rate.slow_force_step_n * 1e3),
            number(rate.buzz_n * 1e3),
        ]
    });
    Table {
        caption: "Case: each shipped scene with hands in closed loop, at growing rates up to the first that is not held; reference: the period of a tick; quantities: CPU time of a tick, and force, overlap and steps of the force at the same rate.".to_owned(),
        command: COMMAND.to_owned(),
        columns: vec![
            "scene",
            "rate, kHz",
            "period, us",
            "tick p50, us",
            "tick p99, us",
            "tick p99.9, us",
            "p99.9 within the period",
            "force mean, N",
            "residual max, um",
            "slow force step max, mN",
            "buzz, mN",
        ],
        rows: rows.collect(),
        notes: Vec::new(),
    }
}

/// Subject of a line of growth, without its explanation.
fn subject(with: &str) -> String {
    with.split(':').next().unwrap_or(with).to_owned()
}

/// Times by what there is more of in the scene.
pub(super) fn growth(report: &Report) -> Table {
    let lines = report.growth.lines.iter();
    let rows = lines.flat_map(|line| {
        line.points.iter().map(|point| {
            let [p50, p99, p999] = tick_cells(&point.times);
            vec![
                subject(line.with),
                point.what.clone(),
                p50,
                p99,
                p999,
                number(point.rows),
                number(point.passes),
            ]
        })
    });
    Table {
        caption: "Case: scenes that differ in one thing, under the same recorded hand within each group; reference: the other rows of the group; quantities: CPU time of a tick, mean number of rows and of passes of a tick.".to_owned(),
        command: COMMAND.to_owned(),
        columns: vec![
            "grows with",
            "scene",
            "tick p50, us",
            "tick p99, us",
            "tick p99.9, us",
            "rows of a tick",
            "passes of a tick",
        ],
        rows: rows.collect(),
        notes: Vec::new(),
    }
}

/// Bounds on the growth.
pub(super) fn growth_bounds(report: &Report) -> Table {
    let lines = report.growth.lines.iter();
    let rows = lines.flat_map(|line| {
        line.asked.iter().map(|asked| {
            let [found, at_most, holds] = bound_cells(asked);
            vec![
                subject(line.with),
                asked.what.clone(),
                found,
                at_most,
                holds,
            ]
        })
    });
    Table {
        caption: "Case: the scenes of the table above; reference: the smaller scene; quantity: ratio of the times of a tick, of medians unless the row names another percentile.".to_owned(),
        command: COMMAND.to_owned(),
        columns: vec!["grows with", "ratio", "found", "at most", "holds"],
        rows: rows.collect(),
        notes: Vec::new(),
    }
}
