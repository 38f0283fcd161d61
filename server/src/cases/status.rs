//! Facts of a compilation, and the state of a case.

use serde::{Deserialize, Serialize};

/// Version of the layout.
pub(super) const VERSION: u32 = 1;

/// Facts of the compilation of a case, beside its compiled scene.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Status {
    /// Version of the layout.
    pub version: u32,
    /// BLAKE3 hash of the patient file that was compiled, hexadecimal.
    pub patient_hash: String,
    /// Text of the patient file that was compiled.
    pub patient: String,
    /// BLAKE3 hash of the compiled scene, hexadecimal.
    pub scene_hash: String,
    /// Length of the compiled scene, bytes.
    pub scene_bytes: u64,
    /// End of the compilation, seconds since 1970.
    pub compiled_unix_s: u64,
    /// Duration of the compilation, seconds.
    pub took_s: f64,
    /// Version of the program.
    pub program: String,
    /// Warnings of values that are usable but probably unintended, a sentence each.
    pub warnings: Vec<String>,
}

/// State of a case. Which one holds follows from the files alone.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum State {
    /// The patient file has a fault.
    Faulty,
    /// The patient file is valid and was never compiled.
    New,
    /// The patient file was changed after the compilation. The compiled scene is that of the former patient.
    Changed,
    /// The compiled scene is that of the patient file.
    Compiled,
}

impl State {
    /// Words for people.
    pub fn words(self) -> &'static str {
        match self {
            Self::Faulty => "has a fault",
            Self::New => "not compiled",
            Self::Changed => "changed since its compilation",
            Self::Compiled => "compiled",
        }
    }
}
