//! Page of a signed-in person: own results of a student.

use askama::Template;
use axum::Extension;
use axum::extract::State;
use axum::http::StatusCode;
use axum::response::Response;
use sulcus_proto::Role;

use super::book::opened;
use super::list::Row;
use super::reading;
use crate::App;
use crate::guard::Caller;
use crate::pages::html;

#[derive(Template)]
#[template(path = "home.html")]
struct HomePage<'a> {
    role: &'a str,
    id: &'a str,
    is_student: bool,
    learner: &'a str,
    rows: Vec<Row>,
}

/// `GET /home`: a student's own sessions, the newest first. Other persons find links to their pages.
pub async fn page(State(app): State<App>, Extension(caller): Extension<Caller>) -> Response {
    let holder = &caller.holder;
    let is_student = holder.role == Role::Student;
    let (mut rows, mut learner) = (Vec::new(), String::new());
    if is_student {
        let book = match opened(&app, &caller).await {
            Ok(book) => book,
            Err(answer) => return answer,
        };
        let all = book.sessions.iter();
        rows = all.map(|seen| Row::of(seen, &book.people)).collect();
        let (app, id) = (app.clone(), holder.id.clone());
        let own = reading(move || app.house.register().learner_of_token(&id)).await;
        // Without an answer the page says that the sign-in has no learner id.
        learner = own.ok().and_then(Result::ok).unwrap_or_default();
    }
    let page = HomePage {
        role: holder.role.name(),
        id: &holder.id,
        is_student,
        learner: &learner,
        rows,
    };
    html(StatusCode::OK, &page)
}
