//! Norms: the values of experts, against which students are shown.

use super::grade::Grade;
use crate::App;

/// Values of a metric in the recordings of experts.
#[derive(Clone, Debug, PartialEq)]
pub struct Norm {
    /// Name of the metric.
    pub metric: String,
    /// Smallest and largest value.
    pub band: [f64; 2],
    /// Number of sessions.
    pub sessions: usize,
}

impl Norm {
    /// The band in words.
    pub fn words(&self) -> String {
        let [least, most] = self.band;
        if least == most {
            format!("{least:.2}")
        } else {
            format!("{least:.2} to {most:.2}")
        }
    }
}

/// Norms of an exercise: bands of the metrics over all sessions that are norms. An exam is never one.
pub fn norms(app: &App, exercise: &str) -> Vec<Norm> {
    let grades = app.house.grades();
    let all = grades.all();
    let chosen = all
        .iter()
        .filter(|one| one.is_norm && one.exercise == exercise && !one.is_exam());
    let read: Vec<Grade> = chosen
        .filter_map(|one| grades.grade(&one.id))
        .map(|object| Grade::of(&object))
        .collect();
    bands(&read)
}

fn bands(read: &[Grade]) -> Vec<Norm> {
    let mut all: Vec<Norm> = Vec::new();
    for grade in read {
        for metric in &grade.metrics {
            let Some(value) = metric.value.filter(|value| value.is_finite()) else {
                continue;
            };
            match all.iter_mut().find(|norm| norm.metric == metric.name) {
                Some(norm) => {
                    norm.band = [norm.band[0].min(value), norm.band[1].max(value)];
                    norm.sessions += 1;
                }
                None => all.push(Norm {
                    metric: metric.name.clone(),
                    band: [value, value],
                    sessions: 1,
                }),
            }
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn a_norm_spans_the_values_of_the_experts() {
        let grade = |force: Option<f64>| {
            Grade::of(&json!({ "metrics": [{ "name": "force", "value": force }] }))
        };
        let found = bands(&[grade(Some(0.2)), grade(None), grade(Some(0.15))]);
        let expected = Norm {
            metric: "force".into(),
            band: [0.15, 0.2],
            sessions: 2,
        };
        assert_eq!(found, [expected]);
        assert_eq!(found[0].words(), "0.15 to 0.20");
        assert!(bands(&[]).is_empty());
    }
}
