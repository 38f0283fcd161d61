//! The stream of a station for the viewer.
//!
//! A viewer's queue holds four parts; older ones are dropped. A viewer that takes nothing for [`STALL`] loses its
//! place: its stream ends.

use std::convert::Infallible;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

use axum::body::{Body, Bytes};
use axum::extract::{Path, State};
use axum::http::{StatusCode, header};
use axum::response::{IntoResponse, Response};
use axum::{Extension, Json};
use futures_util::stream::unfold;
use serde_json::json;
use tokio::sync::broadcast::error::RecvError;
use tokio::sync::mpsc;

use super::capabilities::{Right, Shows};
use crate::App;
use crate::guard::{Caller, is_signed_in, no_station, refused};
use crate::house::{Live, Segment};
use crate::routes::Form::Data;

/// Time in which a viewer must take a part.
const STALL: Duration = Duration::from_secs(10);
/// Interval between two looks at the sign-in of an open stream.
const LOOK: Duration = Duration::from_secs(1);
/// Largest number of open streams.
const STREAMS: usize = 64;

static OPEN: AtomicUsize = AtomicUsize::new(0);

/// Place of an open stream among [`STREAMS`].
struct Slot;

impl Slot {
    fn take() -> Option<Self> {
        let slot = Self;
        (OPEN.fetch_add(1, Ordering::Relaxed) < STREAMS).then_some(slot)
    }
}

impl Drop for Slot {
    fn drop(&mut self) {
        OPEN.fetch_sub(1, Ordering::Relaxed);
    }
}

/// `POST /api/stations/{station}/live`: a path that opens the station's stream once, within a minute.
///
/// The program that draws the stream starts at once, so that its first part is there when the viewer asks.
pub(super) async fn open(
    State(app): State<App>,
    Extension(caller): Extension<Caller>,
    Path(station): Path<String>,
) -> Response {
    if let Some(refusal) = no_station(&app, &caller, &station, Data) {
        return refusal;
    }
    if let Err(why) = live(&app, &station).await {
        return refused(Data, StatusCode::CONFLICT, &why);
    }
    let shows = Shows::Live(station);
    given(&app, Right { shows, caller })
}

/// Answer with a new path for a right.
pub(crate) fn given(app: &App, right: Right) -> Response {
    match app.capabilities.make(right, Instant::now()) {
        Ok(secret) => Json(json!({ "path": format!("/live/{secret}/stream.rrd") })).into_response(),
        Err(error) => {
            tracing::error!("no random numbers: {error}");
            let why = "the server cannot make a path now";
            refused(Data, StatusCode::SERVICE_UNAVAILABLE, why)
        }
    }
}

/// Stream of a station. The start of a program takes some milliseconds.
async fn live(app: &App, station: &str) -> Result<Live, String> {
    let (house, station) = (app.house.clone(), station.to_owned());
    let live = tokio::task::spawn_blocking(move || house.feeds().live(&station)).await;
    live.map_err(|_| "the server is ending".to_owned())?
}

/// `GET /live/{capability}/stream.rrd`: parts of the stream, each a complete file for the viewer, until the end of the
/// session or of the sign-in.
pub(super) async fn stream(State(app): State<App>, Path(secret): Path<String>) -> Response {
    let gone = |why: &str| refused(Data, StatusCode::NOT_FOUND, why);
    let Some(right) = app.capabilities.take(&secret, Instant::now()) else {
        return gone("this path is unknown, was used, or is older than a minute");
    };
    if !is_signed_in(&app, &right.caller) {
        return gone("the sign-in of this path has ended");
    }
    let station = match right.shows {
        Shows::Live(station) => station,
        Shows::Replay { session, at_ms } => {
            return crate::results::replay::stream(&app, &right.caller, session, at_ms).await;
        }
        Shows::Case(case) => return crate::cases::mouth::stream(&app, case).await,
    };
    let Some(slot) = Slot::take() else {
        let why = "too many open live views";
        return refused(Data, StatusCode::SERVICE_UNAVAILABLE, why);
    };
    let live = match live(&app, &station).await {
        Ok(live) => live,
        Err(why) => return refused(Data, StatusCode::CONFLICT, &why),
    };
    // The part under way, besides those in the queue.
    let (to, from) = mpsc::channel(1);
    let sending = async move {
        let _slot = slot;
        tokio::select! {
            () = send(live, to, STALL) => {}
            () = signed_out(&app, &right.caller) => {}
        }
    };
    tokio::spawn(sending);
    let body = unfold(from, |mut from: mpsc::Receiver<Segment>| async {
        let part = from.recv().await?;
        Some((Ok::<_, Infallible>(Bytes::from_owner(part)), from))
    });
    let headers = [
        (header::CONTENT_TYPE, "application/vnd.rerun.rrd"),
        (header::CACHE_CONTROL, "no-store"),
        // A proxy must not hold parts back.
        (header::HeaderName::from_static("x-accel-buffering"), "no"),
    ];
    (headers, Body::from_stream(body)).into_response()
}

/// Sends parts until the end of the stream, or until the viewer takes nothing for `stall`.
async fn send(mut live: Live, to: mpsc::Sender<Segment>, stall: Duration) {
    let begin = match live.begin.wait_for(Option::is_some).await {
        Ok(begin) => begin.clone(),
        Err(_) => return,
    };
    let mut next = begin;
    loop {
        if let Some(part) = next.take() {
            let sent = tokio::time::timeout(stall, to.send(part)).await;
            // The viewer is gone, or has stalled.
            if !matches!(sent, Ok(Ok(()))) {
                return;
            }
        }
        tokio::select! {
            part = live.further.recv() => match part {
                Ok(part) => next = Some(part),
                // Older parts were dropped. Each part is complete in itself.
                Err(RecvError::Lagged(_)) => {}
                Err(RecvError::Closed) => return,
            },
            () = to.closed() => return,
        }
    }
}

/// Waits for the end of a sign-in.
async fn signed_out(app: &App, caller: &Caller) {
    let mut look = tokio::time::interval(LOOK);
    loop {
        look.tick().await;
        if !is_signed_in(app, caller) {
            return;
        }
    }
}

#[cfg(test)]
mod tests {
    use tokio::sync::{broadcast, watch};

    use super::*;

    #[test]
    fn a_viewer_that_stalls_loses_its_place_and_one_that_reads_keeps_it() {
        let runtime = tokio::runtime::Builder::new_current_thread()
            .enable_all()
            .build()
            .expect("a runtime");
        runtime.block_on(async {
            let part = |k: u8| Segment::from([k].as_slice());
            let (begin, further) = (watch::Sender::new(None), broadcast::Sender::new(4));
            let live = || Live {
                begin: begin.subscribe(),
                further: further.subscribe(),
            };
            let stall = Duration::from_millis(100);
            let (to, mut from) = mpsc::channel(1);
            let reading = tokio::spawn(send(live(), to, stall));
            let (to, stalled) = mpsc::channel(1);
            let stalling = tokio::spawn(send(live(), to, stall));
            begin.send_replace(Some(part(0)));
            assert_eq!(from.recv().await, Some(part(0)));
            let until = Instant::now() + Duration::from_secs(120);
            let mut k = 0u8;
            while !stalling.is_finished() {
                assert!(Instant::now() < until, "the stalled viewer keeps its place");
                k = k.wrapping_add(1);
                // All receivers may be gone for the stalled one.
                assert!(further.send(part(k)).is_ok());
                assert_eq!(from.recv().await, Some(part(k)));
                tokio::time::sleep(stall / 10).await;
            }
            assert!(stalled.len() <= 1);
            assert!(!reading.is_finished());
            drop(further);
            assert_eq!(from.recv().await, None, "the end of the stream");
        });
    }
}
