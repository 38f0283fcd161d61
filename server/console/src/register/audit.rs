//! Page of the audit log.

use askama::Template;
use axum::Extension;
use axum::extract::State;
use axum::http::StatusCode;
use axum::response::Response;
use sulcus_proto::Role;

use super::ask::{ask, record};
use crate::App;
use crate::guard::Caller;
use crate::house::register::Entry;
use crate::pages::html;

/// Number of entries on the page.
const SHOWN: usize = 500;

#[derive(Template)]
#[template(path = "audit.html")]
struct AuditPage<'a> {
    role: &'a str,
    id: &'a str,
    is_admin: bool,
    entries: &'a [Entry],
}

/// `GET /audit`: newest entries. The opening is an entry itself.
pub(super) async fn page(State(app): State<App>, Extension(caller): Extension<Caller>) -> Response {
    record(&app, &caller, "read audit log", String::new()).await;
    let entries = match ask(&app, |register| register.audit(SHOWN)).await {
        Ok(entries) => entries,
        Err(why) => return why.page(),
    };
    let page = AuditPage {
        role: caller.holder.role.name(),
        id: &caller.holder.id,
        is_admin: caller.holder.role == Role::Admin,
        entries: &entries,
    };
    html(StatusCode::OK, &page)
}
