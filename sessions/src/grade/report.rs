//! Grade as data: the source of JSON, tables and pages.

use std::fmt;

use serde::{Serialize, Serializer};

use super::felt::Felt;
use super::floor_time::FloorTime;
use super::parts::PartFacts;
use super::rubric::{Bound, Rubric};
use super::settings::Settings;
use super::sites::SiteGrade;
use super::stats::rounded;
use super::unfelt::Unfelt;
use crate::exercise::Exercise;
use crate::record::bytes::hex;
use crate::record::format::Migration;
use crate::record::header::SessionHeader;
use crate::record::written::WrittenError;
use crate::replay::ReplayReport;

/// Source of a rubric.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Source {
    /// Rubric of the recording.
    Recording,
    /// This program's rubric for the exercise, if the recording has none.
    BuiltIn,
    /// File that was given instead of the recording's rubric.
    File,
}

impl Source {
    /// Name in JSON.
    pub fn words(self) -> &'static str {
        match self {
            Self::Recording => "recording",
            Self::BuiltIn => "built_in",
            Self::File => "file",
        }
    }
}

/// Rubric with its source.
#[derive(Clone, Debug, PartialEq)]
pub struct Standard {
    /// Rubric.
    pub rubric: Rubric,
    /// Source of the rubric.
    pub source: Source,
    /// blake3 of the rubric's text.
    pub blake3: [u8; 32],
    /// Metrics of a recorded rubric that this program does not know.
    pub unknown: Vec<String>,
}

impl Standard {
    /// Rubric for a session: `instead` if given, else the recording's, else the built-in rubric of the exercise.
    /// None for a free exercise without a rubric.
    ///
    /// # Errors
    /// A rubric of the recording that cannot be used.
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

/// Rubric of a grade.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct RubricUsed {
    /// Name.
    pub name: String,
    /// Version.
    pub version: u32,
    /// blake3 of the text, hexadecimal.
    pub blake3: String,
    /// Source.
    pub source: Source,
    /// Metrics whose recorded definition differs from this program's, in words or in meaning. Their values follow this
    /// program's definition.
    pub redefined: Vec<String>,
    /// Metrics that this program does not know. They have no value and no weight.
    pub unknown: Vec<String>,
}

/// Metric of a grade: value, scale and score.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MetricGrade {
    /// Name in rubrics.
    pub name: &'static str,
    /// Title for people.
    pub title: &'static str,
    /// Value in `unit`; null if there was nothing to measure.
    pub value: Option<f64>,
    /// Unit; empty for a pure number.
    pub unit: &'static str,
    /// Value of a full score, or a band.
    pub target: Bound,
    /// Value of no score, or a band.
    pub zero: Bound,
    /// Weight in the total.
    pub weight: f64,
    /// Score, 0 to 100; null if the metric does not count.
    pub score: Option<f64>,
    /// Reason why the metric is not judged, as one sentence. Score and critical errors are then left out. Absent for a
    /// metric that is judged.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub not_judged: Option<String>,
    /// Score of this metric below which the session is not passed.
    pub pass: Option<f64>,
    /// Points off the total for a score below `pass`.
    pub deducted: f64,
    /// This program's definition. The value follows it.
    pub definition: &'static str,
    /// Definition in the recording, if it differs from this program's. The rubric's bounds were made for it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub recorded_definition: Option<String>,
    /// Source of the definition.
    pub source: &'static str,
}

/// Critical error that occurred.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CriticalError {
    /// Name of the metric.
    pub metric: String,
    /// Description from the rubric.
    pub why: String,
    /// Largest score after this error.
    pub cap: Option<f64>,
}

/// Advice to a learner.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Advice {
    /// Name of the metric that lost points.
    pub metric: &'static str,
    /// Title of the metric.
    pub title: &'static str,
    /// Advice in words.
    pub text: String,
    /// Zones that show the weakness, in words.
    pub sites: Vec<ShownBy>,
}

/// Thresholds that definitions name.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Thresholds {
    /// Settings of the rubric.
    #[serde(flatten)]
    pub settings: Settings,
    /// Largest tilt against the tooth's axis in the middle of a side, degrees.
    pub mid_tilt_deg: f64,
    /// Band of the tilt into the col beside a neighbour, degrees.
    pub proximal_tilt_deg: [f64; 2],
}

impl Thresholds {
    /// Thresholds in words, for people.
    pub fn words(&self) -> String {
        let (set, [least, most]) = (&self.settings, self.proximal_tilt_deg);
        let asked = [
            (set.ask_recession, ", recession must be called"),
            (set.ask_bleeding, ", bleeding must be called"),
            (set.ask_furcation, ", furcation must be called"),
        ];
        let asked = asked.iter().filter(|one| one.0).map(|one| one.1);
        let asked: String = asked.collect();
        format!(
            "target band force_n {} to {} N, reached_mm {}, misread_mm {}, steady_mm {}, mid_tilt_deg {}, proximal_tilt_deg {least} to {most}{asked}",
            set.force_n[0],
            set.force_n[1],
            set.reached_mm,
            set.misread_mm,
            set.steady_mm,
            self.mid_tilt_deg,
        )
    }
}

/// Zone that shows a weakness. As text it begins with the FDI number of the tooth.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ShownBy {
    /// FDI number of the tooth.
    pub tooth: u8,
    /// Site, and the sign of the weakness.
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

/// Migration of a recording of a former version: differences between the record and the present tick.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Migrated {
    /// Former and present version, with the difference in words.
    #[serde(flatten)]
    pub migration: Migration,
    /// Root mean square of the difference between recorded and replayed force, newtons.
    pub rms_force_n: f64,
    /// Largest such difference, newtons.
    pub max_force_n: f64,
    /// Largest difference of a graphic tool's place at a snapshot, millimetres.
    pub max_pose_mm: f64,
}

impl Migrated {
    /// Differences that a replay found. None for a recording of the present version.
    pub fn of(report: &ReplayReport) -> Option<Self> {
        let deviation = &report.deviation;
        // A forged row may claim a number too large for rounding.
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
            "{}; in the replay, forces differ by {:.4} N rms, {:.3} N at most, and places of tools by {:.4} mm",
            self.migration, self.rms_force_n, self.max_force_n, self.max_pose_mm
        )
    }
}

/// Grade of a session, as the program proposes it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Grade {
    /// Opaque learner id.
    pub learner_id: String,
    /// Name of the exercise.
    pub exercise: String,
    /// Name of the station.
    pub station: String,
    /// Seed of the simulated hand; 0 for a person.
    pub seed: u64,
    /// Beginning of the session, nanoseconds since the Unix epoch.
    pub started_unix_ns: u64,
    /// Public key that signed the recording, hexadecimal.
    pub signer: String,
    /// Whether that key was given from outside, and not taken from the recording.
    pub signer_trusted: bool,
    /// Whether the recording can be graded.
    pub gradable: bool,
    /// Reason against a grade.
    pub reason: Option<String>,
    /// Migration of a recording of a former version of the format.
    pub migrated: Option<Migrated>,
    /// Rubric; null for a session without one.
    pub rubric: Option<RubricUsed>,
    /// Score, 0 to 100; null without a grade.
    pub score: Option<f64>,
    /// Score from which the session is passed.
    pub pass_mark: Option<f64>,
    /// Whether the session is passed; null without a grade. Outside of practice also null if nothing failed, and a
    /// metric with a weight or a critical error is not judged.
    pub passed: Option<bool>,
    /// Reasons against a pass, in words.
    pub failures: Vec<String>,
    /// Critical errors that occurred.
    pub critical: Vec<CriticalError>,
    /// Metrics of the rubric that apply to the exercise.
    pub metrics: Vec<MetricGrade>,
    /// Zones of the exercise, then other zones that were called.
    pub sites: Vec<SiteGrade>,
    /// Target band of the force on a floor, newtons.
    pub force_band_n: Option<[f64; 2]>,
    /// Thresholds that definitions name.
    pub thresholds: Option<Thresholds>,
    /// Time on the floor, by zone of force.
    pub floor_time: FloorTime,
    /// Advice to the learner, by points lost.
    pub advice: Vec<Advice>,
    /// Parts of the exercise that the scene lacks, in words.
    pub missing: Vec<String>,
    /// Reason for an early end of the session, in words. A missing part need not be the learner's fault.
    pub ended_early: Option<&'static str>,
    /// Gaps of the connection; absent without a gap.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gaps: Option<Gaps>,
    /// Force that the hand felt; absent without samples of a device. No metric uses it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub felt: Option<Felt>,
    /// Devices with a force or torque that the hand did not feel; absent without such a device.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub unfelt: Vec<Unfelt>,
    /// Recordings of the session; absent for a session in one recording.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub parts: Vec<PartFacts>,
}

/// Gaps of the connection in a session. They count for no metric.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Gaps {
    /// Number of gaps in which the student was away.
    pub count: u64,
    /// Sum of their lengths, seconds, with the ways back to the hand.
    pub seconds: f64,
    /// Whether the clock of the session ran in them.
    pub clock_ran: bool,
}

/// Sum of the gaps from which a grade names them, seconds. Chosen: a late packet is no interruption.
const NAMED_S: f64 = 1.0;

impl Gaps {
    /// The gaps in words; empty if they are short.
    fn words(&self) -> String {
        if self.seconds < NAMED_S {
            return String::new();
        }
        let plural = if self.count == 1 { "" } else { "s" };
        let clock = if self.clock_ran { "ran" } else { "stood" };
        format!(
            "{} gap{plural}, {:.1} s, which count for no metric; the clock {clock}",
            self.count, self.seconds
        )
    }
}

impl Grade {
    /// Reservations about the grade: kind and details, in words.
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
            (
                "connection interrupted",
                self.gaps.map_or(String::new(), |gaps| gaps.words()),
            ),
            (
                "force at the hand differs",
                self.felt.map_or(String::new(), |felt| felt.reservation()),
            ),
            ("not felt by the hand", {
                let texts: Vec<&str> = self.unfelt.iter().map(|one| &*one.text).collect();
                texts.join("; ")
            }),
            (
                "continued after a stop of the station",
                match self.parts.len() {
                    0 | 1 => String::new(),
                    n => format!("{n} recordings, between which up to 200 ms may be lost"),
                },
            ),
            ("missing in the scene", self.missing.join(", ")),
            (
                "definition differs from the recorded one",
                names(|used| &used.redefined),
            ),
            (
                "unknown to this program, without value and critical error",
                names(|used| &used.unknown),
            ),
        ];
        all.into_iter()
            .filter(|(_, what)| !what.is_empty())
            .collect()
    }

    /// Verdict in words; `None` without a grade.
    pub fn verdict(&self) -> Option<&'static str> {
        self.score?;
        Some(match self.passed {
            Some(true) => "passed",
            Some(false) => "not passed",
            None => "not decided",
        })
    }

    /// Metric of that name. None if it does not apply.
    pub fn metric(&self, name: &str) -> Option<&MetricGrade> {
        self.metrics.iter().find(|metric| metric.name == name)
    }

    /// Grade as JSON, the same bytes on every machine.
    ///
    /// # Panics
    /// Never: all keys of a grade are text.
    pub fn to_json(&self) -> serde_json::Value {
        serde_json::to_value(self).unwrap_or_default()
    }
}
