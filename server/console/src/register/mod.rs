//! Pages of classes, learners, seats, exams and the audit log.
//!
//! Each form is answered by a page: after a change by the page that shows it, after a refusal by the same page with the
//! reason. Every opening of a list with names stands in the audit log.

mod ask;
mod audit;
mod classes;
mod exams;
mod import;
mod seats;
mod tasks;

use axum::extract::DefaultBodyLimit;
use axum::http::Method;
use axum::routing::{MethodRouter, get, post};

use crate::App;
use crate::routes::{Access, Form, Route, row};

/// Largest body with a roster, bytes.
const ROSTER: usize = 1 << 20;

/// Routes of this part.
pub(crate) fn routes() -> Vec<Route> {
    use Access::{Admins, Examiners, Teachers};
    let read = |path, access, handler: MethodRouter<App>| {
        row(Method::GET, path, access, Form::Page, handler)
    };
    let change = |path, access, handler: MethodRouter<App>| {
        row(Method::POST, path, access, Form::Page, handler)
    };
    let roster = post(import::submit).layer(DefaultBodyLimit::max(ROSTER));
    vec![
        read("/classes", Teachers, get(classes::list)),
        change("/classes", Teachers, post(classes::make)),
        read("/classes/import", Teachers, get(import::page)),
        change("/classes/import", Teachers, roster),
        read("/classes/{class}", Teachers, get(classes::class)),
        change("/classes/{class}/name", Teachers, post(classes::rename)),
        change("/classes/{class}/remove", Teachers, post(classes::remove)),
        change("/classes/{class}/plan", Teachers, post(tasks::of_class)),
        change("/classes/{class}/codes", Teachers, post(classes::codes)),
        change("/classes/{class}/learners", Teachers, post(classes::add)),
        change(
            "/classes/{class}/learners/{learner}/plan",
            Teachers,
            post(tasks::of_learner),
        ),
        change(
            "/classes/{class}/learners/{learner}/code",
            Teachers,
            post(classes::code),
        ),
        change(
            "/classes/{class}/learners/{learner}/remove",
            Teachers,
            post(classes::drop_learner),
        ),
        read("/seats", Teachers, get(seats::page)),
        change("/seats", Teachers, post(seats::seat)),
        change("/seats/reassign", Teachers, post(seats::reassign)),
        read("/exams", Teachers, get(exams::page)),
        change("/exams/{exam}/seal", Examiners, post(exams::seal)),
        change("/exams/{exam}/release", Examiners, post(exams::release)),
        read("/audit", Admins, get(audit::page)),
    ]
}
