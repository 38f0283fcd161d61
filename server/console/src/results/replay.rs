//! A moment of a session in three dimensions: the replay of some seconds about it, in the viewer.

use askama::Template;
use axum::Extension;
use axum::extract::{Path, Query, State};
use axum::http::{StatusCode, header};
use axum::response::{IntoResponse, Response};
use serde::Deserialize;

use super::access::Sight;
use super::session::{AROUND, found, with_policy};
use super::{audited, reading};
use crate::App;
use crate::guard::{Caller, refused};
use crate::pages::html;
use crate::routes::Form::Data;
use crate::view::capabilities::{Right, Shows};

/// Longest time in a session, seconds.
const LONGEST_S: f64 = 86_400.0;

/// Moment of an address.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
pub struct Moment {
    /// Time in the session, seconds; 0 without a time.
    at: String,
}

impl Moment {
    /// Time in milliseconds.
    fn at_ms(&self) -> Result<u64, String> {
        let text = if self.at.is_empty() { "0" } else { &self.at };
        let seconds: Option<f64> = text.parse().ok();
        match seconds.filter(|seconds| (0.0..=LONGEST_S).contains(seconds)) {
            Some(seconds) => Ok((seconds * 1e3).round() as u64),
            None => Err(format!(
                "at is `{}`, expected seconds from 0 to 86400",
                text.escape_debug()
            )),
        }
    }
}

#[derive(Template)]
#[template(path = "replay.html")]
struct ReplayPage<'a> {
    role: &'a str,
    id: &'a str,
    session: &'a str,
    title: String,
    at: String,
}

/// `GET /results/session/{session}/replay`: page with the viewer.
pub async fn page(
    State(app): State<App>,
    Extension(caller): Extension<Caller>,
    Path(session): Path<String>,
    Query(moment): Query<Moment>,
) -> Response {
    let one = match found(&app, &caller, &session).await {
        Ok((one, ..)) => one,
        Err(answer) => return answer,
    };
    let at_ms = match moment.at_ms() {
        Ok(at_ms) => at_ms,
        Err(why) => return crate::pages::problem(StatusCode::BAD_REQUEST, &why),
    };
    let page = ReplayPage {
        role: caller.holder.role.name(),
        id: &caller.holder.id,
        title: format!("{}, {}", one.exercise, one.started),
        at: (at_ms as f64 * 1e-3).to_string(),
        session: &session,
    };
    with_policy(html(StatusCode::OK, &page), AROUND)
}

/// `POST /api/results/{session}/replay`: a path that opens the replay once, within a minute.
pub async fn open(
    State(app): State<App>,
    Extension(caller): Extension<Caller>,
    Path(session): Path<String>,
    Query(moment): Query<Moment>,
) -> Response {
    match found(&app, &caller, &session).await {
        Ok((_, Sight::Grade, _)) => {}
        Ok(_) => return refused(Data, StatusCode::FORBIDDEN, "this session is sealed"),
        Err(_) => {
            let why = "this sign-in has no such session";
            return refused(Data, StatusCode::NOT_FOUND, why);
        }
    }
    match moment.at_ms() {
        Ok(at_ms) => {
            audited(&app, &caller, "opens replay", &session);
            let shows = Shows::Replay { session, at_ms };
            crate::view::stream::given(&app, Right { shows, caller })
        }
        Err(why) => refused(Data, StatusCode::BAD_REQUEST, &why),
    }
}

/// Replay of a right that was taken. One replay is drawn at a time.
pub(crate) async fn stream(app: &App, caller: &Caller, session: String, at_ms: u64) -> Response {
    // The session may have been sealed since.
    let seen = found(app, caller, &session).await;
    if !matches!(seen, Ok((_, Sight::Grade, _))) {
        return refused(
            Data,
            StatusCode::NOT_FOUND,
            "this sign-in has no such session",
        );
    }
    let Ok(_turn) = app.replays.acquire().await else {
        return refused(
            Data,
            StatusCode::SERVICE_UNAVAILABLE,
            "the server is ending",
        );
    };
    let house = app.house.clone();
    match reading(move || house.grades().replay(&session, at_ms)).await {
        Ok(Ok(bytes)) => {
            let headers = [
                (header::CONTENT_TYPE, "application/vnd.rerun.rrd"),
                (header::CACHE_CONTROL, "no-store"),
            ];
            (headers, bytes).into_response()
        }
        Ok(Err(why)) => refused(Data, StatusCode::CONFLICT, &why),
        Err(answer) => answer,
    }
}
