//! Sending of a feed to one display, on a connection of its own.
//!
//! A scene and each frame are one unidirectional stream each ([`sulcus_proto::display::stream`]). Newer frames have a
//! higher priority. A frame is reset when it is stale, so a slow path carries the newest frames and never a backlog:
//! - A frame that does not fit into the connection's buffer is reset by the next frame.
//! - A frame in the buffer that the display has not acknowledged is reset after [`UNTAKEN`] newer frames.
//!
//! A display that never reads grants no further streams. The server then holds [`UNTAKEN`] frames and QUIC's own send
//! buffer, and waits.

use std::sync::Arc;
use std::time::Duration;

use quinn::{Connection, ConnectionError, SendStream, StoppedError, VarInt, WriteError};
use sulcus_display::Display;
use sulcus_proto::display::{SceneHash, stream};
use tokio::sync::watch;
use tokio::task::JoinSet;

use crate::outlets::feed::{EncodedFrame, Feed, Latest};

/// Number of newer frames after which a frame that the display has not acknowledged is reset: 128 ms. Chosen above the
/// round trip of any path on which a student can work.
pub const UNTAKEN: u64 = 8;
/// Time for the last frames after the end of the feed.
const LAST: Duration = Duration::from_millis(500);
/// Code of a reset because a newer frame is there.
pub const STALE: VarInt = VarInt::from_u32(1);
/// Priority of a scene's stream, below all frames.
const SCENE_PRIORITY: i32 = i32::MIN;

/// Counts of one display.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FeedReport {
    /// Scenes sent in full.
    pub scenes: u64,
    /// Frames for which a stream was opened.
    pub frames: u64,
    /// Frames that the display acknowledged.
    pub taken: u64,
    /// Frames that were reset because a newer one was there.
    pub reset: u64,
    /// Frames that the display refused.
    pub refused: u64,
    /// Frames for which no stream was opened, because the display granted none in time.
    pub skipped: u64,
}

/// End of one frame.
enum End {
    Taken,
    Reset,
    Refused,
}

/// Sends scene and frames of `feed` until the connection or the feed ends. `known` are the hashes of the scenes that
/// the display has in its cache. Returns the counts.
pub async fn serve_feed(connection: Connection, known: &[SceneHash], mut feed: Feed) -> FeedReport {
    let mut report = FeedReport::default();
    let mut known = known.to_vec();
    let mut ends = JoinSet::new();
    let mut shown: Option<SceneHash> = None;
    let mut last = None;
    loop {
        let latest = feed.borrow_and_update().clone();
        if let Some(display) = &latest.display
            && shown != Some(display.hash())
        {
            let hash = display.hash();
            let is_known = known.contains(&hash);
            if send_scene(&connection, display, is_known).await.is_err() {
                break;
            }
            report.scenes += u64::from(!is_known);
            if !is_known {
                known.push(hash);
            }
            shown = Some(hash);
            // A newer frame may have come in the meantime.
            continue;
        }
        if let Some(frame) = latest.frame.filter(|frame| last != Some(frame.sequence)) {
            let Ok((stream, frame)) = open(&connection, &mut feed, frame, shown).await else {
                break;
            };
            if let Some(last) = last {
                report.skipped += frame.sequence.saturating_sub(last + 1);
            }
            last = Some(frame.sequence);
            report.frames += 1;
            ends.spawn(send_frame(stream, frame, feed.clone()));
        }
        loop {
            tokio::select! {
                changed = feed.changed() => {
                    if changed.is_err() {
                        return finished(report, ends).await;
                    }
                    break;
                }
                Some(end) = ends.join_next() => count(&mut report, end),
                _ = connection.closed() => return finished(report, ends).await,
            }
        }
    }
    finished(report, ends).await
}

/// Counts the frames that are still under way, at the end of the connection or of the feed.
async fn finished(mut report: FeedReport, mut ends: JoinSet<End>) -> FeedReport {
    while let Some(end) = ends.join_next().await {
        count(&mut report, end);
    }
    report
}

fn count(report: &mut FeedReport, end: Result<End, tokio::task::JoinError>) {
    match end {
        Ok(End::Taken) => report.taken += 1,
        Ok(End::Reset) => report.reset += 1,
        Ok(End::Refused) | Err(_) => report.refused += 1,
    }
}

/// Sends a scene, or its hash alone to a display that has it.
async fn send_scene(
    connection: &Connection,
    display: &Arc<Display>,
    is_known: bool,
) -> Result<(), WriteError> {
    let mut stream = connection.open_uni().await?;
    // An error means that the stream is closed, which the next write reports.
    let _ = stream.set_priority(SCENE_PRIORITY);
    stream
        .write_all(&stream::scene_head(&display.hash()))
        .await?;
    if !is_known {
        stream.write_all(display.bytes()).await?;
    }
    let _ = stream.finish();
    // Frames of a scene that the display does not have yet would be lost.
    match stream.stopped().await {
        Ok(_) | Err(StoppedError::ZeroRttRejected) => Ok(()),
        Err(StoppedError::ConnectionLost(error)) => Err(error.into()),
    }
}

/// Opens a stream for the newest frame of the scene. While the display grants none, newer frames replace the given one.
async fn open(
    connection: &Connection,
    feed: &mut Feed,
    mut frame: EncodedFrame,
    scene: Option<SceneHash>,
) -> Result<(SendStream, EncodedFrame), ConnectionError> {
    let stream = connection.open_uni().await?;
    // Not marked as seen: a newer scene must still be noticed by the caller.
    let latest = feed.borrow().clone();
    let is_same = latest.display.map(|display| display.hash()) == scene;
    if let Some(newer) = latest.frame.filter(|_| is_same) {
        frame = newer;
    }
    Ok((stream, frame))
}

/// Sends a frame until the display has it or it is stale.
async fn send_frame(mut stream: SendStream, frame: EncodedFrame, mut feed: Feed) -> End {
    let _ = stream.set_priority(i32::try_from(frame.sequence).unwrap_or(i32::MAX));
    let whole = async {
        stream.write_all(&stream::frame_head()).await?;
        stream.write_all(&frame.bytes).await
    };
    let written = tokio::select! {
        biased;
        written = whole => Some(written),
        () = superseded(&mut feed, frame.sequence + 1) => None,
    };
    match written {
        None => return reset(stream),
        Some(Err(_)) => return End::Refused,
        Some(Ok(())) => {}
    }
    if stream.finish().is_err() {
        return End::Refused;
    }
    let stopped = stream.stopped();
    tokio::select! {
        biased;
        stopped = stopped => match stopped {
            Ok(None) => End::Taken,
            _ => End::Refused,
        },
        () = superseded(&mut feed, frame.sequence + UNTAKEN) => reset(stream),
    }
}

fn reset(mut stream: SendStream) -> End {
    // An error means that the display stopped the stream.
    let _ = stream.reset(STALE);
    End::Reset
}

/// Waits for a frame with at least this number, or [`LAST`] after the end of the feed.
async fn superseded(feed: &mut Feed, sequence: u64) {
    let is_newer = |latest: &Latest| {
        let newest = latest.frame.as_ref().map_or(0, |frame| frame.sequence);
        newest >= sequence
    };
    if wait_for(feed, is_newer).await.is_err() {
        tokio::time::sleep(LAST).await;
    }
}

async fn wait_for(
    feed: &mut Feed,
    holds: impl FnMut(&Latest) -> bool,
) -> Result<(), watch::error::RecvError> {
    feed.wait_for(holds).await.map(|_| ())
}

#[cfg(test)]
mod tests;
