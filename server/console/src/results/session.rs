//! Page of a session: grade, evidence, scores of persons.

use askama::Template;
use axum::Extension;
use axum::extract::{Form, Path, Request, State};
use axum::http::{HeaderValue, StatusCode, header};
use axum::response::{IntoResponse, Redirect, Response};
use serde::Deserialize;
use sulcus_proto::Role;

use super::access::Sight;
use super::book::opened;
use super::filter::encoded;
use super::grade::{Grade, Metric, Moment, Zone};
use super::norms::{Norm, norms};
use super::{audited, reading};
use crate::App;
use crate::guard::Caller;
use crate::house::{Grading, Recorded, Revised};
use crate::pages::{download, html, problem};

/// Headers of a sheet: a page of the grading program with a style of its own, without scripts.
const SHEET: &str = "default-src 'none'; style-src 'unsafe-inline'; img-src data:; base-uri 'none'; form-action 'none'; frame-ancestors 'self'";
/// Headers of a page that shows a sheet in a frame.
pub(crate) const AROUND: &str = "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data:; connect-src 'self'; frame-src 'self'; form-action 'self'; base-uri 'none'; frame-ancestors 'none'";

/// Row of the table of metrics.
struct MetricRow {
    metric: Metric,
    lost: f64,
    /// Value of the experts, in words; empty without a norm.
    experts: String,
}

#[derive(Template)]
#[template(path = "result.html")]
struct ResultPage<'a> {
    role: &'a str,
    id: &'a str,
    is_teacher: bool,
    is_learner: bool,
    one: &'a Recorded,
    label: String,
    state: String,
    is_shown: bool,
    has_sheet: bool,
    grade: Grade,
    metrics: Vec<MetricRow>,
    moments: Vec<Moment>,
    zones: Vec<Zone>,
    final_score: Option<f64>,
    final_passed: Option<bool>,
    norms: usize,
}

/// Session of an address with the extent to which the caller may see it, and the label of its learner.
pub(super) async fn found(
    app: &App,
    caller: &Caller,
    id: &str,
) -> Result<(Recorded, Sight, String), Response> {
    let book = opened(app, caller).await?;
    let none = || problem(StatusCode::NOT_FOUND, "this sign-in has no such session");
    let seen = book.find(id).ok_or_else(none)?;
    let label = book.people.label(&seen.one.learner);
    Ok((seen.one.clone(), seen.sight, label))
}

fn is_teacher(caller: &Caller) -> bool {
    matches!(
        caller.holder.role,
        Role::Instructor | Role::Examiner | Role::Admin
    )
}

/// `GET /results/session/{session}`: the page of a session.
pub async fn page(
    State(app): State<App>,
    Extension(caller): Extension<Caller>,
    Path(id): Path<String>,
) -> Response {
    let (one, sight, label) = match found(&app, &caller, &id).await {
        Ok(found) => found,
        Err(answer) => return answer,
    };
    audited(&app, &caller, "opens result", &id);
    let is_shown = sight == Sight::Grade && one.grading == Grading::Graded;
    let (reader, exercise) = (app.clone(), one.exercise.clone());
    let read = reading(move || {
        let grades = reader.house.grades();
        let grade = grades.grade(&id).filter(|_| is_shown);
        let norms = if is_shown {
            norms(&reader, &exercise)
        } else {
            Vec::new()
        };
        (
            grade.map(|object| Grade::of(&object)).unwrap_or_default(),
            norms,
            is_shown && grades.sheet(&id).is_some(),
        )
    });
    let (grade, norms, has_sheet) = match read.await {
        Ok(read) => read,
        Err(answer) => return answer,
    };
    let (final_score, final_passed) = one.counts();
    let weights = grade.weights();
    let row = |metric: &Metric| MetricRow {
        lost: metric.lost(weights),
        experts: norms
            .iter()
            .find(|norm| norm.metric == metric.name)
            .map_or(String::new(), Norm::words),
        metric: metric.clone(),
    };
    let page = ResultPage {
        role: caller.holder.role.name(),
        id: &caller.holder.id,
        is_teacher: is_teacher(&caller),
        is_learner: caller.holder.role == Role::Student,
        label,
        state: state(&one, sight),
        is_shown,
        has_sheet,
        metrics: grade.metrics.iter().map(row).collect(),
        moments: grade.moments.clone(),
        zones: grade.sites.clone(),
        final_score,
        final_passed,
        norms: norms.first().map_or(0, |norm| norm.sessions),
        grade,
        one: &one,
    };
    with_policy(html(StatusCode::OK, &page), AROUND)
}

/// State of a session without a grade, one sentence; empty with one.
fn state(one: &Recorded, sight: Sight) -> String {
    match &one.grading {
        Grading::Waiting => "The session waits for its grade.".into(),
        Grading::Running => "The session is being replayed and graded.".into(),
        Grading::Ungradable(why) => format!("The session has no grade: {why}."),
        Grading::Failed(why) => format!("The grading program failed: {why}."),
        Grading::Graded if sight == Sight::Grade => String::new(),
        Grading::Graded if one.is_exam() => {
            "The result of this exam is sealed until an examiner releases it.".into()
        }
        Grading::Graded => "The grade is shown after the learner's own score.".into(),
    }
}

pub(crate) fn with_policy(mut answer: Response, policy: &'static str) -> Response {
    let name = header::CONTENT_SECURITY_POLICY;
    answer
        .headers_mut()
        .insert(name, HeaderValue::from_static(policy));
    answer
}

/// A page of the grading program, as a frame may show it.
pub(super) fn framed(answer: Response) -> Response {
    with_policy(answer, SHEET)
}

/// `GET /results/session/{session}/sheet`: the printable sheet.
pub async fn sheet(
    State(app): State<App>,
    Extension(caller): Extension<Caller>,
    Path(id): Path<String>,
) -> Response {
    let sight = match found(&app, &caller, &id).await {
        Ok((_, sight, _)) => sight,
        Err(answer) => return answer,
    };
    if sight != Sight::Grade {
        return problem(
            StatusCode::FORBIDDEN,
            "the grade of this session is not open",
        );
    }
    match reading(move || app.house.grades().sheet(&id)).await {
        Ok(Some(sheet)) => framed(axum::response::Html(sheet).into_response()),
        Ok(None) => problem(StatusCode::NOT_FOUND, "the session has no sheet"),
        Err(answer) => answer,
    }
}

/// `GET /results/session/{session}/recording`: the recording as a file.
pub async fn recording(
    State(app): State<App>,
    Extension(caller): Extension<Caller>,
    Path(id): Path<String>,
    request: Request,
) -> Response {
    let sight = match found(&app, &caller, &id).await {
        Ok((_, sight, _)) => sight,
        Err(answer) => return answer,
    };
    let file = app.house.grades().file(&id);
    let Some(file) = file.filter(|_| sight == Sight::Grade) else {
        return problem(StatusCode::FORBIDDEN, "this recording is not open");
    };
    audited(&app, &caller, "downloads recording", &id);
    download(&file, &format!("{}.mcap", encoded(&id)), request).await
}

/// Answer to a form: back to the page of the session, or the reason of the refusal.
fn back(id: &str, done: Result<(), String>) -> Response {
    match done {
        Ok(()) => Redirect::to(&format!("/results/session/{}", encoded(id))).into_response(),
        Err(why) => problem(StatusCode::BAD_REQUEST, &why),
    }
}

/// Form of a revision.
#[derive(Deserialize)]
pub struct Revision {
    score: String,
    passed: String,
    reason: String,
}

impl Revision {
    /// Revision of the form's texts.
    fn checked(&self, by: &str) -> Result<Revised, String> {
        let score = self.score.trim().replace(',', ".");
        let number: Option<f64> = score.parse().ok();
        let Some(score) = number.filter(|score| (0.0..=100.0).contains(score)) else {
            return Err(format!(
                "score is `{}`, expected a number from 0 to 100",
                self.score.escape_debug()
            ));
        };
        let passed = match self.passed.as_str() {
            "yes" => true,
            "no" => false,
            other => {
                return Err(format!(
                    "passed is `{}`, expected yes or no",
                    other.escape_debug()
                ));
            }
        };
        if self.reason.trim().is_empty() {
            return Err("reason is empty, expected one sentence".into());
        }
        Ok(Revised {
            score,
            passed,
            by: by.to_owned(),
            at: String::new(),
            reason: self.reason.trim().to_owned(),
        })
    }
}

/// Session that a teacher changes.
async fn changed(app: &App, caller: &Caller, id: &str) -> Result<Recorded, Response> {
    match found(app, caller, id).await? {
        (one, Sight::Grade, _) => Ok(one),
        _ => Err(problem(
            StatusCode::FORBIDDEN,
            "the result of this exam is sealed",
        )),
    }
}

/// `POST /results/session/{session}/revise`: a teacher's score in place of the proposal.
pub async fn revise(
    State(app): State<App>,
    Extension(caller): Extension<Caller>,
    Path(id): Path<String>,
    Form(form): Form<Revision>,
) -> Response {
    if let Err(answer) = changed(&app, &caller, &id).await {
        return answer;
    }
    let revised = form.checked(&caller.holder.id);
    audited(&app, &caller, "revises score", &id);
    let name = id.clone();
    let done = reading(move || revised.and_then(|said| app.house.grades().revise(&name, said)));
    match done.await {
        Ok(done) => back(&id, done),
        Err(answer) => answer,
    }
}

/// `POST /results/session/{session}/again`: another grading.
pub async fn again(
    State(app): State<App>,
    Extension(caller): Extension<Caller>,
    Path(id): Path<String>,
) -> Response {
    match changed(&app, &caller, &id).await {
        Ok(_) => {
            audited(&app, &caller, "grades again", &id);
            back(&id, app.house.grades().again(&id))
        }
        Err(answer) => answer,
    }
}

/// Form of a norm.
#[derive(Deserialize)]
pub struct NormForm {
    norm: String,
}

/// `POST /results/session/{session}/norm`: the session becomes a norm, or stops being one.
pub async fn norm(
    State(app): State<App>,
    Extension(caller): Extension<Caller>,
    Path(id): Path<String>,
    Form(form): Form<NormForm>,
) -> Response {
    let one = match changed(&app, &caller, &id).await {
        Ok(one) => one,
        Err(answer) => return answer,
    };
    if form.norm == "yes" && one.grading != Grading::Graded {
        return problem(StatusCode::BAD_REQUEST, "the session has no grade yet");
    }
    let is_norm = form.norm == "yes";
    let action = if is_norm { "makes norm" } else { "ends norm" };
    audited(&app, &caller, action, &id);
    let (name, by) = (id.clone(), caller.holder.id.clone());
    let done = reading(move || app.house.grades().set_norm(&name, is_norm, &by));
    match done.await {
        Ok(done) => back(&id, done),
        Err(answer) => answer,
    }
}

/// Form of the own score.
#[derive(Deserialize)]
pub struct OwnScore {
    score: String,
}

/// `POST /results/session/{session}/own-score`: the learner's own score, before the grade is shown.
pub async fn own_score(
    State(app): State<App>,
    Extension(caller): Extension<Caller>,
    Path(id): Path<String>,
    Form(form): Form<OwnScore>,
) -> Response {
    let one = match found(&app, &caller, &id).await {
        Ok((one, ..)) => one,
        Err(answer) => return answer,
    };
    if !one.waits_for_own_score() {
        return problem(
            StatusCode::BAD_REQUEST,
            "the session waits for no own score",
        );
    }
    let score: Option<f64> = form.score.trim().replace(',', ".").parse().ok();
    let Some(score) = score.filter(|score| (0.0..=100.0).contains(score)) else {
        let why = format!(
            "score is `{}`, expected a number from 0 to 100",
            form.score.escape_debug()
        );
        return problem(StatusCode::BAD_REQUEST, &why);
    };
    let name = id.clone();
    match reading(move || app.house.grades().assess(&name, score)).await {
        Ok(done) => back(&id, done),
        Err(answer) => answer,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_revision_needs_a_score_a_decision_and_a_reason() {
        let form = |score: &str, passed: &str, reason: &str| Revision {
            score: score.into(),
            passed: passed.into(),
            reason: reason.into(),
        };
        let said = form(" 72,5 ", "yes", " finger rest slipped ").checked("t04");
        let said = said.expect("a revision");
        assert_eq!((said.score, said.passed), (72.5, true));
        assert_eq!(
            (said.by.as_str(), said.reason.as_str()),
            ("t04", "finger rest slipped")
        );
        for (form, words) in [
            (form("101", "yes", "x"), "score is `101`"),
            (form("NaN", "yes", "x"), "score is `NaN`"),
            (form("", "yes", "x"), "expected a number from 0 to 100"),
            (form("70", "maybe", "x"), "passed is `maybe`"),
            (form("70", "no", "  "), "reason is empty"),
        ] {
            let told = form.checked("t04").expect_err("refused");
            assert!(told.contains(words), "{told}");
        }
    }
}
