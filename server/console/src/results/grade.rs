//! Grade of a session, as far as the console shows it: the object that `sulcus-sessions grade --json` prints.
//!
//! Unknown fields are ignored and missing ones empty, so that a grade of another version of the program can be shown.

use serde::Deserialize;
use serde_json::Value;

/// Grade of a session.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(default)]
pub struct Grade {
    /// Score from which the session is passed.
    pub pass_mark: Option<f64>,
    /// Reasons against a pass.
    pub failures: Vec<String>,
    /// Critical errors that occurred.
    pub critical: Vec<Critical>,
    /// Metrics.
    pub metrics: Vec<Metric>,
    /// Zones of the exercise, and other called zones.
    pub sites: Vec<Zone>,
    /// Advice to the learner.
    pub advice: Vec<Advice>,
    /// Moments that explain the grade.
    pub moments: Vec<Moment>,
    /// Program that made the grade.
    pub graded_by: GradedBy,
    /// Reason for an early end, if there was one.
    pub ended_early: Option<String>,
}

/// Program that made a grade.
#[derive(Clone, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(default)]
pub struct GradedBy {
    /// Version.
    pub version: String,
}

/// Critical error.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(default)]
pub struct Critical {
    /// Description.
    pub why: String,
    /// Largest score after the error.
    pub cap: Option<f64>,
}

/// Metric.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(default)]
pub struct Metric {
    /// Name.
    pub name: String,
    /// Title for people.
    pub title: String,
    /// Value in `unit`.
    pub value: Option<f64>,
    /// Unit; empty for a pure number.
    pub unit: String,
    /// Value of a full score, or a band of such values.
    pub target: Value,
    /// Weight in the total.
    pub weight: f64,
    /// Score, 0 to 100.
    pub score: Option<f64>,
    /// Reason why the metric is not judged.
    pub not_judged: Option<String>,
    /// Definition.
    pub definition: String,
    /// Source of the definition.
    pub source: String,
}

impl Metric {
    /// Number of points that the metric cost, of the 100 of a session whose weights sum to `weights`.
    pub fn lost(&self, weights: f64) -> f64 {
        let score = self.score.filter(|_| weights > 0.0 && self.weight > 0.0);
        score.map_or(0.0, |score| (100.0 - score) * self.weight / weights)
    }

    /// Target in words.
    pub fn target_words(&self) -> String {
        match &self.target {
            Value::Number(number) => number.to_string(),
            Value::Array(band) => match band.as_slice() {
                [from, to] => format!("{from} to {to}"),
                _ => String::new(),
            },
            _ => String::new(),
        }
    }
}

/// Zone of a session.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(default)]
pub struct Zone {
    /// FDI number of the tooth.
    pub tooth: u8,
    /// Name of the site.
    pub site: String,
    /// Whether the zone is one of the exercise.
    pub asked: bool,
    /// Prescribed depth, mm; empty in an exam.
    pub truth_mm: Option<f64>,
    /// Reached depth, mm; empty in an exam.
    pub measured_mm: Option<f64>,
    /// Called depth, whole mm.
    pub called_mm: Option<u8>,
    /// Largest force on the floor, newtons.
    pub max_force_n: Option<f64>,
    /// Finding; empty in an exam.
    pub finding: String,
}

impl Zone {
    /// Finding in words.
    pub fn finding_words(&self) -> &str {
        match self.finding.as_str() {
            "right" => "right",
            "missed" => "missed",
            "not_probed" => "called, not probed first",
            "not_called" => "not called",
            "never_reached_floor" => "never reached the floor",
            "misread" => "misread the band",
            "read_too_heavy" => "read under too much force",
            "read_tilted" => "read along a tilted probe",
            "off" => "more than 1 mm off",
            other => other,
        }
    }
}

/// Advice to the learner.
#[derive(Clone, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(default)]
pub struct Advice {
    /// Advice in words.
    pub text: String,
    /// Zones that show the weakness.
    pub sites: Vec<String>,
}

/// Moment that explains the grade.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(default)]
pub struct Moment {
    /// Tick of the session.
    pub tick: u64,
    /// Time in the session, seconds.
    pub at_s: f64,
    /// `finding`, `trauma`, `flag` or `note`.
    pub kind: String,
    /// FDI number of the tooth.
    pub tooth: Option<u8>,
    /// Name of the site.
    pub site: Option<String>,
    /// Description.
    pub text: String,
    /// Opaque id of the instructor.
    pub by: Option<String>,
}

impl Moment {
    /// Time as minutes and seconds.
    pub fn time(&self) -> String {
        // Negative and absurd times of a damaged file saturate.
        let seconds = self.at_s as u64;
        format!("{}:{:02}", seconds / 60, seconds % 60)
    }
}

impl Grade {
    /// Grade of the printed object. An object of another form is an empty grade, and is logged.
    pub fn of(object: &Value) -> Self {
        Self::deserialize(object).unwrap_or_else(|error| {
            tracing::error!("console: a grade cannot be read: {error}");
            Self::default()
        })
    }

    /// Sum of the weights of the metrics that count.
    pub fn weights(&self) -> f64 {
        let counted = self.metrics.iter().filter(|metric| metric.score.is_some());
        counted.map(|metric| metric.weight).sum()
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use serde_json::json;

    use super::*;

    #[test]
    fn a_grade_of_the_program_is_read() {
        let object = json!({
            "score": 61.5, "pass_mark": 70.0, "new_field": [1],
            "metrics": [{ "name": "misread", "title": "bands misread", "value": 10.0, "unit": "%", "target": [0, 5],
                "weight": 2.0, "score": 50.0 }, { "name": "x", "weight": 2.0, "score": 100.0 }],
            "sites": [{ "tooth": 36, "site": "buccal", "truth_mm": 3.4, "called_mm": 5, "finding": "misread" }],
            "moments": [{ "tick": 9, "at_s": 75.2, "kind": "flag", "text": "see", "by": "t" }],
            "ended_early": null,
        });
        let grade = Grade::of(&object);
        assert_eq!(grade.weights(), 4.0);
        assert_eq!(grade.metrics[0].lost(grade.weights()), 25.0);
        assert_eq!(grade.metrics[0].target_words(), "0 to 5");
        assert_eq!(
            (grade.sites[0].truth_mm, grade.sites[0].called_mm),
            (Some(3.4), Some(5))
        );
        assert_eq!(grade.sites[0].finding_words(), "misread the band");
        assert_eq!(grade.moments[0].time(), "1:15");
        assert_eq!(Grade::of(&json!({ "metrics": 3 })), Grade::default());
    }

    proptest! {
        #[test]
        fn no_object_stops_the_console(text in "\\PC{0,40}", number in any::<f64>(), tooth in any::<i64>()) {
            let object = json!({
                "metrics": [{ "name": text, "value": number, "target": [number, text], "score": number }],
                "sites": [{ "tooth": tooth, "site": text, "called_mm": tooth }],
                "moments": [{ "at_s": number, "kind": text }],
            });
            let grade = Grade::of(&object);
            for metric in &grade.metrics {
                let _ = (metric.target_words(), metric.lost(grade.weights()));
            }
            for moment in &grade.moments {
                let _ = moment.time();
            }
        }
    }
}
