//! Questions to the register beside the requests, and answers to refusals.

use axum::Form;
use axum::extract::rejection::FormRejection;
use axum::http::StatusCode;
use axum::response::{IntoResponse, Redirect, Response};
use sulcus_proto::permission::{Kind, may};

use crate::App;
use crate::guard::Caller;
use crate::house::Register;
use crate::house::register::{Change, Denied};
use crate::pages;

/// Asks the register on a thread for blocking work.
pub(super) async fn ask<T: Send + 'static>(
    app: &App,
    work: impl FnOnce(&dyn Register) -> Result<T, Denied> + Send + 'static,
) -> Result<T, Denied> {
    let house = app.house.clone();
    let done = tokio::task::spawn_blocking(move || work(house.register())).await;
    done.map_err(|_| Denied::Fault("the server is ending".into()))?
}

/// Carries out a change in the name of a signed-in person. Returns the id of a new class or learner.
pub(super) async fn change(app: &App, caller: &Caller, change: Change) -> Result<String, Denied> {
    let (by, exams) = (caller.holder.id.clone(), may_set_exams(caller));
    ask(app, move |register| register.change(&by, exams, &change)).await
}

/// Adds an entry to the audit log.
pub(super) async fn record(app: &App, caller: &Caller, action: &'static str, object: String) {
    let by = caller.holder.id.clone();
    let done = ask(app, move |register| {
        register.record(&by, action, &object);
        Ok(())
    });
    // The log of the server names a failure.
    let _ = done.await;
}

/// Whether a signed-in person may set plans of exams.
pub(super) fn may_set_exams(caller: &Caller) -> bool {
    may(caller.holder.role, Kind::ExamPlan, true)
}

impl Denied {
    /// Status of the answer, and the sentence.
    pub(super) fn answer(self) -> (StatusCode, String) {
        match self {
            Self::Unknown(why) => (StatusCode::NOT_FOUND, why),
            Self::Invalid(why) => (StatusCode::BAD_REQUEST, why),
            Self::Forbidden(why) => (StatusCode::FORBIDDEN, why),
            Self::Changed(why) => (StatusCode::CONFLICT, why),
            Self::Fault(why) => (StatusCode::INTERNAL_SERVER_ERROR, why),
        }
    }

    /// Page with the sentence alone.
    pub(super) fn page(self) -> Response {
        let (status, why) = self.answer();
        pages::problem(status, &why)
    }
}

/// Values of a form, or the page that refuses it.
pub(super) type Sent<T> = Result<Form<T>, FormRejection>;

/// Values of a form.
///
/// # Errors
/// The page about a form that cannot be read.
pub(super) fn values<T>(form: Sent<T>) -> Result<T, Box<Response>> {
    form.map(|Form(values)| values).map_err(|why| {
        let status = why.status();
        let text = format!("the form cannot be read: {}", why.body_text());
        Box::new(pages::problem(status, &text))
    })
}

/// Sends the browser to a page.
pub(super) fn to(path: &str) -> Response {
    Redirect::to(path).into_response()
}

/// Sends the browser to the page of a class. An id of other characters, which no class has, leads to the list.
pub(super) fn to_class(class: &str) -> Response {
    let plain = |c: char| c.is_ascii_alphanumeric() || c == '-';
    match class.chars().all(plain) {
        true => to(&format!("/classes/{class}")),
        false => to("/classes"),
    }
}
