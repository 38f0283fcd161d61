//! Other engines on the same path, from the file of the bench `sulcus-peers`.

use serde_json::Value;

/// Fields of a run after its percentiles, in the order of the table.
const FIELDS: [&str; 4] = ["penetration_um", "apart_um", "residual_um", "force_step_n"];

/// The numbers of other engines.
pub(super) struct Peers {
    pub(super) ratios: Vec<Ratio>,
    pub(super) runs: Vec<Run>,
}

/// A ratio of their best and ours, with its bound.
pub(super) struct Ratio {
    pub(super) name: String,
    pub(super) found: String,
    pub(super) asked: String,
    pub(super) holds: bool,
}

/// Engine in a scene.
pub(super) struct Run {
    pub(super) note: String,
    pub(super) scene: String,
    pub(super) engine: String,
    /// Percentiles of a tick, then [`FIELDS`].
    pub(super) numbers: Vec<String>,
}

impl Peers {
    /// The content of the file; a missing field is an empty text or a dash.
    pub(super) fn of(file: &Value) -> Self {
        let list = |name: &str| file[name].as_array().map_or(&[][..], Vec::as_slice);
        let ratio = |ratio: &Value| Ratio {
            name: text(&ratio["name"]),
            found: number(&ratio["value"]),
            asked: number(&ratio["at_least"]),
            holds: ratio["holds"].as_bool().unwrap_or(false),
        };
        let run = |run: &Value| {
            let times = ["p50", "p99", "p999", "max"].map(|name| number(&run["tick_us"][name]));
            let others = FIELDS.map(|name| number(&run[name]));
            Run {
                note: text(&run["note"]),
                scene: text(&run["scene"]),
                engine: text(&run["engine"]),
                numbers: times.into_iter().chain(others).collect(),
            }
        };
        Self {
            ratios: list("ratios").iter().map(ratio).collect(),
            runs: list("rows").iter().map(run).collect(),
        }
    }
}

fn text(value: &Value) -> String {
    value.as_str().unwrap_or_default().to_owned()
}

/// A number with two decimals, or none from 100; a dash without a number.
fn number(value: &Value) -> String {
    match value.as_f64() {
        Some(x) if x.abs() >= 100.0 => format!("{x:.0}"),
        Some(x) => format!("{x:.2}"),
        None => "–".to_owned(),
    }
}
