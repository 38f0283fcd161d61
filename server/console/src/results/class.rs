//! A class: agreement with the truth, map of the sites, trend over attempts, points lost.

use std::collections::BTreeMap;

use askama::Template;
use axum::Extension;
use axum::extract::{Query, State};
use axum::http::StatusCode;
use axum::response::Response;

use super::access::Sight;
use super::book::{People, opened};
use super::filter::Filter;
use super::grade::{Grade, Zone};
use super::list::Choices;
use super::stats::{Agreement, agreement};
use super::trend::{Trend, level, trend};
use super::{audited, reading};
use crate::App;
use crate::guard::Caller;
use crate::house::{Grading, Recorded};
use crate::pages::html;

/// Sites of a tooth, in the order of a chart.
const SITES: [&str; 6] = [
    "distobuccal",
    "buccal",
    "mesiobuccal",
    "distolingual",
    "lingual",
    "mesiolingual",
];
/// Number of metrics in the table of lost points.
const MOST_LOSSES: usize = 8;

/// Learner of a class.
struct LearnerRow {
    learner: String,
    label: String,
    attempts: usize,
    first: Option<f64>,
    last: Option<f64>,
    agreement: Option<Agreement>,
}

/// Cell of the map of the sites.
#[derive(Clone, Debug, Default, PartialEq)]
struct Cell {
    readings: usize,
    /// Share within 1 mm, percent.
    within: f64,
    bias_mm: f64,
    /// Number of sessions that asked for the zone and missed it.
    missed: usize,
    /// Class of the colour: `h0`, few within 1 mm, to `h3`.
    shade: &'static str,
}

struct ToothRow {
    tooth: u8,
    cells: Vec<Option<Cell>>,
}

struct Loss {
    title: String,
    /// Mean of the points that the metric cost.
    points: f64,
}

#[derive(Template)]
#[template(path = "class_results.html")]
struct ClassPage<'a> {
    role: &'a str,
    id: &'a str,
    filter: &'a Filter,
    query: String,
    choices: Choices,
    sites: [&'static str; 6],
    data: ClassData,
}

/// Figures of a class.
#[derive(Default)]
struct ClassData {
    sessions: usize,
    agreement: Option<Agreement>,
    learners: Vec<LearnerRow>,
    teeth: Vec<ToothRow>,
    losses: Vec<Loss>,
    trend: Trend,
    levels: Vec<(f64, u8)>,
}

/// `GET /results/class`: the page of a class and an exercise.
pub async fn page(
    State(app): State<App>,
    Extension(caller): Extension<Caller>,
    Query(mut filter): Query<Filter>,
) -> Response {
    let book = match opened(&app, &caller).await {
        Ok(book) => book,
        Err(answer) => return answer,
    };
    let choices = Choices::of(&book);
    // Scores of different exercises have no common scale.
    if filter.exercise.is_empty()
        && let Some(first) = choices.exercises.first()
    {
        filter.exercise.clone_from(first);
    }
    audited(&app, &caller, "opens class results", &filter.query());
    let (reader, asked) = (app.clone(), filter.clone());
    let read = reading(move || {
        let all = book.filtered(&asked);
        let open = all.into_iter().filter(|seen| {
            seen.sight == Sight::Grade && seen.one.grading == Grading::Graded && !seen.one.is_exam()
        });
        let graded: Vec<(Recorded, Grade)> = open
            .filter_map(|seen| {
                let object = reader.house.grades().grade(&seen.one.id)?;
                Some((seen.one.clone(), Grade::of(&object)))
            })
            .collect();
        figures(&graded, &book.people)
    });
    let data = match read.await {
        Ok(data) => data,
        Err(answer) => return answer,
    };
    let page = ClassPage {
        role: caller.holder.role.name(),
        id: &caller.holder.id,
        query: filter.query(),
        filter: &filter,
        choices,
        sites: SITES,
        data,
    };
    html(StatusCode::OK, &page)
}

/// Pairs of prescribed and called depth.
fn pairs<'a>(zones: impl Iterator<Item = &'a Zone>) -> Vec<(f64, f64)> {
    zones
        .filter_map(|zone| Some((zone.truth_mm?, f64::from(zone.called_mm?))))
        .collect()
}

/// Figures of sessions with their grades, the newest first.
fn figures(graded: &[(Recorded, Grade)], people: &People) -> ClassData {
    let zones = || graded.iter().flat_map(|(_, grade)| &grade.sites);
    let mut by_learner: BTreeMap<&str, Vec<&(Recorded, Grade)>> = BTreeMap::new();
    for both in graded.iter().rev() {
        by_learner.entry(&both.0.learner).or_default().push(both);
    }
    let mut learners: Vec<LearnerRow> = by_learner
        .into_iter()
        .map(|(learner, all)| LearnerRow {
            learner: learner.to_owned(),
            label: people.label(learner),
            attempts: all.len(),
            first: all.first().and_then(|(one, _)| one.counts().0),
            last: all.last().and_then(|(one, _)| one.counts().0),
            agreement: agreement(&pairs(all.iter().flat_map(|(_, grade)| &grade.sites))),
        })
        .collect();
    // A teacher looks for those who need help.
    learners.sort_by(|a, b| {
        let score = |row: &LearnerRow| row.last.unwrap_or(f64::INFINITY);
        score(a).total_cmp(&score(b))
    });
    ClassData {
        sessions: graded.len(),
        agreement: agreement(&pairs(zones())),
        learners,
        teeth: map(zones()),
        losses: losses(graded),
        trend: trend(graded.iter().map(|(one, _)| one)),
        levels: [0u8, 50, 100]
            .map(|score| (level(f64::from(score)), score))
            .to_vec(),
    }
}

/// Map of the sites.
fn map<'a>(zones: impl Iterator<Item = &'a Zone>) -> Vec<ToothRow> {
    let mut by_tooth: BTreeMap<u8, [Vec<&Zone>; 6]> = BTreeMap::new();
    for zone in zones {
        if let Some(k) = SITES.iter().position(|site| *site == zone.site) {
            by_tooth.entry(zone.tooth).or_default()[k].push(zone);
        }
    }
    let cell = |zones: &Vec<&Zone>| {
        if zones.is_empty() {
            return None;
        }
        let missed = zones
            .iter()
            .filter(|zone| zone.asked && zone.called_mm.is_none())
            .count();
        let found = agreement(&pairs(zones.iter().copied())).unwrap_or_default();
        let shade = match found.within_1mm {
            _ if found.readings == 0 => "none",
            share if share >= 0.9 => "h3",
            share if share >= 0.75 => "h2",
            share if share >= 0.5 => "h1",
            _ => "h0",
        };
        Some(Cell {
            readings: found.readings,
            within: 100.0 * found.within_1mm,
            bias_mm: found.bias_mm,
            missed,
            shade,
        })
    };
    let row = |(tooth, sites): (u8, [Vec<&Zone>; 6])| ToothRow {
        tooth,
        cells: sites.iter().map(cell).collect(),
    };
    by_tooth.into_iter().map(row).collect()
}

/// Metrics that cost most points, the worst first.
fn losses(graded: &[(Recorded, Grade)]) -> Vec<Loss> {
    let mut by_title: BTreeMap<&str, (f64, usize)> = BTreeMap::new();
    for (_, grade) in graded {
        let weights = grade.weights();
        for metric in grade.metrics.iter().filter(|metric| metric.score.is_some()) {
            let sum = by_title.entry(&metric.title).or_default();
            *sum = (sum.0 + metric.lost(weights), sum.1 + 1);
        }
    }
    let mut all: Vec<Loss> = by_title
        .into_iter()
        .map(|(title, (sum, count))| Loss {
            title: title.to_owned(),
            points: sum / count as f64,
        })
        .filter(|loss| loss.points >= 0.05)
        .collect();
    all.sort_by(|a, b| b.points.total_cmp(&a.points));
    all.truncate(MOST_LOSSES);
    all
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    fn graded(learner: &str, score: f64, called: Option<u8>) -> (Recorded, Grade) {
        let one = Recorded {
            learner: learner.into(),
            score: Some(score),
            started: format!("2026-11-26 09:{score:02.0}"),
            ..Recorded::default()
        };
        let grade = json!({
            "metrics": [{ "name": "a", "title": "late", "weight": 1.0, "score": score },
                { "name": "b", "title": "fine", "weight": 1.0, "score": 100.0 }],
            "sites": [{ "tooth": 36, "site": "buccal", "asked": true, "truth_mm": 3.0, "called_mm": called }],
        });
        (one, Grade::of(&grade))
    }

    #[test]
    fn a_class_is_counted_by_learner_by_site_and_by_points() {
        // The newest first.
        let all = [
            graded("s-1", 80.0, Some(3)),
            graded("s-2", 60.0, Some(6)),
            graded("s-1", 40.0, None),
        ];
        let data = figures(&all, &People::default());
        assert_eq!(data.sessions, 3);
        let rows: Vec<(&str, usize, Option<f64>, Option<f64>)> = data
            .learners
            .iter()
            .map(|row| (row.learner.as_str(), row.attempts, row.first, row.last))
            .collect();
        assert_eq!(
            rows,
            [
                ("s-2", 1, Some(60.0), Some(60.0)),
                ("s-1", 2, Some(40.0), Some(80.0))
            ]
        );
        let cell = data.teeth[0].cells[1].clone().expect("a cell");
        assert_eq!(
            (data.teeth[0].tooth, cell.readings, cell.missed),
            (36, 2, 1)
        );
        assert_eq!((cell.within, cell.bias_mm, cell.shade), (50.0, 1.5, "h1"));
        assert_eq!(data.teeth[0].cells[0], None);
        // Of two equal weights: half of 20, 40 and 60 points.
        assert_eq!(data.losses.len(), 1);
        assert_eq!(
            (data.losses[0].title.as_str(), data.losses[0].points),
            ("late", 20.0)
        );
        assert_eq!(data.trend.attempts.len(), 2);
    }
}
