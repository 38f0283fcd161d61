//! Live view of a station: in three dimensions by the viewer, flat as a fallback, the chart as it fills.
//!
//! | module | content |
//! |---|---|
//! | [`capabilities`] | paths that open one stream once |
//! | `stream` | the stream of a station for the viewer |
//! | `viewer` | the viewer's page and files |
//! | `flat` | the flat picture, ten times a second |
//! | `chart` | called and true depths |

pub mod capabilities;
mod chart;
mod flat;
pub(crate) mod stream;
mod viewer;

use axum::http::Method;
use axum::routing::{get, post};

use crate::routes::Access::{Open, Teachers};
use crate::routes::Form::Data;
use crate::routes::{Route, row};

/// Routes of this part.
pub(crate) fn routes() -> Vec<Route> {
    let read = Method::GET;
    vec![
        row(
            Method::POST,
            "/api/stations/{station}/live",
            Teachers,
            Data,
            post(stream::open),
        ),
        // The path is the right: the viewer's request has no cookie.
        row(
            read.clone(),
            "/live/{capability}/stream.rrd",
            Open,
            Data,
            get(stream::stream),
        ),
        row(
            read.clone(),
            "/api/viewer",
            Teachers,
            Data,
            get(viewer::about),
        ),
        row(
            read.clone(),
            "/viewer/{version}/{name}",
            Teachers,
            Data,
            get(viewer::file),
        ),
        row(
            read.clone(),
            "/api/stations/{station}/flat",
            Teachers,
            Data,
            get(flat::flat),
        ),
        row(
            read,
            "/api/stations/{station}/chart",
            Teachers,
            Data,
            get(chart::chart),
        ),
    ]
}
