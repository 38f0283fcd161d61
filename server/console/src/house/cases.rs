//! Patients and their compiled scenes, as the console sees them.

use std::fmt;

use serde::{Deserialize, Serialize};

/// Values of the six sites of a tooth, each side mesio-, mid-, disto-.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Sides<T> {
    /// Buccal or labial side.
    pub buccal: [T; 3],
    /// Lingual side.
    pub lingual: [T; 3],
}

/// Chart of one tooth.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ToothChart {
    /// FDI number.
    pub fdi: u8,
    /// Probing depths, mm.
    pub depth_mm: Sides<f64>,
    /// Margins below the cemento-enamel junction, mm; negative above it.
    pub recession_mm: Sides<f64>,
    /// Whether a site bleeds after light probing.
    pub bleeding: Sides<bool>,
    /// Inflammation of the gingiva, 0 to 1.
    pub inflammation: f64,
    /// Degrees of furcation (Hamp) at the buccal and the lingual entrance, 0 to 3.
    pub furcation: [u8; 2],
    /// Mobility (Miller), 0 to 3.
    pub mobility: u8,
}

/// Chart of a patient as the form shows it: every present tooth of the model.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Chart {
    /// Label of the patient.
    pub label: String,
    /// FDI numbers of missing teeth.
    pub missing: Vec<u8>,
    /// Present teeth.
    pub teeth: Vec<ToothChart>,
}

/// A name with words for people.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Choice {
    /// Name in requests.
    pub name: String,
    /// Words.
    pub about: String,
}

/// Limits of the patients that the server's scenes can have.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Model {
    /// FDI numbers of the teeth of the model, from the patient's right to the left.
    pub teeth: Vec<u8>,
    /// Teeth that may be missing without being part of the model.
    pub third_molars: Vec<u8>,
    /// A healthy tooth.
    pub healthy: ToothChart,
    /// Least and largest depth, mm.
    pub depth_mm: [f64; 2],
    /// Highest and lowest margin, mm.
    pub recession_mm: [f64; 2],
    /// Largest sum of depth and recession, mm.
    pub most_loss_mm: f64,
    /// Conditions of generated patients.
    pub conditions: Vec<Choice>,
    /// Exercises that a case can be used for.
    pub exercises: Vec<Choice>,
    /// Sides from which a compiled mouth can be drawn; empty without pictures.
    pub sides: Vec<Choice>,
}

/// Fault of a patient's value, with its place in the form.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FieldFault {
    /// FDI number; `None` for the whole patient.
    pub fdi: Option<u8>,
    /// Side, `buccal` or `lingual`, and 0 to 2 for mesio-, mid-, disto-; `None` for a value of a whole tooth.
    pub site: Option<(&'static str, u8)>,
    /// Name of the value: that of the patient file, or `loss` for the sum of depth and recession.
    pub key: String,
    /// Sentence with value found and value expected.
    pub text: String,
}

/// A case as the console lists it.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Case {
    /// Name.
    pub name: String,
    /// State: `faulty`, `new`, `changed`, `compiled`.
    pub state: String,
    /// State in words.
    pub words: String,
    /// First fault in words, with the number of others.
    pub fault: Option<String>,
    /// Time of the last compilation in words; empty without one.
    pub compiled: String,
    /// Warnings of the last compilation.
    pub warnings: Vec<String>,
    /// Stations whose plans use the case.
    pub users: Vec<String>,
    /// Chart; `None` for a text that is no patient file.
    pub chart: Option<Chart>,
}

/// A case as the form loads it.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Loaded {
    /// The case.
    #[serde(flatten)]
    pub case: Case,
    /// Version of the patient file. A save names the version that was loaded.
    pub version: String,
    /// All faults.
    pub faults: Vec<FieldFault>,
}

/// Compilations.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Work {
    /// Case that is being compiled.
    pub running: Option<Running>,
    /// Cases that wait.
    pub waiting: Vec<String>,
    /// Last compilations that failed: name and sentence.
    pub failed: Vec<(String, String)>,
    /// Number of compilations that have ended. A page loads its list anew after a change.
    pub ended: u64,
}

/// Compilation that runs.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Running {
    /// Name of the case.
    pub name: String,
    /// Present stage.
    pub stage: String,
    /// Share of the whole, percent.
    pub percent: u8,
}

/// Origin of a new case.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Origin {
    /// Generated patient.
    Generated {
        /// Condition.
        condition: String,
        /// Seed.
        seed: u64,
    },
    /// Copy of another case.
    Copy(String),
}

/// Reason why a request is refused, a sentence for the person.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Refused {
    /// No such case, or no picture.
    Unknown(String),
    /// A value is not valid: name of the field and sentence.
    Bad(&'static str, String),
    /// The case was changed by another person, is in use, or is not compiled.
    Conflict(String),
    /// The server cannot do it now.
    Fault(String),
}

impl fmt::Display for Refused {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (Self::Unknown(why) | Self::Bad(_, why) | Self::Conflict(why) | Self::Fault(why)) =
            self;
        f.write_str(why)
    }
}

/// Patients and their compiled scenes. All methods may wait for a disk: callers stand beside the requests.
pub trait Cases: Send + Sync + 'static {
    /// Limits of the patients.
    fn model(&self) -> Model;

    /// All cases in alphabetical order.
    ///
    /// # Errors
    /// The server keeps no cases, or cannot read them.
    fn list(&self) -> Result<Vec<Case>, Refused>;

    /// A case for the form.
    ///
    /// # Errors
    /// No such case exists, or its file cannot be read.
    fn load(&self, name: &str) -> Result<Loaded, Refused>;

    /// Faults of a chart.
    fn check(&self, chart: &Chart) -> Vec<FieldFault>;

    /// Makes a case.
    ///
    /// # Errors
    /// The name is not valid or taken, or the origin is unknown.
    fn create(&self, name: &str, origin: &Origin, by: &str) -> Result<(), Refused>;

    /// Writes a chart into the patient file, whose version must still be `version`.
    ///
    /// # Errors
    /// The file was changed in the meantime, or has a form that cannot be changed without loss.
    fn save(&self, name: &str, version: &str, chart: &Chart, by: &str) -> Result<Loaded, Refused>;

    /// Removes a case.
    ///
    /// # Errors
    /// A plan uses the case.
    fn remove(&self, name: &str, by: &str) -> Result<(), Refused>;

    /// Adds a case to the compilations. A case that waits or runs is not added twice.
    ///
    /// # Errors
    /// No such case exists, or the patient has a fault.
    fn compile(&self, name: &str, by: &str) -> Result<(), Refused>;

    /// Stops the compilation of a case, or takes the case out of those that wait.
    fn cancel(&self, name: &str, by: &str);

    /// Compilations.
    fn work(&self) -> Work;

    /// Picture of the compiled scene from a side, PNG. The first picture of a side takes seconds.
    ///
    /// # Errors
    /// The case is not compiled, or the picture cannot be drawn.
    fn picture(&self, name: &str, side: &str) -> Result<Vec<u8>, Refused>;

    /// Compiled mouth at rest, as a file for the viewer. Takes some seconds.
    ///
    /// # Errors
    /// The case is not compiled, or the program that draws the mouth is missing or fails.
    fn mouth(&self, name: &str) -> Result<Vec<u8>, Refused>;

    /// Text of the plan that uses the compiled scene of a case with an exercise.
    ///
    /// # Errors
    /// The case is not compiled, or the exercise is none for cases.
    fn plan(&self, name: &str, exercise: &str) -> Result<String, Refused>;
}
