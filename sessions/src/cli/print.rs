//! Output of all commands: one outcome per file as text or JSON, and the worst exit code.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use serde_json::{Map, Value, json};
use sulcus_program::{PathText, say, tell};

/// Outcome of one file: JSON object, text, finding.
pub struct Outcome {
    /// The file's object in the JSON output.
    pub json: Map<String, Value>,
    /// Text for people; an empty text is not printed.
    pub text: String,
    /// Whether the exit code is 1 instead of 0.
    pub finding: bool,
}

/// The members of a JSON object; any other value becomes the member `value`.
pub fn object(value: Value) -> Map<String, Value> {
    match value {
        Value::Object(map) => map,
        other => Map::from_iter([("value".to_owned(), other)]),
    }
}

/// Error with the file's name, unless the error has the name.
pub fn at(path: &Path, error: &dyn std::error::Error) -> anyhow::Error {
    let (path, text) = (path.shown().to_string(), error.to_string());
    if text.contains(&path) {
        anyhow::anyhow!(text)
    } else {
        anyhow::anyhow!("{path}: {text}")
    }
}

/// Outcomes printed so far, and the objects of the last line.
pub(super) struct Tally {
    json: bool,
    code: u8,
    objects: Vec<Value>,
}

impl Tally {
    pub(super) fn new(json: bool) -> Self {
        Self {
            json,
            code: 0,
            objects: Vec::new(),
        }
    }

    /// Prints the outcome of a file, or its error.
    pub(super) fn add(&mut self, path: &Path, outcome: anyhow::Result<Outcome>) {
        match outcome {
            Ok(outcome) => {
                self.code = self.code.max(u8::from(outcome.finding));
                if !self.json && !outcome.text.is_empty() {
                    say!("{}", outcome.text);
                }
                self.objects.push(Value::Object(outcome.json));
            }
            Err(error) => {
                self.code = 2;
                complain(&error);
                self.objects.push(
                    json!({"file": path.shown().to_string(), "error": crate::sentence(&error)}),
                );
            }
        }
    }

    /// Prints the last line; worst exit code.
    pub(super) fn finish(self, total: &str) -> ExitCode {
        if self.json {
            let object = match <[Value; 1]>::try_from(self.objects) {
                Ok([only]) => only,
                Err(objects) => summary(objects, total),
            };
            say!("{object}");
        }
        ExitCode::from(self.code)
    }
}

/// Calls `one` for every file and prints the outcomes; worst exit code. The JSON object sums `total` over the files.
pub fn for_each(
    files: &[PathBuf],
    json: bool,
    total: &str,
    one: impl Fn(&Path) -> anyhow::Result<Outcome>,
) -> ExitCode {
    let mut tally = Tally::new(json);
    for path in files {
        tally.add(path, one(path));
    }
    tally.finish(total)
}

/// Several files as one object. `identical` is true only if it is true for every file.
pub(super) fn summary(objects: Vec<Value>, total: &str) -> Value {
    let sum: u64 = objects.iter().filter_map(|file| file[total].as_u64()).sum();
    let mut all = Map::from_iter([(total.to_owned(), json!(sum))]);
    if objects.iter().any(|file| file.get("identical").is_some()) {
        let identical = objects.iter().all(|file| file["identical"] == json!(true));
        let first = objects
            .iter()
            .find(|file| file["first_divergent_tick"].is_u64());
        // The slowest file limits a user who waits for all files.
        let slowest = objects
            .iter()
            .filter_map(|file| file["realtime_factor"].as_f64())
            .reduce(f64::min);
        all.insert("identical".to_owned(), json!(identical));
        all.insert(
            "first_divergent_tick".to_owned(),
            first.map_or(Value::Null, |file| file["first_divergent_tick"].clone()),
        );
        all.insert("realtime_factor".to_owned(), json!(slowest));
    }
    all.insert("files".to_owned(), Value::Array(objects));
    Value::Object(all)
}

/// Writes an error as one sentence on standard error.
pub fn complain(error: &anyhow::Error) {
    tell!("error: {}", crate::sentence(error));
}
