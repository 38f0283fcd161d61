//! All sessions, filtered: the list, the table for spreadsheets, the sheets for a printer.

use askama::Template;
use axum::Extension;
use axum::extract::{Query, State};
use axum::http::{StatusCode, header};
use axum::response::{IntoResponse, Response};

use super::access::Sight;
use super::book::{Book, People, Seen, opened};
use super::filter::Filter;
use super::{audited, reading};
use crate::App;
use crate::guard::Caller;
use crate::house::{Grading, Recorded};
use crate::pages::{html, problem};

/// Largest number of rows of the list. The filter finds older sessions.
const MOST: usize = 200;
/// Largest number of sheets that are printed at once.
const MOST_SHEETS: usize = 100;

/// Row of the list.
pub struct Row {
    /// Id of the session.
    pub id: String,
    /// Beginning.
    pub started: String,
    /// Id of the learner, for links.
    pub learner: String,
    /// Name and id of the learner.
    pub label: String,
    /// Station.
    pub station: String,
    /// Exercise.
    pub exercise: String,
    /// Mode.
    pub mode: String,
    /// Minutes and seconds; empty before the grade.
    pub length: String,
    /// Final score; empty without one.
    pub score: String,
    /// State in words: `passed`, `grading`, the reason against a grade.
    pub state: String,
    /// Class of the state for its colour: `good`, `bad` or empty.
    pub tone: &'static str,
    /// Whether the session is a norm.
    pub is_norm: bool,
}

impl Row {
    /// Row of a session.
    pub fn of(seen: &Seen, people: &People) -> Self {
        let one = &seen.one;
        let (score, state, tone) = told(one, seen.sight);
        let length = one.seconds.map_or(String::new(), |seconds| {
            let whole = seconds as u64;
            format!("{}:{:02}", whole / 60, whole % 60)
        });
        Self {
            id: one.id.clone(),
            started: one.started.clone(),
            learner: one.learner.clone(),
            label: people.label(&one.learner),
            station: one.station.clone(),
            exercise: one.exercise.clone(),
            mode: one.mode.clone(),
            length,
            score,
            state,
            tone,
            is_norm: one.is_norm,
        }
    }
}

/// Score, state in words, and class of the colour.
fn told(one: &Recorded, sight: Sight) -> (String, String, &'static str) {
    let nothing = String::new;
    match &one.grading {
        Grading::Waiting => return (nothing(), "waits for its grade".into(), ""),
        Grading::Running => return (nothing(), "is being graded".into(), ""),
        Grading::Ungradable(why) => return (nothing(), format!("no grade: {why}"), "bad"),
        Grading::Failed(why) => return (nothing(), format!("grading failed: {why}"), "bad"),
        Grading::Graded => {}
    }
    if sight == Sight::Entry {
        let why = if one.is_exam() {
            "sealed"
        } else {
            "own score first"
        };
        return (nothing(), why.into(), "");
    }
    let (score, passed) = one.counts();
    let score = score.map_or(String::new(), |score| format!("{score:.1}"));
    let revised = if one.revised.is_empty() {
        ""
    } else {
        ", revised"
    };
    match passed {
        Some(true) => (score, format!("passed{revised}"), "good"),
        Some(false) => (score, format!("not passed{revised}"), "bad"),
        None => (score, format!("not decided{revised}"), ""),
    }
}

/// Choices of a filter.
#[derive(Default)]
pub struct Choices {
    /// Names of the classes.
    pub classes: Vec<String>,
    /// Exercises of all sessions.
    pub exercises: Vec<String>,
}

impl Choices {
    /// Choices of a book.
    pub fn of(book: &Book) -> Self {
        Self {
            classes: book.people.classes(),
            exercises: book.exercises(),
        }
    }
}

#[derive(Template)]
#[template(path = "results.html")]
struct ResultsPage<'a> {
    role: &'a str,
    id: &'a str,
    filter: &'a Filter,
    query: String,
    choices: Choices,
    rows: Vec<Row>,
    more: usize,
}

/// `GET /results`: the list.
pub async fn page(
    State(app): State<App>,
    Extension(caller): Extension<Caller>,
    Query(filter): Query<Filter>,
) -> Response {
    let book = match opened(&app, &caller).await {
        Ok(book) => book,
        Err(answer) => return answer,
    };
    let all = book.filtered(&filter);
    let page = ResultsPage {
        role: caller.holder.role.name(),
        id: &caller.holder.id,
        query: filter.query(),
        choices: Choices::of(&book),
        rows: all
            .iter()
            .take(MOST)
            .map(|seen| Row::of(seen, &book.people))
            .collect(),
        more: all.len().saturating_sub(MOST),
        filter: &filter,
    };
    html(StatusCode::OK, &page)
}

/// `GET /results/table.csv`: the table for spreadsheets.
pub async fn table(
    State(app): State<App>,
    Extension(caller): Extension<Caller>,
    Query(filter): Query<Filter>,
) -> Response {
    let book = match opened(&app, &caller).await {
        Ok(book) => book,
        Err(answer) => return answer,
    };
    audited(&app, &caller, "reads table of results", &filter.query());
    let made = reading(move || {
        let all = book.filtered(&filter);
        let graded = all.iter().filter(|seen| seen.sight == Sight::Grade);
        let rows: Vec<Recorded> = graded.map(|seen| seen.one.clone()).collect();
        let name = |learner: &str| book.people.name(learner).to_owned();
        app.house.grades().table(&rows, &name)
    });
    match made.await {
        Ok(Ok(text)) => {
            let headers = [
                (header::CONTENT_TYPE, "text/csv; charset=utf-8"),
                (
                    header::CONTENT_DISPOSITION,
                    "attachment; filename=\"results.csv\"",
                ),
            ];
            (headers, text).into_response()
        }
        Ok(Err(why)) => problem(StatusCode::INTERNAL_SERVER_ERROR, &why),
        Err(answer) => answer,
    }
}

/// Sheet of a printed class.
struct Sheet {
    label: String,
    body: String,
}

#[derive(Template)]
#[template(path = "print.html")]
struct PrintPage {
    style: String,
    sheets: Vec<Sheet>,
    left_out: usize,
}

/// `GET /results/print`: the sheets of all sessions of the filter on pages of their own.
pub async fn print(
    State(app): State<App>,
    Extension(caller): Extension<Caller>,
    Query(filter): Query<Filter>,
) -> Response {
    let book = match opened(&app, &caller).await {
        Ok(book) => book,
        Err(answer) => return answer,
    };
    audited(&app, &caller, "prints results", &filter.query());
    let made = reading(move || {
        let all = book.filtered(&filter);
        let (mut style, mut sheets, mut left_out) = (String::new(), Vec::new(), 0);
        for seen in all.iter().filter(|seen| seen.sight == Sight::Grade) {
            let sheet = app.house.grades().sheet(&seen.one.id);
            let parts = sheet.as_deref().and_then(parts);
            match parts {
                Some((css, body)) if sheets.len() < MOST_SHEETS => {
                    style = css.to_owned();
                    sheets.push(Sheet {
                        label: book.people.label(&seen.one.learner),
                        body: body.to_owned(),
                    });
                }
                _ => left_out += 1,
            }
        }
        PrintPage {
            style,
            sheets,
            left_out,
        }
    });
    match made.await {
        Ok(page) => super::session::framed(html(StatusCode::OK, &page)),
        Err(answer) => answer,
    }
}

/// Style and body of a sheet; the sheets of one program have the same style.
fn parts(sheet: &str) -> Option<(&str, &str)> {
    let between = |from: &str, to: &str| {
        let rest = &sheet[sheet.find(from)? + from.len()..];
        Some(&rest[..rest.find(to)?])
    };
    Some((
        between("<style>", "</style>")?,
        between("<body>", "</body>")?,
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sheet_is_taken_apart_and_a_foreign_page_is_not() {
        let sheet = "<html><head><style>p{}</style></head><body><main>1</main></body></html>";
        assert_eq!(parts(sheet), Some(("p{}", "<main>1</main>")));
        assert_eq!(parts("<body>1</body>"), None);
        assert_eq!(parts("</style><style><body>"), None);
    }

    #[test]
    fn a_sealed_session_tells_no_score() {
        let one = Recorded {
            mode: "exam".into(),
            score: Some(61.0),
            passed: Some(false),
            grading: Grading::Graded,
            ..Recorded::default()
        };
        assert_eq!(
            told(&one, Sight::Entry),
            (String::new(), "sealed".into(), "")
        );
        let (score, state, tone) = told(&one, Sight::Grade);
        assert_eq!(
            (score.as_str(), state.as_str(), tone),
            ("61.0", "not passed", "bad")
        );
    }
}
