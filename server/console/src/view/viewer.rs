//! The viewer's page and files.
//!
//! The viewer's own page has scripts of other origins. The console serves a page of its own instead, and of the viewer
//! the two files with the program alone.

use std::sync::Arc;

use axum::Json;
use axum::body::Bytes;
use axum::extract::{Path, State};
use axum::http::{StatusCode, header};
use axum::response::{IntoResponse, Response};
use serde_json::json;

use crate::App;
use crate::guard::refused;
use crate::house::Viewer;
use crate::routes::Form::Data;

/// Policy of the viewer's page: its program is WebAssembly. Calls to other origins, which that program makes, end here.
const POLICY: &str = "default-src 'none'; script-src 'self' 'wasm-unsafe-eval'; style-src 'self' 'unsafe-inline'; img-src 'self' data: blob:; connect-src 'self'; worker-src 'self' blob:; font-src 'self' data:; form-action 'none'; base-uri 'none'; frame-ancestors 'self'";
/// Page in the frame of a station's page, and its script. Parts of this program, so never kept by a browser.
const OWN: [(&str, &str, &str); 2] = [
    (
        "index.html",
        "text/html; charset=utf-8",
        include_str!("../assets/viewer.html"),
    ),
    (
        "start.js",
        "text/javascript; charset=utf-8",
        include_str!("../assets/viewer.js"),
    ),
];

/// Files of the viewer. The first call takes some seconds.
async fn files(app: &App) -> Result<Arc<Viewer>, String> {
    let house = app.house.clone();
    let files = tokio::task::spawn_blocking(move || house.feeds().viewer()).await;
    files.map_err(|_| "the server is ending".to_owned())?
}

/// `GET /api/viewer`: path of the viewer's page, or the reason why there is none.
pub(super) async fn about(State(app): State<App>) -> Response {
    match files(&app).await {
        Ok(viewer) => {
            let page = format!("/viewer/{}/index.html", viewer.version);
            Json(json!({ "version": viewer.version, "page": page })).into_response()
        }
        Err(why) => refused(Data, StatusCode::SERVICE_UNAVAILABLE, &why),
    }
}

/// `GET /viewer/{version}/{name}`: page, script or file of the viewer.
pub(super) async fn file(
    State(app): State<App>,
    Path((version, name)): Path<(String, String)>,
) -> Response {
    let policy = (header::CONTENT_SECURITY_POLICY, POLICY);
    if let Some((_, content_type, content)) = OWN.iter().find(|(own, ..)| *own == name) {
        let headers = [
            (header::CONTENT_TYPE, *content_type),
            (header::CACHE_CONTROL, "no-cache"),
            policy,
        ];
        return (headers, *content).into_response();
    }
    let viewer = match files(&app).await {
        Ok(viewer) => viewer,
        Err(why) => return refused(Data, StatusCode::SERVICE_UNAVAILABLE, &why),
    };
    let found = viewer.files.get(&name);
    let Some(content) = found.filter(|_| viewer.version == version) else {
        return refused(Data, StatusCode::NOT_FOUND, "the viewer has no such file");
    };
    let content_type = match name.rsplit_once('.') {
        Some((_, "wasm")) => "application/wasm",
        Some((_, "js")) => "text/javascript; charset=utf-8",
        _ => "application/octet-stream",
    };
    let headers = [
        (header::CONTENT_TYPE, content_type),
        (header::CONTENT_ENCODING, "gzip"),
        // The path names the version, so the content of a path never changes.
        (
            header::CACHE_CONTROL,
            "private, max-age=31536000, immutable",
        ),
        policy,
    ];
    (headers, Bytes::from_owner(content.clone())).into_response()
}
