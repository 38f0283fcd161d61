//! The chart as it fills: depths that the student has called, and those of the scene.

use axum::extract::{Path, State};
use axum::response::{IntoResponse, Response};
use axum::{Extension, Json};
use serde_json::json;

use crate::App;
use crate::guard::{Caller, no_station};
use crate::routes::Form::Data;

/// `GET /api/stations/{station}/chart`: `sites` with the depth of each site by the scene, and `called` with the last
/// reading that the student has called at each site.
pub(super) async fn chart(
    State(app): State<App>,
    Extension(caller): Extension<Caller>,
    Path(station): Path<String>,
) -> Response {
    if let Some(refusal) = no_station(&app, &caller, &station, Data) {
        return refusal;
    }
    let sites = app.house.feeds().depths(&station);
    Json(json!({ "sites": sites, "called": app.hub.called(&station) })).into_response()
}
