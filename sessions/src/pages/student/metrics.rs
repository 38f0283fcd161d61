//! Metrics of a session's page: values, targets and scores, and their definitions.

use crate::grade::report::{Grade, MetricGrade};
use crate::grade::rubric::Bound;
use crate::grade::run::MEASURES_SOURCE;
use crate::grade::text;

/// Score below which a weighed metric is bold.
const WEAK: f64 = 50.0;

/// Metrics, as the template `student/metrics.html` takes them.
pub struct Metrics<'a> {
    /// Metrics that count.
    pub rows: Vec<Row<'a>>,
    /// Other metrics: kind, and titles in words.
    pub rest: Vec<(&'static str, String)>,
}

/// One metric that counts.
pub struct Row<'a> {
    /// Metric.
    pub metric: &'a MetricGrade,
    /// Value with its unit.
    pub value: String,
    /// Target.
    pub target: String,
    /// Score.
    pub score: f64,
    /// Whether the score is low.
    pub weak: bool,
}

impl<'a> Metrics<'a> {
    /// Metrics of a grade.
    pub fn of(grade: &'a Grade) -> Self {
        let mut rows = Vec::new();
        let (mut reported, mut not, mut open) = (Vec::new(), Vec::new(), Vec::new());
        for metric in &grade.metrics {
            let value = text::value(metric);
            match metric.score {
                _ if metric.not_judged.is_some() => open.push(metric.title.to_owned()),
                _ if metric.weight == 0.0 => reported.push(format!("{} {value}", metric.title)),
                None => not.push(metric.title.to_owned()),
                Some(score) => rows.push(Row {
                    metric,
                    value,
                    target: bound(&metric.target),
                    score,
                    weak: metric.weight > 0.0 && score < WEAK,
                }),
            }
        }
        let rest = [
            ("Reported only", reported),
            ("Nothing to measure", not),
            ("Not judged, because the hand did not feel the force", open),
        ];
        let rest = rest.into_iter().filter(|(_, all)| !all.is_empty());
        Self {
            rows,
            rest: rest.map(|(kind, all)| (kind, all.join("; "))).collect(),
        }
    }
}

/// Definitions and sources, as the template `student/definitions.html` takes them. They are not printed: a sheet of
/// paper has no room for them.
pub struct Definitions<'a> {
    /// Metrics.
    pub rows: Vec<Definition<'a>>,
    /// Thresholds in words.
    pub thresholds: Option<String>,
    /// Version of the program.
    pub version: &'static str,
    /// Hash of the sources of the measures.
    pub measures: &'static str,
}

/// Definition of one metric.
pub struct Definition<'a> {
    /// Metric.
    pub metric: &'a MetricGrade,
    /// Unit.
    pub unit: &'static str,
    /// Value of a full score.
    pub target: String,
    /// Value of no score.
    pub zero: String,
}

impl<'a> Definitions<'a> {
    /// Definitions of a grade's metrics.
    pub fn of(grade: &'a Grade) -> Self {
        let definition = |metric: &'a MetricGrade| Definition {
            metric,
            unit: match metric.unit {
                "" => "number",
                unit => unit,
            },
            target: bound(&metric.target),
            zero: bound(&metric.zero),
        };
        Self {
            rows: grade.metrics.iter().map(definition).collect(),
            thresholds: grade.thresholds.as_ref().map(|set| set.words()),
            version: env!("CARGO_PKG_VERSION"),
            measures: MEASURES_SOURCE,
        }
    }
}

/// A bound with the minus sign of typography.
fn bound(bound: &Bound) -> String {
    bound.to_string().replace('-', "−")
}
