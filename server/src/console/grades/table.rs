//! Table of sessions for a spreadsheet.

use std::collections::BTreeSet;

use serde_json::Value;
use sulcus_console::house::Recorded;
use sulcus_sessions::export::cells;

/// Columns before those of the metrics.
const COLUMNS: [&str; 17] = [
    "session",
    "learner_id",
    "name",
    "station",
    "exercise",
    "mode",
    "started_utc",
    "seconds",
    "score",
    "passed",
    "self_score",
    "revised_score",
    "revised_passed",
    "revised_by",
    "revised_reason",
    "final_score",
    "final_passed",
];

/// CSV of sessions with their grades, a row for each. Text that a spreadsheet would change begins with an apostrophe.
///
/// # Errors
/// A row that cannot be written.
pub(super) fn table(
    rows: &[(Recorded, Option<Value>)],
    name: &dyn Fn(&str) -> String,
) -> Result<String, csv::Error> {
    let metrics: BTreeSet<String> = rows
        .iter()
        .flat_map(|(_, grade)| values(grade.as_ref()))
        .map(|(metric, _)| metric)
        .collect();
    let mut out = csv::Writer::from_writer(Vec::new());
    let header = COLUMNS.map(str::to_owned).into_iter();
    out.write_record(header.chain(metrics.iter().cloned()))?;
    let number = |x: Option<f64>| x.map_or(String::new(), |x| x.to_string());
    let truth = |x: Option<bool>| x.map_or(String::new(), |x| x.to_string());
    for (one, grade) in rows {
        let said = one.revised.last();
        let (score, passed) = one.counts();
        let text = |text: &str| cells::text(text).into_owned();
        let mut row = vec![
            text(&one.id),
            text(&one.learner),
            text(&name(&one.learner)),
            text(&one.station),
            text(&one.exercise),
            text(&one.mode),
            one.started.clone(),
            number(one.seconds),
            number(one.score),
            truth(one.passed),
            number(one.own_score),
            number(said.map(|said| said.score)),
            truth(said.map(|said| said.passed)),
            said.map_or(String::new(), |said| text(&said.by)),
            said.map_or(String::new(), |said| text(&said.reason)),
            number(score),
            truth(passed),
        ];
        let own = values(grade.as_ref());
        row.extend(metrics.iter().map(|metric| {
            let value = own.iter().find(|(name, _)| name == metric);
            value.map_or(String::new(), |(_, value)| value.to_string())
        }));
        out.write_record(&row)?;
    }
    let bytes = out
        .into_inner()
        .map_err(|error| csv::Error::from(error.into_error()))?;
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}

/// Names and values of the metrics of a grade.
fn values(grade: Option<&Value>) -> Vec<(String, f64)> {
    let metrics = grade.and_then(|grade| grade["metrics"].as_array());
    let all = metrics.into_iter().flatten();
    all.filter_map(|metric| {
        Some((
            metric["name"].as_str()?.to_owned(),
            metric["value"].as_f64()?,
        ))
    })
    .collect()
}

#[cfg(test)]
mod tests {
    use serde_json::json;
    use sulcus_console::house::Revised;

    use super::*;

    #[test]
    fn a_row_has_the_proposal_the_revision_and_the_metrics() {
        let one = Recorded {
            id: "20261126T090000Z-probing".into(),
            learner: "007".into(),
            score: Some(61.5),
            passed: Some(false),
            revised: vec![Revised {
                score: 72.0,
                passed: true,
                by: "t04".into(),
                reason: "=cmd".into(),
                ..Revised::default()
            }],
            ..Recorded::default()
        };
        let grade = json!({ "metrics": [{ "name": "misread", "value": 12.5 }, { "name": "none", "value": null }] });
        let rows = [(one, Some(grade)), (Recorded::default(), None)];
        let name = |learner: &str| match learner {
            "007" => "Ada, Lovelace".to_owned(),
            _ => String::new(),
        };
        let text = table(&rows, &name).expect("a table");
        let mut read = csv::Reader::from_reader(text.as_bytes());
        let heads: Vec<String> = read
            .headers()
            .expect("heads")
            .iter()
            .map(String::from)
            .collect();
        assert_eq!(heads.last().map(String::as_str), Some("misread"));
        let rows: Vec<csv::StringRecord> = read.records().map(|row| row.expect("a row")).collect();
        let cell = |row: usize, head: &str| {
            let k = heads.iter().position(|one| one == head).expect("a column");
            rows[row].get(k).expect("a cell").to_owned()
        };
        assert_eq!(cell(0, "learner_id"), "'007");
        assert_eq!(cell(0, "name"), "Ada, Lovelace");
        assert_eq!(cell(0, "revised_reason"), "'=cmd");
        assert_eq!(
            (cell(0, "score"), cell(0, "final_score")),
            ("61.5".into(), "72".into())
        );
        assert_eq!(
            (cell(0, "misread"), cell(1, "misread")),
            ("12.5".into(), String::new())
        );
    }
}
