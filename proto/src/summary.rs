//! What a session came to: sent with the goodbye, returned by the server, printed as JSON.

use serde::{Deserialize, Serialize};

use crate::control::EndReason;
use crate::newest::ArrivalCounts;

/// Percentiles of a time, microseconds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Percentiles {
    /// Median.
    pub p50: f64,
    /// 99 %.
    pub p99: f64,
    /// 99.9 %.
    pub p999: f64,
    /// Largest.
    pub max: f64,
}

/// One session in numbers. All zero but for the reason where the simulation never started.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SessionSummary {
    /// Why it ended.
    pub end: EndReason,
    /// File name of the recording (no folder); empty if there is none.
    pub recording: String,
    /// Whether the recording is complete: no row dropped, no error. Only then is it gradable.
    pub complete: bool,
    /// Ticks computed.
    pub ticks: u64,
    /// Grid ticks that were missed and skipped.
    pub skipped: u64,
    /// Ticks that ended after their period, plus the skipped ones.
    pub deadline_misses: u64,
    /// Thread CPU time of a tick.
    pub tick_us: Percentiles,
    /// Wall time of a tick.
    pub tick_wall_us: Percentiles,
    /// How late after its grid point a tick began.
    pub wake_us: Percentiles,
    /// Deepest penetration left by a converged tick, micrometres.
    pub max_residual_um: f64,
    /// Tool-ticks whose substeps ran out.
    pub exhausted: u64,
    /// Tool-ticks whose pose was stale.
    pub stale: u64,
    /// Largest force sent to a hand, newtons.
    pub max_force_n: f64,
    /// Poses that arrived.
    pub poses: ArrivalCounts,
    /// Datagrams of another session epoch (stale packets after a resume).
    pub foreign: u64,
    /// Datagrams that did not decode.
    pub malformed: u64,
    /// Events of the client that found no room.
    pub edges_dropped: u64,
    /// Rows that found the recorder's queue full.
    pub rows_dropped: u64,
    /// State snapshots that found no free buffer.
    pub snapshots_dropped: u64,
}

impl SessionSummary {
    /// A session without a single tick.
    pub fn empty(end: EndReason) -> Self {
        Self {
            end,
            recording: String::new(),
            complete: false,
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
