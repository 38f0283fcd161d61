//! A grade as data: what is printed as JSON, and what tables and pages are made of.

use std::fmt;

use serde::{Serialize, Serializer};

use super::floor::FloorTime;
use super::rubric::{Bound, Rubric, Settings};
use super::sites::SiteGrade;
use super::stats::rounded;
use crate::exercise::Exercise;
use crate::record::bytes::hex;
use crate::record::format::Migration;
use crate::record::header::SessionHeader;
use crate::record::written::WrittenError;
use crate::replay::ReplayReport;

/// Where a rubric came from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Source {
    /// It travelled in the recording.
    Recording,
    /// The recording has none: this program's, for its exercise.
    BuiltIn,
    /// A file given instead of the recording's own.
    File,
}

impl Source {
    /// As in JSON.
    pub fn words(self) -> &'static str {
        match self {
            Self::Recording => "recording",
            Self::BuiltIn => "built_in",
            Self::File => "file",
        }
    }
}

/// A rubric, and where it came from.
#[derive(Clone, Debug, PartialEq)]
pub struct Standard {
    /// The rubric.
    pub rubric: Rubric,
    /// Where it came from.
    pub source: Source,
    /// blake3 of its text.
    pub blake3: [u8; 32],
    /// Metrics that a recorded one asks for and this program does not know.
    pub unknown: Vec<String>,
}

impl Standard {
    /// What a session is graded by: a rubric given instead, else the recording's, else the built-in one of its exercise; none
    /// where nothing in particular was asked.
    ///
    /// # Errors
    /// When the recording's rubric cannot be used.
    pub fn of(
        header: &SessionHeader,
        exercise: &Exercise,
        instead: Option<&Rubric>,
    ) -> Result<Option<Self>, WrittenError> {
        let made = |rubric: Rubric, source| {
            let text = rubric.definition()?;
            let blake3 = *blake3::hash(text.as_bytes()).as_bytes();
            Ok(Some(Self {
                rubric,
                source,
                blake3,
                unknown: Vec::new(),
            }))
        };
        if let Some(rubric) = instead {
            return made(rubric.clone(), Source::File);
        }
        if header.rubric.is_empty() {
            return match Rubric::of(exercise) {
                Some(rubric) => made(rubric, Source::BuiltIn),
                None => Ok(None),
            };
        }
        let (rubric, unknown) = Rubric::recorded(&header.rubric)?;
        Ok(Some(Self {
            rubric,
            unknown,
            source: Source::Recording,
            blake3: *blake3::hash(header.rubric.as_bytes()).as_bytes(),
        }))
    }

    pub(super) fn used(&self) -> RubricUsed {
        RubricUsed {
            name: self.rubric.name.clone(),
            version: self.rubric.version,
            blake3: hex(&self.blake3),
            source: self.source,
            unknown: self.unknown.clone(),
            redefined: self
                .rubric
                .redefined()
                .into_iter()
                .map(Into::into)
                .collect(),
        }
    }
}

/// Which rubric a grade is by.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct RubricUsed {
    /// Its name.
    pub name: String,
    /// Its version.
    pub version: u32,
    /// blake3 of its text, hexadecimal.
    pub blake3: String,
    /// Where it came from.
    pub source: Source,
    /// Metrics whose definition in it is not this program's: their values are by this program's definition.
    pub redefined: Vec<String>,
    /// Metrics that it asks for and this program does not know: they are not measured, and count for nothing.
    pub unknown: Vec<String>,
}

/// A metric's value and what it is worth.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MetricGrade {
    /// Name in rubrics.
    pub name: &'static str,
    /// For people.
    pub title: &'static str,
    /// Value; null where there was nothing to measure.
    pub value: Option<f64>,
    /// Unit; empty for a pure number.
    pub unit: &'static str,
    /// Value of a full score, or from and to.
    pub target: Bound,
    /// Value of no score, or from and to.
    pub zero: Bound,
    /// How much it counts against the others.
    pub weight: f64,
    /// 0 to 100; null where it does not count.
    pub score: Option<f64>,
    /// Score without which nothing is passed.
    pub pass: Option<f64>,
    /// Points taken off the total because it is under that.
    pub deducted: f64,
    /// What exactly is measured.
    pub definition: &'static str,
    /// And how the recording has it, where that is otherwise: what the rubric's bounds were made for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub recorded_definition: Option<String>,
    /// Where it comes from.
    pub source: &'static str,
}

/// A critical error that was made.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CriticalError {
    /// Metric.
    pub metric: String,
    /// In words.
    pub why: String,
    /// Most that the score can be then.
    pub cap: Option<f64>,
}

/// Something to practise.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Advice {
    /// The metric that lost the points.
    pub metric: &'static str,
    /// Its title.
    pub title: &'static str,
    /// What to do.
    pub text: String,
    /// Zones that show it, in words.
    pub sites: Vec<ShownBy>,
}

/// The numbers that definitions name.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Thresholds {
    /// The rubric's settings.
    #[serde(flatten)]
    pub settings: Settings,
    /// Tilt against the tooth's axis that is allowed in the middle of a side, degrees.
    pub mid_tilt_deg: f64,
    /// Tilt into the col that is asked for beside a neighbour, degrees.
    pub proximal_tilt_deg: [f64; 2],
}

impl Thresholds {
    /// For people.
    pub fn words(&self) -> String {
        let (set, [least, most]) = (&self.settings, self.proximal_tilt_deg);
        let asked = [
            (set.ask_recession, ", recession is asked for"),
            (set.ask_bleeding, ", bleeding is asked for"),
            (set.ask_furcation, ", furcation is asked for"),
        ];
        let asked = asked.iter().filter(|one| one.0).map(|one| one.1);
        let asked: String = asked.collect();
        format!(
            "target band of force {} to {} N, reached_mm {}, misread_mm {}, steady_mm {}, mid_tilt_deg {}, proximal_tilt_deg {least} to {most}{asked}",
            set.force_n[0],
            set.force_n[1],
            set.reached_mm,
            set.misread_mm,
            set.steady_mm,
            self.mid_tilt_deg,
        )
    }
}

/// A zone that shows a weakness. As text it begins with the FDI number of the tooth.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ShownBy {
    /// FDI number of the tooth.
    pub tooth: u8,
    /// Which zone, and how it shows.
    pub says: String,
}

impl fmt::Display for ShownBy {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {}", self.tooth, self.says)
    }
}

impl Serialize for ShownBy {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        to.collect_str(self)
    }
}

/// A recording of a former version, run again by the present tick.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Migrated {
    /// From which version to which, and what was different.
    #[serde(flatten)]
    pub migration: Migration,
    /// Root mean square of the difference between recorded and replayed force, newtons.
    pub rms_force_n: f64,
    /// Largest such difference, newtons.
    pub max_force_n: f64,
    /// Largest difference in a graphic tool's place at snapshots, millimetres.
    pub max_pose_mm: f64,
}

impl Migrated {
    /// What a replay found.
    pub fn of(report: &ReplayReport) -> Option<Self> {
        let deviation = &report.deviation;
        // (A row may claim what no rounding bears.)
        let said = |x: f64| if x < 1e9 { rounded(x, 6) } else { 1e9 };
        Some(Self {
            migration: report.migration?,
            rms_force_n: said(deviation.rms_force_n),
            max_force_n: said(deviation.max_force_n),
            max_pose_mm: said(deviation.max_pose_mm.unwrap_or_default()),
        })
    }
}

impl std::fmt::Display for Migrated {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(
            f,
            "{}; run again, forces differ by {:.4} N rms ({:.3} N at most), tools' places by {:.4} mm",
            self.migration, self.rms_force_n, self.max_force_n, self.max_pose_mm
        )
    }
}

/// What a program proposes as the grade of a session.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Grade {
    /// Opaque learner id.
    pub learner_id: String,
    /// Exercise.
    pub exercise: String,
    /// Station.
    pub station: String,
    /// Seed of the simulated hand; 0 for a person.
    pub seed: u64,
    /// When the session began, nanoseconds since the Unix epoch.
    pub started_unix_ns: u64,
    /// Public key that signed the recording, hexadecimal.
    pub signer: String,
    /// Whether that key was given from outside, rather than taken from the recording.
    pub signer_trusted: bool,
    /// Whether a grade may rest on the recording.
    pub gradable: bool,
    /// Why not.
    pub reason: Option<String>,
    /// Where the recording is of a former version of the format: what was made of it.
    pub migrated: Option<Migrated>,
    /// The rubric; null where there is none.
    pub rubric: Option<RubricUsed>,
    /// 0 to 100; null where there is no grade.
    pub score: Option<f64>,
    /// Score from which it is passed.
    pub pass_mark: Option<f64>,
    /// Whether it is passed.
    pub passed: Option<bool>,
    /// Why it is not passed, in words.
    pub failures: Vec<String>,
    /// Critical errors that were made.
    pub critical: Vec<CriticalError>,
    /// Every metric of the rubric that applies to the exercise.
    pub metrics: Vec<MetricGrade>,
    /// Every zone that was asked for, then those called besides.
    pub sites: Vec<SiteGrade>,
    /// Target band of the force on a floor, newtons.
    pub force_band_n: Option<[f64; 2]>,
    /// What definitions name: the rubric's settings and the exercise's.
    pub thresholds: Option<Thresholds>,
    /// Time on the floor by zones of force.
    pub floor_time: FloorTime,
    /// What to practise next, the dearest first.
    pub advice: Vec<Advice>,
    /// What was asked for and the scene has not, in words.
    pub missing: Vec<String>,
    /// Why the session ended before its time, in words: what was not done need not be the learner's fault.
    pub ended_early: Option<&'static str>,
}

impl Grade {
    /// What takes from its worth, in words: what is said, and of what.
    pub fn reservations(&self) -> Vec<(&'static str, String)> {
        let used = self.rubric.as_ref();
        let names = |of: fn(&RubricUsed) -> &Vec<String>| {
            used.map_or(String::new(), |used| of(used).join(", "))
        };
        let all = [
            (
                "ended early",
                self.ended_early.unwrap_or_default().to_owned(),
            ),
            ("the scene has not", self.missing.join(", ")),
            (
                "defined otherwise in the recording",
                names(|used| &used.redefined),
            ),
            (
                "asked for in the recording, not known to this program (nor what would fail by it)",
                names(|used| &used.unknown),
            ),
        ];
        all.into_iter()
            .filter(|(_, what)| !what.is_empty())
            .collect()
    }

    /// The metric of that name, where it applies.
    pub fn metric(&self, name: &str) -> Option<&MetricGrade> {
        self.metrics.iter().find(|metric| metric.name == name)
    }

    /// As JSON: the same bytes wherever it is made.
    ///
    /// # Panics
    /// Never: a grade has no keys but text, and no numbers that are not finite.
    pub fn to_json(&self) -> serde_json::Value {
        serde_json::to_value(self).unwrap_or_default()
    }
}
