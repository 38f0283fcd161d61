//! Page of a learner: attempts, export, erasure.

use askama::Template;
use axum::Extension;
use axum::body::Body;
use axum::extract::{Form, Path, Request, State};
use axum::http::{HeaderValue, StatusCode, header};
use axum::response::{IntoResponse, Redirect, Response};
use serde::Deserialize;
use sulcus_proto::Role;
use tower_http::services::ServeFile;

use super::access::Sight;
use super::book::{opened, words};
use super::filter::{Filter, encoded};
use super::list::Row;
use super::{audited, reading};
use crate::App;
use crate::guard::Caller;
use crate::pages::{html, problem};

#[derive(Template)]
#[template(path = "learner.html")]
struct LearnerPage<'a> {
    role: &'a str,
    id: &'a str,
    learner: &'a str,
    label: String,
    is_admin: bool,
    rows: Vec<Row>,
}

/// Sessions of a learner.
fn filter(learner: &str) -> Filter {
    Filter {
        learner: learner.to_owned(),
        ..Filter::default()
    }
}

/// Ids of all sessions of a learner, if the caller may see every one.
async fn all_of(app: &App, caller: &Caller, learner: &str) -> Result<Vec<String>, Response> {
    let book = opened(app, caller).await?;
    let all = book.filtered(&filter(learner));
    // A part would pass for the whole. The recordings name the learner of the day; an entry may have moved some.
    let recorded = app.house.grades().all();
    let own = recorded.iter().filter(|one| one.learner == learner);
    let is_known = |id: &str| book.sessions.iter().any(|seen| seen.one.id == id);
    let is_whole = own.into_iter().all(|one| is_known(&one.id))
        && all.iter().all(|seen| seen.sight == Sight::Grade);
    if !is_whole {
        return Err(problem(
            StatusCode::FORBIDDEN,
            "the learner has sessions that this sign-in may not see; an examiner or an administrator may",
        ));
    }
    Ok(all.iter().map(|seen| seen.one.id.clone()).collect())
}

/// `GET /learners/{learner}`: the page of a learner.
pub async fn page(
    State(app): State<App>,
    Extension(caller): Extension<Caller>,
    Path(learner): Path<String>,
) -> Response {
    let book = match opened(&app, &caller).await {
        Ok(book) => book,
        Err(answer) => return answer,
    };
    audited(&app, &caller, "opens learner", &learner);
    let (all, people) = (book.filtered(&filter(&learner)), &book.people);
    let page = LearnerPage {
        role: caller.holder.role.name(),
        id: &caller.holder.id,
        label: people.label(&learner),
        learner: &learner,
        is_admin: caller.holder.role == Role::Admin,
        rows: all.iter().map(|seen| Row::of(seen, people)).collect(),
    };
    html(StatusCode::OK, &page)
}

/// `GET /learners/{learner}/export`: everything of a learner as one archive.
pub async fn export(
    State(app): State<App>,
    Extension(caller): Extension<Caller>,
    Path(learner): Path<String>,
    request: Request<Body>,
) -> Response {
    let ids = match all_of(&app, &caller, &learner).await {
        Ok(ids) => ids,
        Err(answer) => return answer,
    };
    if ids.is_empty() {
        return problem(StatusCode::NOT_FOUND, "this learner has no sessions here");
    }
    audited(&app, &caller, "exports learner", &learner);
    let name = format!("attachment; filename=\"{}.zip\"", encoded(&learner));
    let made = match reading(move || app.house.grades().export(&ids)).await {
        Ok(Ok(made)) => made,
        Ok(Err(why)) => return problem(StatusCode::INTERNAL_SERVER_ERROR, &why),
        Err(answer) => return answer,
    };
    let served = ServeFile::new(&made).try_call(request).await;
    // The open file stays readable for this answer.
    if let Err(error) = std::fs::remove_file(&made) {
        tracing::error!("console: an export stays in the temporary folder: {error}");
    }
    let mut answer = match served {
        Ok(answer) => answer.map(Body::new),
        Err(error) => {
            tracing::error!("console: an export cannot be read: {error}");
            return problem(
                StatusCode::INTERNAL_SERVER_ERROR,
                "the export cannot be read",
            );
        }
    };
    if let Ok(name) = HeaderValue::from_str(&name) {
        answer
            .headers_mut()
            .insert(header::CONTENT_DISPOSITION, name);
    }
    answer
}

/// Form of an erasure.
#[derive(Deserialize)]
pub struct Erasure {
    /// Learner id, typed once more.
    confirm: String,
}

/// `POST /learners/{learner}/erase`: removes everything of a learner.
pub async fn erase(
    State(app): State<App>,
    Extension(caller): Extension<Caller>,
    Path(learner): Path<String>,
    Form(form): Form<Erasure>,
) -> Response {
    if form.confirm.trim() != learner {
        let why = format!(
            "confirm is `{}`, expected the learner's id once more",
            form.confirm.escape_debug()
        );
        return problem(StatusCode::BAD_REQUEST, &why);
    }
    let ids = match all_of(&app, &caller, &learner).await {
        Ok(ids) => ids,
        Err(answer) => return answer,
    };
    let by = caller.holder.id;
    let erased = reading(move || {
        let register = app.house.register();
        register.record(&by, "erases learner", &learner);
        let erased = app.house.grades().erase(&learner, &ids)?;
        // The name goes last: a failure before leaves a learner whom the next attempt finds.
        match register.forget(&by, &learner) {
            Ok(_) => Ok(erased),
            Err(denied) => Err(words(denied)),
        }
    });
    match erased.await {
        Ok(Ok(erased)) => {
            tracing::info!(
                "console: a learner was erased: {} recordings, {} other files",
                erased.recordings,
                erased.files
            );
            Redirect::to("/results").into_response()
        }
        Ok(Err(why)) => problem(StatusCode::BAD_REQUEST, &why),
        Err(answer) => answer,
    }
}
