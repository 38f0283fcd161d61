//! Rubric of an exercise: weights, targets and critical errors, as a TOML file.
//!
//! A recording carries the same text with the definitions of all metrics. A grade can thus be computed years later from
//! the recording alone.
//!
//! ```toml
//! name = "probing"                # name of its exercise
//! version = 1                     # raised by every change; printed on every page
//! about = "for lists"
//! pass_mark = 70.0                # score, 0 to 100, from which the session is passed
//!
//! [settings]
//! force_n = [0.10, 0.25]          # target band of the force on a floor: schools teach 10 to 25 g
//! reached_mm = 0.5                # distance to the prescribed depth within which the floor counts as reached
//! misread_mm = 0.75               # difference between call and reached depth from which a call is a misreading
//! steady_mm = 1.5                 # motion in half a second up to which a mirror counts as steady
//! ask_bleeding = true             # optional: bleeding must be called; likewise ask_recession, ask_furcation
//!
//! [[metric]]
//! name = "floor_reached"          # name in the table of definitions
//! weight = 16.0
//! target = 95.0                   # value of a full score, or a band [from, to]
//! zero = 60.0                     # value of no score, or a band around the target; linear between both
//! pass = 50.0                     # optional: score of this metric below which the session is not passed
//! deduct = 10.0                   # optional: points off the total below `pass`
//!
//! [[critical]]                    # critical error: the session is not passed, whatever the score
//! metric = "damage_events"
//! above = 0.0                     # or `below`
//! cap = 40.0                      # optional: largest score after this error
//! why = "tissue was damaged"
//! ```

mod bound;
mod check;

use serde::{Deserialize, Serialize};

use super::definitions::{self, Definition};
use super::settings::Settings;
use crate::exercise::{Exercise, Kind};
use crate::record::written::{Written, WrittenError};

pub use bound::Bound;

/// Metric with its weight. A table `[[metric]]` of a rubric.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Weighed {
    /// Name in the table of definitions.
    pub name: String,
    /// Weight in the total, 0 to 100. A metric of weight 0 is reported only.
    pub weight: f64,
    /// Value of a full score.
    pub target: Bound,
    /// Value of no score.
    pub zero: Bound,
    /// Score of this metric below which the session is not passed, 0 to 100.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pass: Option<f64>,
    /// Points off the total if the score of this metric is below `pass`. Other metrics cannot make up for it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub deduct: Option<f64>,
    /// Unit at the time of the recording.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub unit: Option<String>,
    /// Definition at the time of the recording.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub definition: Option<String>,
    /// Source at the time of the recording.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub source: Option<String>,
}

/// Critical error: the session is not passed, whatever the score. A table `[[critical]]` of a rubric.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Critical {
    /// Name of the metric.
    pub metric: String,
    /// Value above which the error occurred. Either `above` or `below` is given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub above: Option<f64>,
    /// Value below which the error occurred.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub below: Option<f64>,
    /// Largest score after this error, 0 to 100.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cap: Option<f64>,
    /// Description of the error, for people.
    pub why: String,
}

/// Rubric of an exercise.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Rubric {
    /// Name of the exercise.
    pub name: String,
    /// Version, from 1.
    pub version: u32,
    /// Description for lists, at most 1024 bytes.
    #[serde(default)]
    pub about: String,
    /// Score from which a session is passed, 0 to 100.
    pub pass_mark: f64,
    /// Settings of the measurement.
    pub settings: Settings,
    /// Metrics with their weights.
    #[serde(rename = "metric")]
    pub metrics: Vec<Weighed>,
    /// Critical errors.
    #[serde(default, rename = "critical", skip_serializing_if = "Vec::is_empty")]
    pub critical: Vec<Critical>,
}

const BUILT_IN: [&str; 4] = [
    include_str!("../../../rubrics/crown.toml"),
    include_str!("../../../rubrics/probing.toml"),
    include_str!("../../../rubrics/retraction.toml"),
    include_str!("../../../rubrics/bimanual.toml"),
];

impl Rubric {
    /// A rubric from its text.
    ///
    /// # Errors
    /// A syntax error, an unknown key or a value out of range: key, value found and value expected.
    pub fn parse(text: &str) -> Result<Self, WrittenError> {
        Self::parsed(text)
    }

    /// A rubric from a recording, and the names of the metrics that this program does not know. Another version of the
    /// program may have recorded them. An unknown metric is left out if the text defines it.
    ///
    /// # Errors
    /// The errors of [`Rubric::parse`]. An unknown metric is an error only without a definition in the text.
    pub fn recorded(text: &str) -> Result<(Self, Vec<String>), WrittenError> {
        let mut rubric: Self = Self::read(text)?;
        let is_known = |name: &str| definitions::find(name).is_some();
        let unknown = |weighed: &&Weighed| !is_known(&weighed.name) && weighed.definition.is_some();
        let unknown: Vec<String> = rubric
            .metrics
            .iter()
            .filter(unknown)
            .map(|weighed| weighed.name.clone())
            .collect();
        rubric
            .metrics
            .retain(|weighed| !unknown.contains(&weighed.name));
        rubric
            .critical
            .retain(|critical| !unknown.contains(&critical.metric));
        rubric.validate()?;
        Ok((rubric, unknown))
    }

    /// A rubric from its file.
    ///
    /// # Errors
    /// The errors of [`Rubric::parse`], and a file that cannot be read.
    pub fn open(path: &std::path::Path) -> Result<Self, WrittenError> {
        Self::opened(path)
    }

    /// Built-in rubrics, one for each exercise.
    pub fn built_in() -> Vec<Self> {
        // A test parses each of them.
        let all = BUILT_IN.iter();
        all.filter_map(|text| Self::parse(text).ok()).collect()
    }

    /// Built-in rubric of the exercise's name, else of its kind. None for a free exercise.
    pub fn of(exercise: &Exercise) -> Option<Self> {
        let kind = match exercise.kind {
            Kind::Crown => "crown",
            Kind::Probing => "probing",
            Kind::Retraction => "retraction",
            Kind::Bimanual => "bimanual",
            Kind::Free => return None,
        };
        let all = Self::built_in();
        let named = |name: &str| all.iter().find(|rubric| rubric.name == name).cloned();
        named(&exercise.name).or_else(|| named(kind))
    }

    /// Text for a recording, with units, definitions and sources of all metrics.
    ///
    /// # Errors
    /// A value that TOML cannot express. A valid rubric has none.
    pub fn definition(&self) -> Result<String, WrittenError> {
        let mut full = self.clone();
        for weighed in &mut full.metrics {
            if let Some(known) = definitions::find(&weighed.name) {
                weighed.unit = Some(known.unit.into());
                weighed.definition = Some(known.definition.into());
                weighed.source = Some(known.source.into());
            }
        }
        toml::to_string(&full).map_err(|error| Self::syntax(&error))
    }

    /// Names of the metrics whose recorded definition or unit differs from this program's in meaning. Earlier words
    /// of the same meaning do not count.
    pub fn redefined(&self) -> Vec<&str> {
        let differs = |weighed: &&Weighed, known: &Definition| {
            let meaning = weighed.definition.as_deref();
            let unit = weighed.unit.as_deref();
            meaning.is_some_and(|was| !known.is_meant_by(was))
                || unit.is_some_and(|was| was != known.unit)
        };
        let all = self.metrics.iter().filter(|weighed| {
            definitions::find(&weighed.name).is_some_and(|known| differs(weighed, known))
        });
        all.map(|weighed| weighed.name.as_str()).collect()
    }
}
