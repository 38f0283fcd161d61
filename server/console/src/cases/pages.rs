//! Pages of the cases.

use askama::Template;
use axum::Extension;
use axum::extract::{Path, State};
use axum::http::StatusCode;
use axum::response::Response;

use super::beside;
use crate::App;
use crate::guard::Caller;
use crate::house::cases::Refused;
use crate::pages::{html, problem};

#[derive(Template)]
#[template(path = "cases.html")]
struct CasesPage<'a> {
    role: &'a str,
    id: &'a str,
}

#[derive(Template)]
#[template(path = "case.html")]
struct CasePage<'a> {
    case: &'a str,
    role: &'a str,
    id: &'a str,
}

/// `GET /cases`: all cases.
pub(super) async fn list(Extension(caller): Extension<Caller>) -> Response {
    let page = CasesPage {
        role: caller.holder.role.name(),
        id: &caller.holder.id,
    };
    html(StatusCode::OK, &page)
}

/// `GET /cases/{case}`: the form of a case.
pub(super) async fn case(
    State(app): State<App>,
    Extension(caller): Extension<Caller>,
    Path(case): Path<String>,
) -> Response {
    let name = case.clone();
    match beside(&app, move |cases| cases.load(&name)).await {
        Ok(_) => {}
        Err(Refused::Fault(why)) => return problem(StatusCode::SERVICE_UNAVAILABLE, &why),
        Err(_) => return problem(StatusCode::NOT_FOUND, "the server has no such case"),
    }
    let page = CasePage {
        case: &case,
        role: caller.holder.role.name(),
        id: &caller.holder.id,
    };
    html(StatusCode::OK, &page)
}
