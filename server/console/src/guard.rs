//! The guard of every route: sign-in, role, origin.

use std::time::Instant;

use axum::extract::{Request, State};
use axum::http::{HeaderMap, Method, StatusCode, Uri, header};
use axum::middleware::Next;
use axum::response::{IntoResponse, Redirect, Response};
use axum_extra::extract::CookieJar;
use serde_json::json;

use crate::App;
use crate::house::Holder;
use crate::routes::{Access, Form};
use crate::sessions::COOKIE;

/// Rule of a route.
#[derive(Clone)]
pub struct Rule {
    /// Data of all requests.
    pub app: App,
    /// Persons who may use the route.
    pub access: Access,
    /// Form of the answers.
    pub form: Form,
}

/// Sign-in of a request.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Caller {
    /// Rights.
    pub holder: Holder,
    /// Id of the browser's session; `None`: the request has a token of its own.
    pub session: Option<String>,
}

/// Passes a request to its handler, or refuses it.
///
/// A browser is known by its cookie, a script by the header `Authorization: Bearer TOKEN`. A request that changes
/// something must come from a page of this origin or carry such a header, which a foreign page cannot add.
pub async fn pass(State(rule): State<Rule>, mut request: Request, next: Next) -> Response {
    let caller = caller(&rule.app, request.headers(), request.uri().path());
    let is_scripted = caller
        .as_ref()
        .is_some_and(|caller| caller.session.is_none());
    let is_safe = matches!(*request.method(), Method::GET | Method::HEAD);
    if !is_safe && !is_scripted && !is_same_origin(request.headers(), request.uri()) {
        return refused(
            rule.form,
            StatusCode::FORBIDDEN,
            "the request comes from another origin",
        );
    }
    let role = caller.as_ref().map(|caller| caller.holder.role);
    if !rule.access.admits(role) {
        return match (role, rule.form) {
            (None, Form::Page) if is_safe => Redirect::to("/sign-in").into_response(),
            (None, _) => refused(rule.form, StatusCode::UNAUTHORIZED, "sign in first"),
            (Some(_), _) if request.uri().path() == "/" => Redirect::to("/home").into_response(),
            (Some(role), _) => {
                let why = format!("the role {role} may not use this page");
                refused(rule.form, StatusCode::FORBIDDEN, &why)
            }
        };
    }
    if let Some(caller) = caller {
        request.extensions_mut().insert(caller);
    }
    next.run(request).await
}

/// Sign-in of a request, if its session or its token is valid.
pub fn caller(app: &App, headers: &HeaderMap, path: &str) -> Option<Caller> {
    if let Some(token) = bearer(headers) {
        let holder = app.house.find(token).ok()?;
        return Some(Caller {
            holder,
            session: None,
        });
    }
    let id = CookieJar::from_headers(headers)
        .get(COOKIE)?
        .value()
        .to_owned();
    // A page asks for these by itself, without a click.
    let is_background = ["/api/events", "/api/cases-work"].contains(&path);
    let holder = app.sessions.holder(&id, Instant::now(), is_background)?;
    if app.house.still(&holder.id).is_err() {
        app.sessions.end_of(&holder.id);
        return None;
    }
    Some(Caller {
        holder,
        session: Some(id),
    })
}

/// Whether the sign-in of an open stream goes on. A look at it keeps no session.
pub(crate) fn is_signed_in(app: &App, caller: &Caller) -> bool {
    let session = caller.session.as_ref();
    session.is_none_or(|id| app.sessions.holder(id, Instant::now(), true).is_some())
        && app.house.still(&caller.holder.id).is_ok()
}

fn bearer(headers: &HeaderMap) -> Option<&str> {
    let value = headers.get(header::AUTHORIZATION)?.to_str().ok()?;
    let (scheme, token) = value.split_once(' ')?;
    scheme.eq_ignore_ascii_case("bearer").then_some(token)
}

/// Whether a request comes from a page of this origin. Browsers send `Sec-Fetch-Site`; older ones `Origin` alone.
fn is_same_origin(headers: &HeaderMap, uri: &Uri) -> bool {
    let text = |name: &str| headers.get(name).and_then(|value| value.to_str().ok());
    if let Some(site) = text("sec-fetch-site") {
        return site == "same-origin";
    }
    // HTTP/2 has the host in the address of the request.
    let host = uri
        .authority()
        .map(|host| host.as_str())
        .or_else(|| text("host"));
    let origin = text("origin").and_then(|origin| origin.strip_prefix("https://"));
    origin.is_some() && origin == host
}

/// Refusal of a station that the sign-in may not see; `None`: the sign-in may. A station that does not exist and one
/// of others look alike.
pub fn no_station(app: &App, caller: &Caller, station: &str, form: Form) -> Option<Response> {
    let is_own = app.hub.has(station) && caller.holder.includes(station);
    let why = "this sign-in has no such station";
    (!is_own).then(|| refused(form, StatusCode::NOT_FOUND, why))
}

/// Answer to a request that is refused.
pub fn refused(form: Form, status: StatusCode, why: &str) -> Response {
    match form {
        Form::Page => crate::pages::problem(status, why),
        Form::Data => (status, axum::Json(json!({ "error": why }))).into_response(),
    }
}

#[cfg(test)]
mod tests {
    use axum::http::HeaderValue;

    use super::*;

    #[test]
    fn only_a_page_of_this_origin_counts_as_same() {
        let cases: [(&[(&'static str, &'static str)], bool); 8] = [
            (&[("sec-fetch-site", "same-origin")], true),
            (
                &[
                    ("sec-fetch-site", "cross-site"),
                    ("origin", "https://a:1"),
                    ("host", "a:1"),
                ],
                false,
            ),
            (&[("sec-fetch-site", "same-site")], false),
            (&[("sec-fetch-site", "none")], false),
            (&[("origin", "https://a:1"), ("host", "a:1")], true),
            (&[("origin", "https://b:1"), ("host", "a:1")], false),
            (&[("origin", "null"), ("host", "null")], false),
            (&[("host", "a:1")], false),
        ];
        for (headers, expected) in cases {
            let mut map = HeaderMap::new();
            for (name, value) in headers {
                map.insert(*name, HeaderValue::from_static(value));
            }
            assert_eq!(
                is_same_origin(&map, &Uri::from_static("/x")),
                expected,
                "{headers:?}"
            );
        }
    }
}
