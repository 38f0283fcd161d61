//! State of the process for programs that watch it.

use axum::Json;
use axum::extract::State;
use axum::http::StatusCode;
use axum::response::{IntoResponse, Response};
use serde_json::json;

use crate::App;

/// `GET /healthz`: the process answers.
pub async fn alive() -> Response {
    Json(json!({ "alive": true })).into_response()
}

/// `GET /readyz`: a further session can begin. Without a sign-in nobody learns more than the number of obstacles; the
/// log and `serve --check` name them.
pub async fn ready(State(app): State<App>) -> Response {
    let house = app.house.clone();
    // Asks the disk.
    let obstacles = tokio::task::spawn_blocking(move || house.obstacles()).await;
    let count = obstacles.map_or(1, |obstacles| {
        for obstacle in &obstacles {
            tracing::warn!("not ready: {obstacle}");
        }
        obstacles.len()
    });
    let status = if count == 0 {
        StatusCode::OK
    } else {
        StatusCode::SERVICE_UNAVAILABLE
    };
    (
        status,
        Json(json!({ "ready": count == 0, "obstacles": count })),
    )
        .into_response()
}
