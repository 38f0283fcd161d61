//! Pages: HTML around the scripts.

use askama::Template;
use axum::Extension;
use axum::body::Body;
use axum::extract::{Path, Request, State};
use axum::http::header::{CONTENT_DISPOSITION, CONTENT_SECURITY_POLICY};
use axum::http::{HeaderValue, StatusCode};
use axum::response::{Html, IntoResponse, Response};
use tower_http::services::ServeFile;

use crate::App;
use crate::guard::{Caller, no_station};
use crate::house::Room;
use crate::routes::Form;

#[derive(Template)]
#[template(path = "stations.html")]
struct StationsPage<'a> {
    role: &'a str,
    id: &'a str,
    room: &'a str,
}

#[derive(Template)]
#[template(path = "station.html")]
struct StationPage<'a> {
    station: &'a str,
    role: &'a str,
    id: &'a str,
}

#[derive(Template)]
#[template(path = "sign_in.html")]
struct SignInPage<'a> {
    why: &'a str,
}

#[derive(Template)]
#[template(path = "first.html")]
struct FirstPage<'a> {
    why: &'a str,
}

#[derive(Template)]
#[template(path = "password.html")]
struct PasswordPage<'a> {
    role: &'a str,
    id: &'a str,
    why: &'a str,
}

#[derive(Template)]
#[template(path = "problem.html")]
struct ProblemPage<'a> {
    status: u16,
    why: &'a str,
}

/// Answer with a page.
pub(crate) fn html(status: StatusCode, page: &impl Template) -> Response {
    match page.render() {
        Ok(text) => (status, Html(text)).into_response(),
        Err(error) => {
            tracing::error!("a page cannot be written: {error}");
            StatusCode::INTERNAL_SERVER_ERROR.into_response()
        }
    }
}

/// `GET /`: all stations.
pub async fn stations(State(app): State<App>, Extension(caller): Extension<Caller>) -> Response {
    let room = app.house.room().map_or(String::new(), Room::sentence);
    let page = StationsPage {
        role: caller.holder.role.name(),
        id: &caller.holder.id,
        room: &room,
    };
    html(StatusCode::OK, &page)
}

/// `GET /stations/{station}`: one station.
pub async fn station(
    State(app): State<App>,
    Extension(caller): Extension<Caller>,
    Path(station): Path<String>,
) -> Response {
    if let Some(refusal) = no_station(&app, &caller, &station, Form::Page) {
        return refusal;
    }
    let page = StationPage {
        station: &station,
        role: caller.holder.role.name(),
        id: &caller.holder.id,
    };
    // The frame of the live view, and nothing else beyond the other pages.
    let policy = format!("{}; frame-src 'self'", crate::routes::POLICY);
    (
        [(CONTENT_SECURITY_POLICY, policy)],
        html(StatusCode::OK, &page),
    )
        .into_response()
}

/// Page with the form of the sign-in. `why`: reason of a refusal, or empty.
pub fn sign_in(status: StatusCode, why: &str) -> Response {
    html(status, &SignInPage { why })
}

/// Page with the form of the first administrator. `why`: reason of a refusal, or empty.
pub fn first(status: StatusCode, why: &str) -> Response {
    html(status, &FirstPage { why })
}

/// Page with the form of a change of the password. `why`: reason of a refusal, or empty.
pub fn password(status: StatusCode, caller: &Caller, why: &str) -> Response {
    let page = PasswordPage {
        role: caller.holder.role.name(),
        id: &caller.holder.id,
        why,
    };
    html(status, &page)
}

/// Page about a request that is refused.
pub fn problem(status: StatusCode, why: &str) -> Response {
    let page = ProblemPage {
        status: status.as_u16(),
        why,
    };
    html(status, &page)
}

/// Answer with a file for download under a name. Parts of the file are served, too.
pub(crate) async fn download(file: &std::path::Path, name: &str, request: Request) -> Response {
    let mut answer = match ServeFile::new(file).try_call(request).await {
        Ok(answer) => answer.map(Body::new).into_response(),
        Err(error) => {
            tracing::error!("console: {name} cannot be read: {error}");
            return problem(StatusCode::INTERNAL_SERVER_ERROR, "the file cannot be read");
        }
    };
    let disposition = format!("attachment; filename=\"{name}\"");
    if let Ok(disposition) = HeaderValue::from_str(&disposition) {
        let headers = answer.headers_mut();
        headers.insert(CONTENT_DISPOSITION, disposition);
    }
    answer
}

/// Answer to a path that is no route.
pub async fn unknown() -> Response {
    problem(StatusCode::NOT_FOUND, "this console has no such page")
}
