//! Page of a roster: first a report of every line, then the import of exactly that report.

use askama::Template;
use axum::Extension;
use axum::extract::State;
use axum::http::StatusCode;
use axum::response::Response;
use serde::Deserialize;
use sulcus_proto::Role;

use super::ask::{Sent, ask, record, values};
use super::classes::answer;
use crate::App;
use crate::guard::Caller;
use crate::house::register::{ClassRow, Denied, Report};
use crate::pages::html;

#[derive(Template)]
#[template(path = "import.html")]
struct ImportPage<'a> {
    role: &'a str,
    id: &'a str,
    is_admin: bool,
    why: &'a str,
    roster: &'a str,
    class: &'a str,
    classes: &'a [ClassRow],
    report: Option<&'a Report>,
    /// Whether the report has been carried out.
    is_done: bool,
}

impl Report {
    /// Number of lines with a verdict.
    fn count(&self, verdict: &str) -> usize {
        let lines = self.lines.iter();
        lines.filter(|line| line.verdict == verdict).count()
    }

    /// Number of lines that change something.
    fn changes(&self) -> usize {
        let all = ["new", "renamed", "moved"];
        all.iter().map(|verdict| self.count(verdict)).sum()
    }
}

/// `GET /classes/import`.
pub(super) async fn page(State(app): State<App>, Extension(caller): Extension<Caller>) -> Response {
    let form = Roster::default();
    shown(&app, &caller, &form, None, None).await
}

/// Form with a roster.
#[derive(Default, Deserialize)]
pub(super) struct Roster {
    /// Text of the table.
    #[serde(default)]
    roster: String,
    /// Name of the class for lines without one.
    #[serde(default)]
    class: String,
    /// Hash of the report that is carried out; empty: a report is asked for.
    #[serde(default)]
    hash: String,
}

/// `POST /classes/import`: a report, or the import of a report.
pub(super) async fn submit(
    State(app): State<App>,
    Extension(caller): Extension<Caller>,
    form: Sent<Roster>,
) -> Response {
    let form = match values(form) {
        Ok(form) => form,
        Err(page) => return *page,
    };
    let by = caller.holder.id.clone();
    let Roster {
        roster,
        class,
        hash,
    } = &form;
    let (roster, class, hash) = (roster.clone(), class.clone(), hash.clone());
    let report = ask(&app, move |register| {
        if roster.trim().is_empty() {
            let why = "the table is empty: choose a file, or paste its lines";
            return Err(Denied::Invalid(why.into()));
        }
        if hash.is_empty() {
            return Ok((register.examine(&roster, &class)?, None));
        }
        match register.import(&by, &roster, &class, &hash) {
            Ok(report) => Ok((report, None)),
            // The page shows the present report beside the reason.
            Err(Denied::Changed(why)) => {
                let present = register.examine(&roster, &class)?;
                Ok((present, Some(Denied::Changed(why))))
            }
            Err(why) => Err(why),
        }
    });
    let (report, denied) = match report.await {
        Ok((report, denied)) => (Some(report), denied),
        Err(why) => (None, Some(why)),
    };
    if report.is_some() {
        record(&app, &caller, "read names", "roster of an import".into()).await;
    }
    shown(&app, &caller, &form, report.as_ref(), denied).await
}

async fn shown(
    app: &App,
    caller: &Caller,
    form: &Roster,
    report: Option<&Report>,
    denied: Option<Denied>,
) -> Response {
    let classes = match ask(app, |register| register.classes()).await {
        Ok(classes) => classes,
        Err(why) => return why.page(),
    };
    let (status, why) = answer(denied);
    let is_done = !form.hash.is_empty() && status == StatusCode::OK;
    let page = ImportPage {
        role: caller.holder.role.name(),
        id: &caller.holder.id,
        is_admin: caller.holder.role == Role::Admin,
        why: &why,
        roster: &form.roster,
        class: &form.class,
        classes: &classes,
        report,
        is_done,
    };
    html(status, &page)
}
