//! The newest data of all stations, and the stream of changes for a page.

use std::convert::Infallible;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;

use axum::extract::State;
use axum::http::StatusCode;
use axum::response::sse::{Event, KeepAlive, Sse};
use axum::response::{IntoResponse, Response};
use axum::{Extension, Json};
use futures_util::stream::unfold;
use serde_json::json;
use tokio::sync::broadcast::Receiver;
use tokio::sync::broadcast::error::RecvError;
use tokio::time::Interval;

use crate::App;
use crate::guard::{Caller, is_signed_in, refused};
use crate::hub::Sent;
use crate::routes::Form;

/// Interval between two signs of life of a stream.
const ALIVE: Duration = Duration::from_secs(10);
/// Interval between two looks at the sign-in of an open stream.
const LOOK: Duration = Duration::from_secs(1);
/// Largest number of open streams.
const STREAMS: usize = 256;

static OPEN: AtomicUsize = AtomicUsize::new(0);

/// `GET /api/stations`: newest status, alerts and last events of each permitted station.
pub async fn snapshot(State(app): State<App>, Extension(caller): Extension<Caller>) -> Response {
    Json(app.hub.snapshot(|station| caller.holder.includes(station))).into_response()
}

/// Place of an open stream among [`STREAMS`].
pub(crate) struct Slot;

impl Slot {
    pub(crate) fn take() -> Option<Self> {
        let slot = Self;
        (OPEN.fetch_add(1, Ordering::Relaxed) < STREAMS).then_some(slot)
    }
}

impl Drop for Slot {
    fn drop(&mut self) {
        OPEN.fetch_sub(1, Ordering::Relaxed);
    }
}

/// An open stream.
struct Stream {
    app: App,
    caller: Caller,
    messages: Receiver<Sent>,
    look: Interval,
    /// Whether the page must ask for all data first.
    is_first: bool,
    _slot: Slot,
}

/// `GET /api/events`: changes of all permitted stations as server-sent events.
///
/// `status` and `event` hold the JSON of one station. `lag` means that messages are missing: the page asks for
/// `/api/stations` again. `signed-out` is the last event of a stream whose sign-in has ended.
pub async fn events(State(app): State<App>, Extension(caller): Extension<Caller>) -> Response {
    let Some(slot) = Slot::take() else {
        let why = "too many open pages";
        return refused(Form::Data, StatusCode::SERVICE_UNAVAILABLE, why);
    };
    let stream = Stream {
        messages: app.hub.subscribe(),
        app,
        caller,
        look: tokio::time::interval(LOOK),
        is_first: true,
        _slot: slot,
    };
    let stream = unfold(Some(stream), |stream| async {
        let (event, stream) = stream?.next().await;
        Some((Ok::<_, Infallible>(event), stream))
    });
    let alive = KeepAlive::new().interval(ALIVE);
    let mut response = Sse::new(stream).keep_alive(alive).into_response();
    // A proxy must not hold the events back.
    let header = axum::http::HeaderValue::from_static("no");
    response.headers_mut().insert("x-accel-buffering", header);
    response
}

impl Stream {
    /// Next event, and the stream unless this was its last one.
    async fn next(mut self) -> (Event, Option<Self>) {
        if std::mem::take(&mut self.is_first) {
            return (Event::default().event("lag").data("{}"), Some(self));
        }
        loop {
            tokio::select! {
                message = self.messages.recv() => match message {
                    Ok(Sent { station, kind, text }) if self.caller.holder.includes(&station) => {
                        let event = Event::default().event(kind.name()).data(Arc::<str>::as_ref(&text));
                        return (event, Some(self));
                    }
                    Ok(_) => {}
                    Err(RecvError::Lagged(missed)) => {
                        let data = json!({ "missed": missed }).to_string();
                        return (Event::default().event("lag").data(data), Some(self));
                    }
                    Err(RecvError::Closed) => return self.last(),
                },
                _ = self.look.tick() => if !is_signed_in(&self.app, &self.caller) {
                    return self.last();
                },
            }
        }
    }

    fn last(self) -> (Event, Option<Self>) {
        (Event::default().event("signed-out").data("{}"), None)
    }
}
