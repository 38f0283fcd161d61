//! Two sessions with the same patient, side by side: two examiners chart one mouth.

use std::collections::BTreeMap;

use askama::Template;
use axum::Extension;
use axum::extract::{Query, State};
use axum::http::StatusCode;
use axum::response::Response;
use serde::Deserialize;

use super::access::Sight;
use super::book::{Seen, opened};
use super::grade::Grade;
use super::list::Row;
use super::reading;
use super::stats::{Agreement, agreement};
use crate::App;
use crate::guard::Caller;
use crate::house::Grading;
use crate::pages::{html, problem};

/// Largest number of sessions to choose from.
const MOST: usize = 100;

/// Sessions of a comparison.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
pub struct Asked {
    /// Id of the first session; empty: none yet.
    first: String,
    /// Id of the second session.
    second: String,
}

/// Zone that both charted.
#[derive(Clone, Debug, PartialEq)]
struct Line {
    tooth: u8,
    site: String,
    first: Option<u8>,
    second: Option<u8>,
    truth: Option<f64>,
}

impl Line {
    /// Whether the two are more than 1 mm apart.
    fn is_apart(&self) -> bool {
        let both = self.first.zip(self.second);
        both.is_some_and(|(first, second)| first.abs_diff(second) > 1)
    }
}

#[derive(Template)]
#[template(path = "compare.html")]
struct ComparePage<'a> {
    role: &'a str,
    id: &'a str,
    asked: &'a Asked,
    rows: Vec<Row>,
    first: Option<Row>,
    second: Option<Row>,
    lines: Vec<Line>,
    each_other: Option<Agreement>,
    first_truth: Option<Agreement>,
    second_truth: Option<Agreement>,
}

/// `GET /results/compare`: the comparison, or the choice of its sessions.
pub async fn page(
    State(app): State<App>,
    Extension(caller): Extension<Caller>,
    Query(asked): Query<Asked>,
) -> Response {
    let book = match opened(&app, &caller).await {
        Ok(book) => book,
        Err(answer) => return answer,
    };
    let (all, people) = (&book.sessions, &book.people);
    let open = |seen: &&Seen| seen.sight == Sight::Grade && seen.one.grading == Grading::Graded;
    let find = |id: &str| all.iter().filter(open).find(|seen| seen.one.id == id);
    let (first, second) = (find(&asked.first), find(&asked.second));
    for (id, found) in [(&asked.first, first), (&asked.second, second)] {
        if !id.is_empty() && found.is_none() {
            return problem(StatusCode::NOT_FOUND, "this sign-in has no such session");
        }
    }
    if let (Some(first), Some(second)) = (first, second)
        && first.one.scene != second.one.scene
    {
        return problem(
            StatusCode::BAD_REQUEST,
            "the two sessions have different patients, expected the same patient",
        );
    }
    let ids = first
        .zip(second)
        .map(|(a, b)| [a.one.id.clone(), b.one.id.clone()]);
    let reader = app.clone();
    let read = reading(move || {
        let grades = ids.map(|ids| {
            ids.map(|id| {
                let object = reader.house.grades().grade(&id);
                object.map(|object| Grade::of(&object)).unwrap_or_default()
            })
        });
        grades.map(|[first, second]| lines(&first, &second))
    });
    let lines = match read.await {
        Ok(lines) => lines.unwrap_or_default(),
        Err(answer) => return answer,
    };
    let number = |depth: Option<u8>| depth.map(f64::from);
    let pairs = |of: &dyn Fn(&Line) -> Option<(f64, f64)>| -> Vec<(f64, f64)> {
        lines.iter().filter_map(of).collect()
    };
    // Of the second session only those with the same patient as the first can be chosen.
    let choices = all.iter().filter(open).filter(|seen| {
        first.is_none_or(|first| first.one.scene == seen.one.scene && first.one.id != seen.one.id)
    });
    let page = ComparePage {
        role: caller.holder.role.name(),
        id: &caller.holder.id,
        asked: &asked,
        rows: choices
            .take(MOST)
            .map(|seen| Row::of(seen, people))
            .collect(),
        first: first.map(|seen| Row::of(seen, people)),
        second: second.map(|seen| Row::of(seen, people)),
        each_other: agreement(&pairs(&|line| number(line.first).zip(number(line.second)))),
        first_truth: agreement(&pairs(&|line| line.truth.zip(number(line.first)))),
        second_truth: agreement(&pairs(&|line| line.truth.zip(number(line.second)))),
        lines,
    };
    html(StatusCode::OK, &page)
}

/// Zones that one of the two called, by tooth and site.
fn lines(first: &Grade, second: &Grade) -> Vec<Line> {
    let mut all: BTreeMap<(u8, &str), Line> = BTreeMap::new();
    for (k, grade) in [first, second].into_iter().enumerate() {
        for zone in grade.sites.iter().filter(|zone| zone.called_mm.is_some()) {
            let line = all.entry((zone.tooth, &zone.site)).or_insert_with(|| Line {
                tooth: zone.tooth,
                site: zone.site.clone(),
                first: None,
                second: None,
                truth: None,
            });
            line.truth = line.truth.or(zone.truth_mm);
            *(if k == 0 {
                &mut line.first
            } else {
                &mut line.second
            }) = zone.called_mm;
        }
    }
    all.into_values().collect()
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn zones_of_two_examiners_stand_side_by_side() {
        let zone = |tooth: u8, site: &str, called: Option<u8>| json!({ "tooth": tooth, "site": site, "called_mm": called, "truth_mm": 3.5 });
        let grade = |zones: Vec<serde_json::Value>| Grade::of(&json!({ "sites": zones }));
        let first = grade(vec![zone(36, "buccal", Some(3)), zone(36, "lingual", None)]);
        let second = grade(vec![
            zone(36, "buccal", Some(5)),
            zone(37, "buccal", Some(2)),
        ]);
        let found = lines(&first, &second);
        let told: Vec<(u8, Option<u8>, Option<u8>, bool)> = found
            .iter()
            .map(|line| (line.tooth, line.first, line.second, line.is_apart()))
            .collect();
        assert_eq!(
            told,
            [(36, Some(3), Some(5), true), (37, None, Some(2), false)]
        );
    }
}
