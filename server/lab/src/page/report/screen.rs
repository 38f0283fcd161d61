//! Costs of the student's screen, from the file of the example `cost` of `sulcus-screen`.

use serde_json::Value;

/// The numbers of a screen.
pub(super) struct Screen {
    /// Processor, cores and graphics adapter.
    pub(super) machine: String,
    /// Size of the picture, pixels.
    pub(super) size: String,
    pub(super) rows: Vec<Row>,
    pub(super) levels: Vec<Level>,
}

/// A level in a view.
pub(super) struct Row {
    pub(super) level: String,
    pub(super) view: String,
    /// Triangles, calls, times of a frame in ms: mouth, with a mirror, with moving tissue, read-back.
    pub(super) numbers: Vec<String>,
    /// Bound of the time with a mirror, ms, and whether it holds.
    pub(super) bound: Option<(String, bool)>,
}

/// Looks of a level.
pub(super) struct Level {
    pub(super) name: String,
    /// Light, samples, shadows, relief, thinning, and the looks of every level.
    pub(super) looks: [String; 6],
}

impl Screen {
    /// The content of the file; a missing field is an empty text or a dash.
    pub(super) fn of(file: &Value) -> Self {
        let list = |name: &str| file[name].as_array().map_or(&[][..], Vec::as_slice);
        let bound = |row: &Value| {
            let same = |bound: &&Value| bound["level"] == row["level"];
            let most = list("bounds").iter().find(same)?["ms"].as_f64()?;
            let holds = row["mirror_ms"].as_f64().is_some_and(|ms| ms <= most);
            Some((format!("{most:.0}"), holds))
        };
        let row = |row: &Value| Row {
            level: text(&row["level"]),
            view: text(&row["view"]),
            numbers: FIELDS.map(|name| text(&row[name])).into(),
            bound: bound(row),
        };
        let level = |level: &Value| Level {
            name: text(&level["level"]),
            looks: LOOKS.map(|name| text(&level[name])),
        };
        let machine = &file["machine"];
        Self {
            machine: format!(
                "{}, {} logical cores; {}",
                text(&machine["processor"]),
                text(&machine["cores"]),
                text(&file["adapter"])
            ),
            size: list("size")
                .iter()
                .map(text)
                .collect::<Vec<_>>()
                .join(" x "),
            rows: list("rows").iter().map(row).collect(),
            levels: list("levels").iter().map(level).collect(),
        }
    }
}

/// Fields of a row, in the order of the table.
const FIELDS: [&str; 6] = [
    "drawn_triangles",
    "draws",
    "mouth_ms",
    "mirror_ms",
    "moving_ms",
    "read_back_ms",
];
/// Fields of a level, in the order of the table.
const LOOKS: [&str; 6] = [
    "light",
    "samples",
    "shadow_texels",
    "relief",
    "thinned_um",
    "always",
];

fn text(value: &Value) -> String {
    match value {
        Value::Null => "–".to_owned(),
        Value::String(text) => text.clone(),
        Value::Array(all) => all.iter().map(text).collect::<Vec<_>>().join(", "),
        other => other.to_string(),
    }
}
