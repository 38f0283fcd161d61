//! The paper's figures, tables and claims as they go into the JSON and onto the page.

use std::collections::BTreeMap;

use serde::Serialize;

use super::paper::printed::Value;
use super::paper::{Paper, Part};

/// Everything that the paper prints beside what is measured here.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Beside {
    pub(crate) rows: Vec<Row>,
    pub(crate) curves: Vec<Curve>,
    pub(crate) multi_rate: Vec<Rated>,
}

/// One printed thing.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Row {
    pub(crate) id: &'static str,
    pub(crate) place: &'static str,
    pub(crate) what: &'static str,
    /// In words; none where the text at hand does not have it.
    pub(crate) printed: Option<String>,
    pub(crate) conditions: &'static str,
    pub(crate) measured: String,
    pub(crate) values: BTreeMap<&'static str, f64>,
    pub(crate) how: String,
    /// Command that measures the row again.
    pub(crate) command: String,
    /// Part of the paper's report that measured the row.
    #[serde(skip)]
    pub(crate) part: Part,
}

/// A curve of a figure, with at most a few hundred points.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Curve {
    pub(crate) place: &'static str,
    pub(crate) title: String,
    pub(crate) x: &'static str,
    pub(crate) y: &'static str,
    pub(crate) series: Vec<(String, Vec<(f64, f64)>)>,
    pub(crate) note: String,
}

/// A scene at one of the rates.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Rated {
    pub(crate) scene: String,
    pub(crate) rates: &'static str,
    pub(crate) rms_difference_n: f64,
    pub(crate) max_difference_n: f64,
    pub(crate) rms_force_n: f64,
    pub(crate) buzz_n: f64,
    pub(crate) energy_mj: f64,
    pub(crate) force_step_n: f64,
    pub(crate) stable: bool,
    pub(crate) broken: Vec<String>,
}

/// Points of a curve beyond which every so many are left out.
const POINTS: usize = 600;

impl Beside {
    /// What was measured, as it goes into files; `quick` as it was then.
    pub(crate) fn of(paper: Paper, quick: bool) -> Self {
        let rows = paper.rows.into_iter().map(|row| Row {
            command: row.part.command(quick),
            part: row.part,
            id: row.printed.id,
            place: row.printed.place,
            what: row.printed.what,
            printed: words(row.printed.value, row.printed.unit),
            conditions: row.printed.conditions,
            measured: row.measured,
            values: row.values.into_iter().collect(),
            how: row.how,
        });
        let thin = |points: Vec<(f64, f64)>| {
            let every = points.len().div_ceil(POINTS).max(1);
            points.into_iter().step_by(every).collect()
        };
        let curves = paper.curves.into_iter().map(|curve| Curve {
            place: curve.place,
            title: curve.title,
            x: curve.x,
            y: curve.y,
            series: curve
                .series
                .into_iter()
                .map(|(name, points)| (name, thin(points)))
                .collect(),
            note: curve.note,
        });
        let studies = paper.multi_rate.iter().flat_map(|found| &found.studies);
        let rated = studies.flat_map(|study| {
            study.rates.iter().map(|rated| Rated {
                scene: study.about.clone(),
                rates: rated.rates.name(),
                rms_difference_n: rated.rms_difference,
                max_difference_n: rated.max_difference,
                rms_force_n: rated.rms_force,
                buzz_n: rated.closed.buzz,
                energy_mj: rated.closed.energy * 1e3,
                force_step_n: rated.closed.force_step,
                stable: rated.stable,
                broken: rated.broken.clone(),
            })
        });
        Self {
            multi_rate: rated.collect(),
            rows: rows.collect(),
            curves: curves.collect(),
        }
    }
}

fn words(value: Value, unit: &str) -> Option<String> {
    let said = match value {
        Value::Number(x) => format!("{x}"),
        Value::Range(low, high) => format!("{low} to {high}"),
        Value::AtMost(x) => format!("at most {x}"),
        Value::Words(words) => return Some(words.to_owned()),
        Value::Unknown => return None,
    };
    Some(format!("{said} {unit}").trim_end().to_owned())
}
