//! The mouth of a case in three dimensions, at rest, in the viewer.

use askama::Template;
use axum::Extension;
use axum::extract::{Path, State};
use axum::http::{StatusCode, header};
use axum::response::{IntoResponse, Response};

use super::{beside, refusal};
use crate::App;
use crate::guard::{Caller, refused};
use crate::house::cases::Refused;
use crate::pages::html;
use crate::results::{AROUND, with_policy};
use crate::routes::Form::Data;
use crate::view::capabilities::{Right, Shows};

#[derive(Template)]
#[template(path = "mouth.html")]
struct MouthPage<'a> {
    role: &'a str,
    id: &'a str,
    case: &'a str,
}

/// `GET /cases/{case}/mouth`: page with the viewer.
pub(super) async fn page(
    Extension(caller): Extension<Caller>,
    Path(case): Path<String>,
) -> Response {
    let page = MouthPage {
        role: caller.holder.role.name(),
        id: &caller.holder.id,
        case: &case,
    };
    with_policy(html(StatusCode::OK, &page), AROUND)
}

/// `POST /api/cases/{case}/mouth`: a path that opens the mouth once, within a minute.
pub(super) async fn open(
    State(app): State<App>,
    Extension(caller): Extension<Caller>,
    Path(case): Path<String>,
) -> Response {
    let name = case.clone();
    match beside(&app, move |cases| cases.load(&name)).await {
        Ok(_) => {
            let shows = Shows::Case(case);
            crate::view::stream::given(&app, Right { shows, caller })
        }
        Err(why) => refusal(&why),
    }
}

/// Mouth of a right that was taken. One mouth is drawn at a time.
pub(crate) async fn stream(app: &App, case: String) -> Response {
    let Ok(_turn) = app.replays.acquire().await else {
        let why = "the server is ending";
        return refused(Data, StatusCode::SERVICE_UNAVAILABLE, why);
    };
    match beside(app, move |cases| cases.mouth(&case)).await {
        Ok(bytes) => {
            let headers = [
                (header::CONTENT_TYPE, "application/vnd.rerun.rrd"),
                (header::CACHE_CONTROL, "no-store"),
            ];
            (headers, bytes).into_response()
        }
        Err(why @ Refused::Conflict(_)) => refused(Data, StatusCode::CONFLICT, &why.to_string()),
        Err(why) => refusal(&why),
    }
}
