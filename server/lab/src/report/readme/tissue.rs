//! Tables of the springs of one degree of freedom, of tissue against finite elements, and of other engines.

use serde_json::Value;

use super::table::{Table, number};
use super::{COMMAND, yes_no};
use crate::report::Report;

/// Springs of one degree of freedom.
pub(super) fn one_dof(report: &Report) -> Table {
    let rows = report.one_dof.iter().map(|row| {
        let mut cells = vec![
            number(row.spring_n_per_m),
            number(row.limit_ms),
            number(row.limit_run_ms),
        ];
        cells.extend(row.force_step_n.map(|step| number(step * 1e3)));
        cells.extend(row.load_ratio.map(number));
        cells
    });
    Table {
        caption: "Case: a sphere of 20 g on a spring, pressed by a coupled tool, steps of 1 ms; reference: Eq. 9 for the time step, equal action and reaction for the loads; quantities: largest stable time step of the printed method, largest step of the force in fast contact, and force on the tissue over force on the device.".to_owned(),
        command: COMMAND.to_owned(),
        columns: vec![
            "spring, N/m",
            "limit by Eq. 9, ms",
            "limit found, ms",
            "force step, printed, mN",
            "force step, implicit, mN",
            "force step, coupled, mN",
            "load ratio, printed",
            "load ratio, implicit",
            "load ratio, coupled",
        ],
        rows: rows.collect(),
        notes: Vec::new(),
    }
}

/// Tissue models against finite elements.
pub(super) fn elements(report: &Report) -> Table {
    let rows = report.finite_elements.iter().map(|one| {
        vec![
            one.model.replace('_', " "),
            one.case.clone(),
            number(one.force_n),
            number(one.max_displacement_mm),
            number(one.rms_percent),
            number(one.rel_l2_percent),
            number(one.max_percent),
        ]
    });
    Table {
        caption: "Case: static loads on the built-in tongue, to which no model was fitted; reference: quadratic finite elements of the same surface; quantities: error of the displacement over the free vertices, in percent of the largest displacement, and in percent of the rms displacement.".to_owned(),
        command: COMMAND.to_owned(),
        columns: vec![
            "model",
            "load and law",
            "load, N",
            "displacement max, mm",
            "error rms, % of max",
            "error rms, % of rms",
            "error max, % of max",
        ],
        rows: rows.collect(),
        notes: Vec::new(),
    }
}

/// Other engines, from the file of their bench.
pub(super) fn peers(peers: &Value) -> Table {
    let list = |name: &str| peers[name].as_array().cloned().unwrap_or_default();
    let text = |value: &Value| value.as_str().unwrap_or_default().to_owned();
    let value = |value: &Value| number(value.as_f64().unwrap_or(f64::NAN));
    let rows = list("rows").into_iter().map(|row| {
        let us = &row["tick_us"];
        vec![
            text(&row["scene"]),
            text(&row["engine"]),
            value(&us["p50"]),
            value(&us["p99"]),
            value(&us["p999"]),
            value(&row["penetration_um"]),
            value(&row["residual_um"]),
            value(&row["force_step_n"]),
        ]
    });
    let notes = list("ratios").into_iter().map(|ratio| {
        format!(
            "{}: {}, at least {} asked; holds: {}.",
            text(&ratio["name"]),
            value(&ratio["value"]),
            value(&ratio["at_least"]),
            yes_no(ratio["holds"].as_bool().unwrap_or(false)),
        )
    });
    Table {
        caption: "Case: scenes and hand paths that every engine runs; reference: Sulcus on the same path; quantities: time of a tick, penetration of the drawn and of the touched shapes, and step of the force. The notes are ratios of the best other engine over Sulcus.".to_owned(),
        command: "cargo bench -p sulcus-peers --features rapier".to_owned(),
        columns: vec![
            "scene",
            "engine",
            "tick p50, us",
            "tick p99, us",
            "tick p99.9, us",
            "penetration of the drawn shapes, um",
            "penetration of the touched shapes, um",
            "force step, N",
        ],
        rows: rows.collect(),
        notes: notes.collect(),
    }
}
