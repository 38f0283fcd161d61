//! End of a session: its summary, the end of its recording, and the words for the goodbye.

use sulcus_proto::SessionSummary;
use sulcus_proto::control::EndReason;
use sulcus_sessions::Occurrence;

use crate::outlets::recording::{FromNetwork, Report};
use crate::session::handoff::Flags;
use crate::session::metrics::Metrics;
use crate::session::ports::Ports;

/// Stops the ticks, then finishes the recording. `ticks` ends the loop of the ticks, `recorder` that of the recorder
/// after its end was said; each is `None` after a panic of its loop.
///
/// Completes `summary`, which holds the reason of the end and the gaps, and returns it with a short text for the
/// goodbye. After the failure of a loop the summary has another reason.
pub(super) fn finish(
    ports: &Ports,
    mut summary: SessionSummary,
    ticks: impl FnOnce() -> Option<Metrics>,
    recorder: impl FnOnce() -> Option<Report>,
) -> (SessionSummary, String) {
    Flags::raise(&ports.flags().stop);
    if let Some(hand) = ports.hand() {
        hand.stop();
    }
    summary.edges_dropped = ports.events_dropped();
    {
        let datagrams = ports.datagrams();
        summary.poses = datagrams.counts();
        (summary.foreign, summary.malformed) = (datagrams.foreign, datagrams.malformed);
    }
    match ticks() {
        Some(metrics) => metrics.fill(&mut summary),
        None => summary.end = EndReason::Simulation,
    }
    let stopped = summary.end == EndReason::Stopped;
    let breach = ports.hand().and_then(|hand| hand.breach(stopped));
    if let Some(breach) = &breach {
        summary.end = EndReason::Diverged;
        let diverged = Occurrence::diverged(breach.tick, &breach.why);
        ports.say(FromNetwork::Occurrence(Box::new(diverged)));
    }
    // The ticks have ended: the queue holds all remaining entries.
    ports.say(FromNetwork::End(Box::new(summary.clone())));
    let mut text = sentence(summary.end).to_owned();
    if let Some(breach) = breach {
        text.push_str(&format!(" Cause, {breach}."));
    }
    match recorder() {
        Some(Report {
            file_name,
            error: None,
        }) => {
            summary.recording = file_name;
            summary.complete = summary.rows_dropped == 0
                && !matches!(summary.end, EndReason::Simulation | EndReason::Diverged);
            if summary.rows_dropped > 0 {
                text.push_str(" The recording has lost rows and cannot be graded.");
            }
        }
        Some(Report {
            file_name,
            error: Some(error),
        }) => {
            summary.end = EndReason::Recording;
            text = format!("The recording {file_name} could not be written: {error}.");
            summary.recording = file_name;
        }
        None => {
            summary.end = EndReason::Recording;
            text = "The recorder ended unexpectedly; the recording has no end.".to_owned();
        }
    }
    if !summary.complete {
        tracing::error!("{text}");
    }
    (summary, text)
}

/// Sentence about the end of a session, for its goodbye.
fn sentence(end: EndReason) -> &'static str {
    match end {
        EndReason::Stopped => "The session was stopped.",
        EndReason::TimeUp => "The session has reached its time limit.",
        EndReason::Shutdown => "The server is shutting down.",
        EndReason::ConnectionLost => "The connection was lost.",
        EndReason::Protocol => {
            "The client violated the protocol; install the same release of client and server."
        }
        EndReason::Recording => "The recording could not be written.",
        EndReason::Simulation => "The simulation ended unexpectedly.",
        EndReason::Instructor => "The instructor ended the session.",
        EndReason::Diverged => {
            "The ticks at the hand are not those of the station; the session cannot be graded."
        }
    }
}
