//! Speed against error: what `sulcus-server report` measures on the machine that it runs on.
//!
//! Errors and forces are measured in runs of their own, ticks timed in others, on inputs recorded before: the measuring costs more
//! than what it measures. Every time is CPU time of the thread; wall time stands beside it where a deadline is meant.

mod devices;
mod growth;
mod loops;
mod machine;
mod matrix;
mod mouth;
pub(crate) mod paper;
mod printed;
mod rates;
mod readme;
mod rough;
mod rows;
mod shipped;
mod times;
mod together;

use std::time::Instant;

use serde::Serialize;
use sulcus_cases::one_dof;

pub(crate) use devices::{DeviceLoop, sentences};
pub(crate) use growth::{Asked, Growth, Line};
pub(crate) use loops::{FELT_MJ, Hour, Loop, Loops};
pub(crate) use machine::Machine;
pub(crate) use matrix::Cell;
pub(crate) use mouth::{Level, Mouth, SHARES};
pub(crate) use printed::{Beside, Curve};
pub(crate) use rates::{LOOKS_S, Rate};
pub(crate) use readme::{Kind, Readme};
pub(crate) use rough::Rough;
pub(crate) use rows::Row;
#[cfg(test)]
pub(crate) use rows::row;
pub(crate) use times::TickUs;

use crate::tissue::against_fem::{AgainstFem, against_fem};

/// Everything that was measured.
#[derive(Serialize)]
pub(crate) struct Report {
    /// This program.
    pub(crate) program: &'static str,
    /// Fewer cases, fewer repeats.
    pub(crate) quick: bool,
    pub(crate) machine: Machine,
    pub(crate) rows: Vec<Row>,
    pub(crate) mouth: Mouth,
    pub(crate) matrix: Vec<Cell>,
    pub(crate) rates: Vec<Rate>,
    pub(crate) growth: Growth,
    pub(crate) random_poses: Vec<Rough>,
    pub(crate) passivity: Loops,
    /// Closed loop of real devices: chosen coupling, buzz, onset of a buzz.
    pub(crate) devices: Vec<DeviceLoop>,
    pub(crate) one_dof: Vec<OneDof>,
    pub(crate) finite_elements: Vec<AgainstFem>,
    /// What the bench against other engines wrote.
    pub(crate) peers: Option<serde_json::Value>,
    /// Costs of the student's screen, from a file.
    pub(crate) screen: Option<serde_json::Value>,
    /// Sessions through named networks, from a file: a row for each network and each end that ticks.
    pub(crate) networks: Option<serde_json::Value>,
    /// Everything that the paper prints beside what is measured here.
    pub(crate) paper: Option<Beside>,
    pub(crate) took_s: f64,
    /// What each part of that took, seconds, by name.
    pub(crate) parts_s: Vec<(&'static str, f64)>,
}

/// A spring of the benchmark with one degree of freedom.
#[derive(Serialize)]
pub(crate) struct OneDof {
    pub(crate) spring_n_per_m: f64,
    /// Largest stable step of the printed method by Eq. 9, and as found by running it.
    pub(crate) limit_ms: f64,
    pub(crate) limit_run_ms: f64,
    /// Largest force step in fast contact, by method: `printed`, `implicit`, `coupled`.
    pub(crate) force_step_n: [f64; 3],
    /// Force on the tissue over force on the device, by method.
    pub(crate) load_ratio: [f64; 3],
}

/// What to measure.
pub(crate) struct Options {
    pub(crate) quick: bool,
    /// The paper, figure by figure, too.
    pub(crate) paper: bool,
    pub(crate) peers: Option<serde_json::Value>,
    pub(crate) screen: Option<serde_json::Value>,
    pub(crate) networks: Option<serde_json::Value>,
}

/// Parts of the work and their shares of the time, for the progress.
const PARTS: [(&str, f64); 11] = [
    ("the whole mouth", 0.08),
    ("level, tissue, solver, method", 0.15),
    ("rates", 0.16),
    ("how times grow", 0.07),
    ("hard cases", 0.28),
    ("random poses", 0.02),
    ("passivity", 0.09),
    ("real devices", 0.04),
    ("one degree of freedom", 0.01),
    ("finite elements", 0.05),
    ("the paper", 0.05),
];

/// Measures it all. `progress` gets what is being done and how much of it all is.
///
/// # Errors
/// If finite elements find no equilibrium: a fault of this program.
pub(crate) fn measure(options: Options, progress: &dyn Fn(&str, f64)) -> anyhow::Result<Report> {
    let begun = Instant::now();
    let quick = options.quick;
    let part = |k: usize| {
        let before: f64 = PARTS[..k].iter().map(|part| part.1).sum();
        move |what: &str, share: f64| {
            let (name, of) = PARTS[k];
            let what = if what.is_empty() {
                String::new()
            } else {
                format!(": {what}")
            };
            progress(&format!("{name}{what}"), before + of * share);
        }
    };
    let mut parts_s = Vec::new();
    let mut since = begun;
    let mut ended = |k: usize| {
        parts_s.push((PARTS[k].0, since.elapsed().as_secs_f64()));
        since = Instant::now();
    };
    let mouth = mouth::measure(quick, &part(0));
    ended(0);
    let matrix = matrix::measure(quick, &part(1));
    ended(1);
    let rates = rates::measure(quick, &part(2));
    ended(2);
    let growth = growth::measure(quick, &part(3));
    ended(3);
    let rows = rows::measure(quick, &part(4));
    ended(4);
    let random_poses = rough::measure(quick, &part(5));
    ended(5);
    let passivity = loops::measure(quick, &part(6));
    ended(6);
    let devices = devices::measure(quick, &|share| part(7)("", share));
    ended(7);
    part(8)("", 0.0);
    let one_dof = one_dof::Table::run().0.iter().map(one_dof_row).collect();
    ended(8);
    let elements = against_fem(quick, &part(9))?;
    ended(9);
    let paper = options
        .paper
        .then(|| Beside::of(paper::paper_beside(quick, &elements, &part(10)), quick));
    ended(10);
    Ok(Report {
        program: concat!("sulcus-server ", env!("CARGO_PKG_VERSION")),
        quick,
        machine: Machine::here(),
        rows,
        mouth,
        matrix,
        rates,
        growth,
        random_poses,
        passivity,
        devices,
        one_dof,
        finite_elements: elements,
        peers: options.peers,
        screen: options.screen,
        networks: options.networks,
        paper,
        took_s: begun.elapsed().as_secs_f64(),
        parts_s,
    })
}

fn one_dof_row(row: &one_dof::Row) -> OneDof {
    let of = |value: fn(&one_dof::Press) -> f64, speed: usize| {
        let mut values = row.presses.iter().map(|(_, press)| value(&press[speed]));
        std::array::from_fn(|_| values.next().unwrap_or(f64::NAN))
    };
    OneDof {
        spring_n_per_m: row.numbers.spring,
        limit_ms: row.limits.0 * 1e3,
        limit_run_ms: row.limits.1 * 1e3,
        force_step_n: of(|press| press.force_step, 1),
        load_ratio: of(|press| press.tissue_force / press.device_force, 0),
    }
}
