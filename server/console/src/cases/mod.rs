//! Patients: the list of cases, and the form over a patient file.
//!
//! | route | content |
//! |---|---|
//! | `GET /cases`, `GET /cases/{case}` | pages |
//! | `GET, POST /api/cases` | list; a new case |
//! | `GET /api/cases-work` | compilations |
//! | `POST /api/cases-check` | faults of a chart |
//! | `GET, POST /api/cases/{case}` | load; save with the version that was loaded |
//! | `POST /api/cases/{case}/compile`, `cancel`, `remove`, `use` | acts |
//! | `GET /api/cases/{case}/picture/{side}` | drawn mouth, PNG |
//! | `GET /cases/{case}/mouth`, `POST /api/cases/{case}/mouth` | mouth in the viewer |

mod acts;
pub(crate) mod mouth;
mod pages;
mod parse;
mod read;
mod summary;

use axum::http::{Method, StatusCode};
use axum::response::{IntoResponse, Response};
use axum::routing::{get, post};
use serde_json::json;

use crate::App;
use crate::house::Cases;
use crate::house::cases::Refused;
use crate::routes::{Access, Form, Route, row};

pub use parse::Problem;

/// Routes of this part.
pub(crate) fn routes() -> Vec<Route> {
    use Access::Teachers;
    let reads = |path, form, handler| row(Method::GET, path, Teachers, form, handler);
    let acts = |path, handler| row(Method::POST, path, Teachers, Form::Data, handler);
    vec![
        reads("/cases", Form::Page, get(pages::list)),
        reads("/cases/{case}", Form::Page, get(pages::case)),
        reads("/cases/{case}/mouth", Form::Page, get(mouth::page)),
        reads("/api/cases", Form::Data, get(read::list)),
        reads("/api/cases-work", Form::Data, get(read::work)),
        reads("/api/cases/{case}", Form::Data, get(read::load)),
        reads(
            "/api/cases/{case}/picture/{side}",
            Form::Data,
            get(read::picture),
        ),
        acts("/api/cases", post(acts::create)),
        acts("/api/cases-check", post(acts::check)),
        acts("/api/cases/{case}", post(acts::save)),
        acts("/api/cases/{case}/compile", post(acts::compile)),
        acts("/api/cases/{case}/cancel", post(acts::cancel)),
        acts("/api/cases/{case}/remove", post(acts::remove)),
        acts("/api/cases/{case}/use", post(acts::plan)),
        acts("/api/cases/{case}/mouth", post(mouth::open)),
    ]
}

/// Work on the disk, beside the requests.
async fn beside<T: Send + 'static>(
    app: &App,
    work: impl FnOnce(&dyn Cases) -> Result<T, Refused> + Send + 'static,
) -> Result<T, Refused> {
    let house = app.house.clone();
    let done = tokio::task::spawn_blocking(move || work(house.cases())).await;
    done.map_err(|_| Refused::Fault("the server is ending".into()))?
}

/// Answer to a request that is refused.
fn refusal(why: &Refused) -> Response {
    let (status, field) = match why {
        Refused::Unknown(_) => (StatusCode::NOT_FOUND, None),
        Refused::Bad(field, _) => (StatusCode::BAD_REQUEST, Some(*field)),
        Refused::Conflict(_) => (StatusCode::CONFLICT, None),
        Refused::Fault(_) => (StatusCode::SERVICE_UNAVAILABLE, None),
    };
    let body = json!({ "error": why.to_string(), "field": field });
    (status, axum::Json(body)).into_response()
}

/// Answer to a body whose field is refused.
fn bad(problem: &Problem) -> Response {
    let body = json!({ "error": problem.why, "field": problem.field });
    (StatusCode::BAD_REQUEST, axum::Json(body)).into_response()
}
