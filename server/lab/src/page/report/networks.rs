//! Sessions through named networks, from the file of the example `networks` of `sulcus-client`.

use serde_json::Value;

/// A session.
pub(super) struct Network {
    /// Name of the network.
    pub(super) network: String,
    /// End that computed the ticks.
    pub(super) tick: String,
    /// Figures in the order of the table, from the age of the pose to the number of returns.
    pub(super) numbers: Vec<String>,
    /// Whether hand and server computed the same bits.
    pub(super) same: &'static str,
    /// Score of the grade.
    pub(super) grade: String,
}

/// Figures of a row, with the number of decimals.
const FIGURES: [(&str, usize); 7] = [
    ("felt_force_percent", 1),
    ("felt_off_n", 3),
    ("force_step_n", 3),
    ("energy_out_mj", 3),
    ("bandwidth_kbit_s", 0),
    ("input_bytes_per_tick", 1),
    ("resumes", 0),
];

impl Network {
    /// All sessions of a file; a missing field is a dash.
    pub(super) fn all(rows: &Value) -> Vec<Self> {
        let rows = rows.as_array().map_or(&[][..], Vec::as_slice);
        rows.iter().map(Self::of).collect()
    }

    fn of(row: &Value) -> Self {
        let ages = ["p50", "p99"].map(|part| number(&row["pose_age_ms"][part], 2));
        let figures = FIGURES.map(|(name, decimals)| number(&row[name], decimals));
        Self {
            network: row["network"].as_str().unwrap_or("none").to_owned(),
            tick: row["tick"].as_str().unwrap_or("–").to_owned(),
            numbers: ages.into_iter().chain(figures).collect(),
            same: match row["felt_identical"].as_bool() {
                Some(true) => "yes",
                Some(false) => "no",
                None => "–",
            },
            grade: number(&row["grade"], 0),
        }
    }
}

fn number(value: &Value, decimals: usize) -> String {
    value
        .as_f64()
        .map_or_else(|| "–".to_owned(), |number| format!("{number:.decimals$}"))
}
