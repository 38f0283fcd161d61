//! Summary of a session: sent with the goodbye, returned by the server, printed as JSON.

use serde::{Deserialize, Serialize};

use crate::newest::ArrivalCounts;

/// Percentiles of a time, microseconds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Percentiles {
    /// Median.
    pub p50: f64,
    /// 99th percentile.
    pub p99: f64,
    /// 99.9th percentile.
    pub p999: f64,
    /// Maximum.
    pub max: f64,
}

/// Reason for the end of a session.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum EndReason {
    /// The client stopped the session.
    Stopped,
    /// The time limit of the session, or of the wait for its start, expired.
    TimeUp,
    /// The server was shut down.
    Shutdown,
    /// The client sent nothing within the timeout, or its connection was lost and it did not return in time.
    ConnectionLost,
    /// The client violated the protocol.
    Protocol,
    /// The recording could not be written.
    Recording,
    /// The simulation could not run.
    Simulation,
    /// An instructor ended the session.
    Instructor,
    /// The ticks at the hand and those of the server differ, or the ticks at the hand broke a rule. The recording
    /// cannot be graded.
    Diverged,
}

/// Statistics of a session. If the simulation never started, all numbers are zero.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SessionSummary {
    /// Name of the station.
    pub station: String,
    /// Reason for the end of the session.
    pub end: EndReason,
    /// File name of the recording, without folder; empty without a recording.
    pub recording: String,
    /// Whether the recording is complete: no row dropped, no error. Only a complete recording can be graded.
    pub complete: bool,
    /// Number of gaps in which the student was gone.
    pub gaps: u32,
    /// Number of ticks in gaps.
    pub gap_ticks: u64,
    /// Number of ticks computed.
    pub ticks: u64,
    /// Number of grid points missed and skipped.
    pub skipped: u64,
    /// Number of ticks that ended after their period, plus the skipped grid points.
    pub deadline_misses: u64,
    /// CPU time of the simulation thread per tick.
    pub tick_us: Percentiles,
    /// Wall time per tick.
    pub tick_wall_us: Percentiles,
    /// Delay from a grid point to the beginning of its tick.
    pub wake_us: Percentiles,
    /// Largest penetration after a converged tick, micrometres.
    pub max_residual_um: f64,
    /// Number of tool-ticks that reached the limit of substeps.
    ///
    /// Ticks before the first convergence of a newly present tool are not counted.
    pub exhausted: u64,
    /// Number of tool-ticks with a stale pose.
    pub stale: u64,
    /// Largest force sent to a hand, newtons.
    pub max_force_n: f64,
    /// Counts of arrived pose datagrams.
    pub poses: ArrivalCounts,
    /// Number of datagrams of another session epoch, for example stale packets after a resume.
    pub foreign: u64,
    /// Number of datagrams that did not decode.
    pub malformed: u64,
    /// Number of client events dropped: the recorder's queue was full, or the events' byte limit was reached.
    pub edges_dropped: u64,
    /// Number of rows dropped because the recorder's queue was full.
    pub rows_dropped: u64,
    /// Number of state snapshots dropped, without a free buffer or with the recorder's queue full.
    pub snapshots_dropped: u64,
}

impl SessionSummary {
    /// Creates the summary of a session without ticks.
    pub fn empty(end: EndReason) -> Self {
        Self {
            station: String::new(),
            end,
            recording: String::new(),
            complete: false,
            gaps: 0,
            gap_ticks: 0,
            ticks: 0,
            skipped: 0,
            deadline_misses: 0,
            tick_us: Percentiles::default(),
            tick_wall_us: Percentiles::default(),
            wake_us: Percentiles::default(),
            max_residual_um: 0.0,
            exhausted: 0,
            stale: 0,
            max_force_n: 0.0,
            poses: ArrivalCounts::default(),
            foreign: 0,
            malformed: 0,
            edges_dropped: 0,
            rows_dropped: 0,
            snapshots_dropped: 0,
        }
    }
}
