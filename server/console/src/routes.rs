//! Table of all routes: method, path, the roles that may use it. The router is made from the table, and tests walk it.

use axum::Router;
use axum::extract::DefaultBodyLimit;
use axum::http::{HeaderName, HeaderValue, Method, StatusCode};
use axum::middleware::from_fn_with_state;
use axum::routing::{MethodRouter, get, post};
use sulcus_proto::Role;
use sulcus_proto::permission::{Kind, may};
use tower_http::set_header::SetResponseHeaderLayer;
use tower_http::timeout::TimeoutLayer;

use crate::{
    App, assets, cases, clients, first, guard, health, instructions, live, pages, register,
    results, sign_in, view,
};

/// Largest body of a request, bytes.
const BODY: usize = 64 * 1024;
/// Timeout of a request. Answers of instructions take 2 s at most, those of plans as long as a scene compiles.
const TIMEOUT: std::time::Duration = std::time::Duration::from_secs(120);

/// Persons who may use a route.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Access {
    /// Everybody, without a sign-in.
    Open,
    /// Every signed-in person.
    SignedIn,
    /// Students alone.
    Students,
    /// Students and teachers. A student reaches the own sessions alone.
    Graded,
    /// Signed-in persons who may watch a station by the table of permissions: the roles of teachers.
    Teachers,
    /// Signed-in persons who may set plans of exams.
    Examiners,
    /// Administrators alone.
    Admins,
}

impl Access {
    /// Whether a signed-in person of `role` may use the route. `None`: nobody is signed in.
    pub fn admits(self, role: Option<Role>) -> bool {
        match (self, role) {
            (Self::Open, _) | (Self::SignedIn, Some(_)) => true,
            (Self::Teachers, Some(role)) => may(role, Kind::Watch, true),
            (Self::Students, Some(role)) => role == Role::Student,
            (Self::Graded, Some(role)) => role == Role::Student || may(role, Kind::Watch, true),
            (Self::Examiners, Some(role)) => may(role, Kind::ExamPlan, true),
            (Self::Admins, Some(role)) => role == Role::Admin,
            (_, None) => false,
        }
    }
}

/// Form of a route's answers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// A page: a person without a sign-in is sent to the page for it.
    Page,
    /// Data for programs and scripts.
    Data,
}

/// Row of the table.
pub struct Route {
    /// Method.
    pub method: Method,
    /// Path with the names of its parts in braces.
    pub path: &'static str,
    /// Persons who may use it.
    pub access: Access,
    /// Form of the answers.
    pub form: Form,
    handler: MethodRouter<App>,
}

/// A row of the table.
pub(crate) fn row(
    method: Method,
    path: &'static str,
    access: Access,
    form: Form,
    handler: MethodRouter<App>,
) -> Route {
    Route {
        method,
        path,
        access,
        form,
        handler,
    }
}

/// All routes.
pub fn table() -> Vec<Route> {
    let mut all = base();
    all.extend(register::routes());
    all.extend(cases::routes());
    all.extend(results::routes());
    all.extend(view::routes());
    all.extend(clients::routes());
    all
}

/// Routes of the stations, of the sign-in and of the server's health.
fn base() -> Vec<Route> {
    use Access::{Open, SignedIn, Teachers};
    use Form::{Data, Page};
    let (read, change) = (Method::GET, Method::POST);
    vec![
        row(read.clone(), "/", Teachers, Page, get(pages::stations)),
        row(
            read.clone(),
            "/stations/{station}",
            Teachers,
            Page,
            get(pages::station),
        ),
        row(read.clone(), "/sign-in", Open, Page, get(sign_in::page)),
        row(
            change.clone(),
            "/sign-in",
            Open,
            Page,
            post(sign_in::submit),
        ),
        row(
            change.clone(),
            "/sign-out",
            SignedIn,
            Page,
            post(sign_in::out),
        ),
        row(
            read.clone(),
            "/password",
            SignedIn,
            Page,
            get(sign_in::password_page),
        ),
        row(
            change.clone(),
            "/password",
            SignedIn,
            Page,
            post(sign_in::set_password),
        ),
        row(
            read.clone(),
            "/first/{secret}",
            Open,
            Page,
            get(first::page),
        ),
        row(
            change.clone(),
            "/first/{secret}",
            Open,
            Page,
            post(first::submit),
        ),
        row(
            read.clone(),
            "/api/stations",
            Teachers,
            Data,
            get(live::snapshot),
        ),
        row(
            read.clone(),
            "/api/events",
            Teachers,
            Data,
            get(live::events),
        ),
        row(
            change,
            "/api/stations/{station}/instruct",
            Teachers,
            Data,
            post(instructions::instruct),
        ),
        row(read.clone(), "/healthz", Open, Data, get(health::alive)),
        row(read.clone(), "/readyz", Open, Data, get(health::ready)),
        row(read, "/assets/{name}", Open, Data, get(assets::asset)),
    ]
}

/// Policy of pages: everything from this origin, no frames.
pub(crate) const POLICY: &str = "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data:; connect-src 'self'; form-action 'self'; base-uri 'none'; frame-ancestors 'none'";
/// Headers of every answer. Pages load nothing from other origins and cannot be framed.
const HEADERS: [(&str, &str); 4] = [
    ("content-security-policy", POLICY),
    ("x-content-type-options", "nosniff"),
    ("referrer-policy", "same-origin"),
    ("cross-origin-opener-policy", "same-origin"),
];

/// Router of the table. Every route, and every path that is no route, passes the guard.
pub fn router(app: App) -> Router {
    let mut router = Router::new();
    for route in table() {
        let rule = guard::Rule {
            app: app.clone(),
            access: route.access,
            form: route.form,
        };
        let handler = route.handler.layer(from_fn_with_state(rule, guard::pass));
        router = router.route(route.path, handler);
    }
    let timeout = TimeoutLayer::with_status_code(StatusCode::SERVICE_UNAVAILABLE, TIMEOUT);
    let mut router = router
        .fallback(pages::unknown)
        .layer(DefaultBodyLimit::max(BODY))
        .layer(timeout);
    for (name, value) in HEADERS {
        let layer = SetResponseHeaderLayer::if_not_present(
            HeaderName::from_static(name),
            HeaderValue::from_static(value),
        );
        router = router.layer(layer);
    }
    let kept = SetResponseHeaderLayer::if_not_present(
        axum::http::header::CACHE_CONTROL,
        HeaderValue::from_static("no-store"),
    );
    router.layer(kept).with_state(app)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_student_and_a_display_reach_their_own_page_and_nothing_of_a_teacher() {
        for role in [Role::Student, Role::Display] {
            let open: Vec<&str> = table()
                .iter()
                .filter(|route| route.access != Access::Open && route.access.admits(Some(role)))
                .map(|route| route.path)
                .collect();
            let mut own = vec!["/sign-out", "/password", "/password", "/home"];
            if role == Role::Student {
                own.extend([
                    "/results/session/{session}",
                    "/results/session/{session}/sheet",
                    "/results/session/{session}/own-score",
                ]);
            }
            assert_eq!(open, own, "{role}");
        }
        for (role, closed) in [
            (
                Role::Instructor,
                &[Access::Students, Access::Examiners, Access::Admins][..],
            ),
            (Role::Examiner, &[Access::Students, Access::Admins]),
            (Role::Admin, &[Access::Students]),
        ] {
            for route in table() {
                let expected = !closed.contains(&route.access);
                let admits = route.access.admits(Some(role));
                assert_eq!(admits, expected, "{role} {}", route.path);
            }
        }
    }

    #[test]
    fn nobody_reads_stations_or_changes_anything_without_a_sign_in() {
        for route in table() {
            let is_open = route.access.admits(None);
            let expected = matches!(
                route.path,
                "/sign-in"
                    | "/first/{secret}"
                    | "/healthz"
                    | "/readyz"
                    | "/assets/{name}"
                    | "/clients"
                    | "/clients/{file}"
                    | "/live/{capability}/stream.rrd"
            );
            assert_eq!(is_open, expected, "{} {}", route.method, route.path);
        }
    }
}
