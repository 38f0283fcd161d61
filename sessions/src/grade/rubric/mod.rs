//! What counts how much: a TOML file for each exercise. The same text, with the definitions of its metrics written out, goes
//! into the recording, so that a grade can be recomputed years later from the recording alone.
//!
//! ```toml
//! name = "probing"                # of the exercise that it is for
//! version = 1                     # raised by whoever changes it; stands on every page
//! about = "for lists"
//! pass_mark = 70.0                # score of 0 to 100 from which the session is passed
//!
//! [settings]
//! force_n = [0.10, 0.25]          # target band of the force on a floor: schools teach 10 to 25 g
//! reached_mm = 0.5                # so near to the prescribed depth the floor counts as reached
//! misread_mm = 0.75               # a call so far from what the tip reached is a misreading
//! steady_mm = 1.5                 # a mirror is steady that moves less in half a second
//! ask_bleeding = true             # who calls none at all has nothing right; likewise ask_recession, ask_furcation; may be left out
//!
//! [[metric]]
//! name = "floor_reached"          # one of the table of definitions
//! weight = 16.0
//! target = 95.0                   # value of a full score; [from, to] where both sides count
//! zero = 60.0                     # value of no score; linear between
//! pass = 50.0                     # score of this metric without which nothing is passed; may be left out
//! deduct = 10.0                   # points off the total then; may be left out
//!
//! [[critical]]                    # errors that fail, whatever the score
//! metric = "damage_events"
//! above = 0.0                     # or `below`
//! cap = 40.0                      # most that the score can be then; may be left out
//! why = "tissue was damaged"
//! ```

mod bound;
mod check;

use serde::{Deserialize, Serialize};

use super::definitions::{self, Definition};
use crate::exercise::{Exercise, Kind};
use crate::record::written::{Written, WrittenError};

pub use bound::Bound;

/// Settings of the measurement itself.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Settings {
    /// Target band of the force on a floor, N. Range 0.02 to 5. Schools teach 10 to 25 g.
    pub force_n: [f64; 2],
    /// So near to the prescribed depth the floor counts as reached, mm. Range 0.1 to 5.
    pub reached_mm: f64,
    /// A call farther than this from what the tip reached is a misreading, mm: half of it is rounding. Range 0.5 to 5.
    pub misread_mm: f64,
    /// A mirror is steady that is no farther than this from where it was half a second before, mm. Range 0.1 to 20.
    pub steady_mm: f64,
    /// Whether recession is to be called: who calls none at all has none right. Else it counts from the first call of it.
    #[serde(default, skip_serializing_if = "is_no")]
    pub ask_recession: bool,
    /// Likewise of bleeding.
    #[serde(default, skip_serializing_if = "is_no")]
    pub ask_bleeding: bool,
    /// Likewise of furcation.
    #[serde(default, skip_serializing_if = "is_no")]
    pub ask_furcation: bool,
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "as serde calls it")]
fn is_no(yes: &bool) -> bool {
    !yes
}

/// A metric, weighed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Weighed {
    /// Its name.
    pub name: String,
    /// How much it counts against the others; 0: reported only.
    pub weight: f64,
    /// Value of a full score.
    pub target: Bound,
    /// Value of no score.
    pub zero: Bound,
    /// Score of this metric without which nothing is passed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pass: Option<f64>,
    /// Points taken off the total where this metric is under its `pass`: what is essential is not made up for elsewhere.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub deduct: Option<f64>,
    /// Unit, as it was when this text was recorded.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub unit: Option<String>,
    /// Definition, as it was when this text was recorded.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub definition: Option<String>,
    /// Source, as it was when this text was recorded.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub source: Option<String>,
}

/// An error that fails, whatever the score.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Critical {
    /// Metric.
    pub metric: String,
    /// It fails above this value.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub above: Option<f64>,
    /// Or below this one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub below: Option<f64>,
    /// Most that the score can be then.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cap: Option<f64>,
    /// What happened, for people.
    pub why: String,
}

/// A rubric.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Rubric {
    /// Name of the exercise that it is for.
    pub name: String,
    /// Its version.
    pub version: u32,
    /// For lists.
    #[serde(default)]
    pub about: String,
    /// Score from which a session is passed.
    pub pass_mark: f64,
    /// Settings of the measurement.
    pub settings: Settings,
    /// What counts.
    #[serde(rename = "metric")]
    pub metrics: Vec<Weighed>,
    /// What fails.
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
    /// Names the key, the value found and what is expected; says so of unknown keys too.
    pub fn parse(text: &str) -> Result<Self, WrittenError> {
        Self::parsed(text)
    }

    /// A rubric from a recording, and the names of those of its metrics that this program does not know: where it was made by a later or
    /// an earlier one, the others still say what they said.
    ///
    /// # Errors
    /// As [`Rubric::parse`], but for metrics whose definition stands in the text.
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
    /// As [`Rubric::parse`], and when the file cannot be read.
    pub fn open(path: &std::path::Path) -> Result<Self, WrittenError> {
        Self::opened(path)
    }

    /// The rubrics that the programs bring along, one for each exercise.
    pub fn built_in() -> Vec<Self> {
        // (A test parses each.)
        let all = BUILT_IN.iter();
        all.filter_map(|text| Self::parse(text).ok()).collect()
    }

    /// The rubric for an exercise: of its name, else of its kind; none where nothing in particular is asked.
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

    /// The text for a recording, with units, definitions and sources written out.
    ///
    /// # Errors
    /// Never for a rubric that is valid.
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

    /// Names of the metrics whose recorded definition is not this program's: their values may have another meaning.
    pub fn redefined(&self) -> Vec<&str> {
        let differs = |weighed: &&Weighed, known: &Definition| {
            let other = |was: &Option<String>, is| was.as_deref().is_some_and(|was| was != is);
            other(&weighed.definition, known.definition) || other(&weighed.unit, known.unit)
        };
        let all = self.metrics.iter().filter(|weighed| {
            definitions::find(&weighed.name).is_some_and(|known| differs(weighed, known))
        });
        all.map(|weighed| weighed.name.as_str()).collect()
    }
}
