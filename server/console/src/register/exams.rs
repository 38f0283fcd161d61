//! Page of the exams: seal and release.

use askama::Template;
use axum::Extension;
use axum::extract::{Path, State};
use axum::response::Response;
use serde::Deserialize;
use sulcus_proto::Role;

use super::ask::{Sent, ask, change, may_set_exams, to, values};
use super::classes::answer;
use crate::App;
use crate::guard::Caller;
use crate::house::register::{Change, Denied, Exam};
use crate::pages::html;

#[derive(Template)]
#[template(path = "exams.html")]
struct ExamsPage<'a> {
    role: &'a str,
    id: &'a str,
    is_admin: bool,
    why: &'a str,
    exams: &'a [Exam],
    /// Whether the person may seal and release.
    may_set: bool,
}

/// `GET /exams`.
pub(super) async fn page(State(app): State<App>, Extension(caller): Extension<Caller>) -> Response {
    shown(&app, &caller, None).await
}

async fn shown(app: &App, caller: &Caller, denied: Option<Denied>) -> Response {
    let mut exams = match ask(app, |register| register.exams()).await {
        Ok(exams) => exams,
        Err(why) => return why.page(),
    };
    let may_set = may_set_exams(caller);
    for exam in &mut exams {
        if exam.is_sealed && !may_set {
            // The name of a case is a part of its content.
            exam.title = "sealed".into();
        }
    }
    let (status, why) = answer(denied);
    let page = ExamsPage {
        role: caller.holder.role.name(),
        id: &caller.holder.id,
        is_admin: caller.holder.role == Role::Admin,
        why: &why,
        exams: &exams,
        may_set,
    };
    html(status, &page)
}

/// Form of a seal.
#[derive(Deserialize)]
pub(super) struct Until {
    /// Day such as `2026-12-01`; empty: until the release.
    #[serde(default)]
    until: String,
}

/// `POST /exams/{exam}/seal`.
pub(super) async fn seal(
    State(app): State<App>,
    Extension(caller): Extension<Caller>,
    Path(exam): Path<String>,
    form: Sent<Until>,
) -> Response {
    let until = match values(form) {
        Ok(form) => form.until,
        Err(page) => return *page,
    };
    done(&app, &caller, Change::Seal { exam, until }).await
}

/// Form of a release.
#[derive(Deserialize)]
pub(super) struct Sure {
    #[serde(default)]
    sure: String,
}

/// `POST /exams/{exam}/release`.
pub(super) async fn release(
    State(app): State<App>,
    Extension(caller): Extension<Caller>,
    Path(exam): Path<String>,
    form: Sent<Sure>,
) -> Response {
    let form = match values(form) {
        Ok(form) => form,
        Err(page) => return *page,
    };
    if form.sure != "yes" {
        let why = Denied::Invalid("tick the box first: nothing was changed".into());
        return shown(&app, &caller, Some(why)).await;
    }
    done(&app, &caller, Change::Release { exam }).await
}

async fn done(app: &App, caller: &Caller, wanted: Change) -> Response {
    match change(app, caller, wanted).await {
        Ok(_) => to("/exams"),
        Err(why) => shown(app, caller, Some(why)).await,
    }
}
