//! Pages of recorded sessions and their grades.
//!
//! | module | content |
//! |---|---|
//! | `list` | all sessions, filtered; the table for spreadsheets; the sheets for a printer |
//! | `session` | a session: grade, evidence, scores of persons |
//! | `class` | a class: agreement with the truth, map of the sites, trend, points lost |
//! | `replay` | a moment of a session in three dimensions |
//! | `compare` | two sessions with the same patient, as by two examiners |
//! | `learner` | a learner: attempts, export, erasure |
//! | `home` | own results of a student |
//! | `access`, `book` | sessions that a person may see, names and classes |
//! | `grade`, `stats`, `norms`, `trend` | grade as data, statistics |

mod access;
mod book;
mod class;
mod compare;
mod filter;
mod grade;
mod home;
mod learner;
mod list;
mod norms;
pub(crate) mod replay;
mod session;
mod stats;
mod trend;

use axum::http::Method;
use axum::response::Response;
use axum::routing::{get, post};

pub(crate) use session::{AROUND, with_policy};

use crate::App;
use crate::guard::Caller;
use crate::routes::{Access, Form, Route, row};

/// Routes of this part.
pub(crate) fn routes() -> Vec<Route> {
    use Access::{Admins, Graded, SignedIn, Students, Teachers};
    use Form::{Data, Page};
    let read = |path, access, form, handler| row(Method::GET, path, access, form, handler);
    let change = |path, access, handler| row(Method::POST, path, access, Page, handler);
    vec![
        read("/home", SignedIn, Page, get(home::page)),
        read("/results", Teachers, Page, get(list::page)),
        read("/results/table.csv", Teachers, Data, get(list::table)),
        read("/results/print", Teachers, Page, get(list::print)),
        read("/results/class", Teachers, Page, get(class::page)),
        read("/results/compare", Teachers, Page, get(compare::page)),
        read(
            "/results/session/{session}",
            Graded,
            Page,
            get(session::page),
        ),
        read(
            "/results/session/{session}/sheet",
            Graded,
            Page,
            get(session::sheet),
        ),
        read(
            "/results/session/{session}/replay",
            Teachers,
            Page,
            get(replay::page),
        ),
        row(
            Method::POST,
            "/api/results/{session}/replay",
            Teachers,
            Data,
            post(replay::open),
        ),
        read(
            "/results/session/{session}/recording",
            Teachers,
            Data,
            get(session::recording),
        ),
        change(
            "/results/session/{session}/own-score",
            Students,
            post(session::own_score),
        ),
        change(
            "/results/session/{session}/revise",
            Teachers,
            post(session::revise),
        ),
        change(
            "/results/session/{session}/again",
            Teachers,
            post(session::again),
        ),
        change(
            "/results/session/{session}/norm",
            Teachers,
            post(session::norm),
        ),
        read("/learners/{learner}", Teachers, Page, get(learner::page)),
        read(
            "/learners/{learner}/export",
            Teachers,
            Data,
            get(learner::export),
        ),
        change("/learners/{learner}/erase", Admins, post(learner::erase)),
    ]
}

/// Work that reads many files, beside the requests.
async fn reading<T: Send + 'static>(
    work: impl FnOnce() -> T + Send + 'static,
) -> Result<T, Response> {
    tokio::task::spawn_blocking(work).await.map_err(|_| {
        crate::pages::problem(
            axum::http::StatusCode::SERVICE_UNAVAILABLE,
            "the server is ending",
        )
    })
}

/// Adds an entry to the audit log: a person opened or changed something.
fn audited(app: &App, caller: &Caller, action: &'static str, object: &str) {
    let (app, by, object) = (app.clone(), caller.holder.id.clone(), object.to_owned());
    // The log writes a file; the answer does not wait for it.
    tokio::task::spawn_blocking(move || app.house.register().record(&by, action, &object));
}
