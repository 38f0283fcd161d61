//! A session without threads and without the system's clocks, for a simulator: its owner steps the ticks and the
//! recorder, and carries the datagrams.
//!
//! The loops, hand-overs and the end are those of a running session. Ticks at the hand have no stepped session. Not
//! part of the crate's interface for stations.

use std::path::Path;
use std::sync::{Arc, Mutex};
use std::time::Duration;

use sulcus_core::{TickInput, TickOutput};
use sulcus_link::clock::Clock;
use sulcus_proto::control::EndReason;
use sulcus_proto::{PoseDatagram, SessionSummary};
use sulcus_sessions::ViewersPolicy;
use tokio::sync::broadcast;

use crate::outlets::feed::FeedPublisher;
use crate::outlets::opening::Opening;
use crate::outlets::recording::{RecorderLoop, Step};
use crate::session::ending;
use crate::session::handoff::Flags;
use crate::session::levels::Levels;
pub use crate::session::levels::{InForce, Level, Taken};
use crate::session::loops::{Begin, Loops, Ticks};
use crate::session::metrics::Metrics;
use crate::session::ports::Ports;
use crate::session::precedence::Places;
use crate::session::simulation::Ticker;
use crate::station::config::SessionPlan;

mod network;

/// Name of the station in recordings and summaries.
const STATION: &str = "station";

/// Session whose loops its owner steps.
pub struct SteppedSession {
    ports: Arc<Ports>,
    ticker: Ticker,
    recorder: RecorderLoop,
    levels: Levels,
    clock: Clock,
    plan: SessionPlan,
}

/// A tick of a stepped session.
#[derive(Clone, Debug)]
pub struct SteppedTick {
    /// Input, as recorded.
    pub input: TickInput,
    /// Output, with the hash of the state after the tick.
    pub output: TickOutput,
    /// Newest pose that the tick had, and its arrival, nanoseconds of the monotonic clock; `None` before the first pose
    /// and while the student is gone.
    pub used: Option<(PoseDatagram, u64)>,
}

/// Result of a stepped session.
#[derive(Debug)]
pub struct SteppedEnd {
    /// Summary, as the student receives it; without gaps, which a station counts.
    pub summary: SessionSummary,
    /// Text of the goodbye.
    pub text: String,
    /// Name of the recording's file in its folder.
    pub file_name: String,
    /// First failure of the recorder, one sentence; `None`: the recording is signed and whole.
    pub error: Option<String>,
}

impl SteppedSession {
    /// Session of `plan` that begins at the present time of `clock`, with the attach epoch `epoch` of its first
    /// connection and levels without pause and limit. Its recording is a new file in `folder`, which must exist; `key`
    /// is the file of the key that signs it, created if missing.
    ///
    /// # Errors
    /// The plan is invalid, or the recording cannot be written: one sentence.
    pub fn begin(
        plan: SessionPlan,
        folder: &Path,
        key: &Path,
        epoch: u32,
        clock: Clock,
    ) -> Result<Self, String> {
        plan.validate().map_err(|error| error.to_string())?;
        let levels = Levels::default().of_new_session(plan.force_limit_n);
        let asked = Opening {
            learner: plan.learner.clone(),
            plan: Arc::new(plan.clone()),
            softer: Vec::new(),
            folder: folder.to_owned(),
            viewers: ViewersPolicy::default(),
            key: Some(key.to_owned()),
            station: STATION.to_owned(),
            client: "client of a simulator".to_owned(),
            devices: Vec::new(),
            epoch,
            predecessor: None,
            live: Arc::default(),
            events: broadcast::channel(1).0,
            feed: Arc::new(Mutex::new(FeedPublisher::new().0)),
        };
        let begin = Begin {
            epoch,
            levels: levels.clone(),
            real_time: false,
            places: Arc::new(Places::of(1)),
            core: None,
            at_hand: false,
        };
        let loops = Loops::open(asked, begin, clock.clone()).map_err(|(_, text)| text)?;
        let Ticks::Server(ticks) = loops.ticks else {
            return Err("the ticks run at the hand".to_owned());
        };
        let (simulation, rings) = *ticks;
        let mut ticker = Ticker::new(simulation, rings, Metrics::new());
        ticker.begin(false);
        Ok(Self {
            ports: loops.ports,
            ticker,
            recorder: loops.recorder,
            levels,
            clock,
            plan,
        })
    }

    /// Time of the next tick, nanoseconds of the monotonic clock.
    pub fn next_tick_ns(&self) -> u64 {
        self.ticker.next_ns()
    }

    /// Runs the tick that is due now, with all missed grid points as skipped. `None`: none is due.
    pub fn tick(&mut self) -> Option<SteppedTick> {
        if self.clock.monotonic_ns() < self.next_tick_ns() {
            return None;
        }
        let mut ticked = None;
        self.ticker.step_seen(|input, output, pose| {
            ticked = Some(SteppedTick {
                input: *input,
                output: *output,
                used: pose.map(|pose| (pose.datagram, pose.arrived_ns)),
            });
        });
        ticked
    }

    /// Steps the recorder until it would wait, and returns its wait; `None`: the recording is over, which no session
    /// before its [`SteppedSession::finish`] is.
    pub fn record(&mut self) -> Option<Duration> {
        loop {
            match self.recorder.step() {
                Step::Again => {}
                Step::Wait(pause) => return Some(pause),
                Step::Over(_) => return None,
            }
        }
    }

    /// Number of ticks, and of shapes and snapshots between them, that wait for the recorder.
    pub fn waiting(&self) -> usize {
        self.recorder.waiting()
    }

    /// Number of the newest tick; 0 before the first one.
    pub fn tick_number(&self) -> u64 {
        self.ports.tick()
    }

    /// Hash of the state after the newest tick.
    pub fn state_hash(&self) -> u64 {
        self.ticker.state().hash
    }

    /// Whether a write of the recorder has failed, after which a station ends the session.
    pub fn record_failed(&self) -> bool {
        Flags::is_up(&self.ports.flags().record_failed)
    }

    /// Ends the ticks, finishes and signs the recording.
    pub fn finish(mut self, reason: EndReason) -> SteppedEnd {
        // A full channel would wait for a recorder that nobody steps.
        self.record();
        let summary = SessionSummary {
            station: STATION.to_owned(),
            ..SessionSummary::empty(reason)
        };
        let mut error = None;
        let ticks = || Some(self.ticker.into_metrics());
        let recorder = || {
            let report = self.recorder.run(|_| {});
            error.clone_from(&report.error);
            Some(report)
        };
        let (summary, text) = ending::finish(&self.ports, summary, ticks, recorder);
        SteppedEnd {
            file_name: summary.recording.clone(),
            summary,
            text,
            error,
        }
    }
}

#[cfg(test)]
mod tests;
