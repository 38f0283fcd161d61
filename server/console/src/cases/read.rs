//! Data of the cases: list, form, compilations, pictures.

use axum::extract::{Path, State};
use axum::http::header;
use axum::response::{IntoResponse, Response};
use axum::{Extension, Json};
use serde_json::{Value, json};

use super::summary::Summary;
use super::{beside, refusal};
use crate::App;
use crate::guard::Caller;
use crate::house::cases::Case;

/// A case of the list, with its counts instead of its chart.
fn listed(case: &Case) -> Value {
    json!({
        "name": case.name, "state": case.state, "words": case.words, "fault": case.fault,
        "compiled": case.compiled, "warnings": case.warnings, "users": case.users,
        "label": case.chart.as_ref().map(|chart| &chart.label),
        "summary": case.chart.as_ref().map(Summary::of),
    })
}

/// Stations that a person may give a plan to.
fn stations(app: &App, caller: &Caller) -> Vec<String> {
    let all = app.house.stations().into_iter();
    all.map(|station| station.name.to_string())
        .filter(|name| caller.holder.includes(name))
        .collect()
}

/// `GET /api/cases`: all cases, with the choices of the page.
pub(super) async fn list(State(app): State<App>, Extension(caller): Extension<Caller>) -> Response {
    let all = beside(&app, |cases| Ok((cases.list()?, cases.model()))).await;
    match all {
        Ok((all, model)) => {
            let all: Vec<Value> = all.iter().map(listed).collect();
            Json(json!({
                "cases": all, "conditions": model.conditions, "exercises": model.exercises,
                "stations": stations(&app, &caller), "work": app.house.cases().work(),
            }))
            .into_response()
        }
        Err(why) => refusal(&why),
    }
}

/// `GET /api/cases-work`: compilations.
pub(super) async fn work(State(app): State<App>) -> Response {
    Json(app.house.cases().work()).into_response()
}

/// `GET /api/cases/{case}`: a case for the form.
pub(super) async fn load(
    State(app): State<App>,
    Extension(caller): Extension<Caller>,
    Path(case): Path<String>,
) -> Response {
    let loaded = beside(&app, move |cases| Ok((cases.load(&case)?, cases.model()))).await;
    match loaded {
        Ok((loaded, model)) => Json(json!({
            "case": loaded, "model": model, "stations": stations(&app, &caller),
            "work": app.house.cases().work(),
        }))
        .into_response(),
        Err(why) => refusal(&why),
    }
}

/// `GET /api/cases/{case}/picture/{side}`: the compiled mouth from a side.
pub(super) async fn picture(
    State(app): State<App>,
    Path((case, side)): Path<(String, String)>,
) -> Response {
    match beside(&app, move |cases| cases.picture(&case, &side)).await {
        Ok(png) => ([(header::CONTENT_TYPE, "image/png")], png).into_response(),
        Err(why) => refusal(&why),
    }
}
