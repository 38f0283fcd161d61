//! Observations of one station and its student in virtual time, for the invariants.

use sulcus_core::{MAX_TOOLS, Wrench};
use sulcus_proto::control::Command;

/// Facts of a session that hold for its whole length.
#[derive(Clone, Debug, PartialEq)]
pub struct Facts {
    /// Number of tools in the scene.
    pub tools: usize,
    /// Period of the ticks and of the device's loop, nanoseconds.
    pub tick_ns: u64,
    /// Largest force on a hand, newtons.
    pub max_force_n: f64,
    /// Largest torque on a hand, newton metres.
    pub max_torque_nm: f64,
    /// Largest change of the force, newtons per millisecond.
    pub max_force_step_n: f64,
    /// Largest change of the torque, newton metres per millisecond.
    pub max_torque_step_nm: f64,
    /// Force limit of the plan, newtons; 0 for none.
    pub plan_limit_n: f64,
    /// Number of entries that the recorder's queue holds.
    pub queue_rows: usize,
}

/// Side that gives a command.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// Station: an instructor or the console.
    Station,
    /// Student.
    Student,
}

/// A pose as a tick used it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Used {
    /// Epoch in which the pose was sent.
    pub epoch: u32,
    /// Number of the pose in the order of sending, from 0.
    pub number: u64,
    /// Virtual time at which the hand had the pose, nanoseconds.
    pub measured_ns: u64,
    /// Virtual time of arrival at the server, nanoseconds.
    pub arrived_ns: u64,
}

/// A tick of the server.
#[derive(Clone, Debug, PartialEq)]
pub struct Tick {
    /// Number of the tick, from 1. Skipped grid points count.
    pub tick: u64,
    /// Number of grid points that were left out before the tick.
    pub skipped: u32,
    /// Whether each tool is present in the input.
    pub present: [bool; MAX_TOOLS],
    /// Whether each tool's pose is stale in the input.
    pub stale: [bool; MAX_TOOLS],
    /// Whether the input of the tick has a pause.
    pub paused: bool,
    /// Force limit of the input, newtons; 0: the scene's limit alone.
    pub force_limit_n: f64,
    /// Newest pose that the tick had; `None` before the first one of a connection.
    pub used: Option<Used>,
    /// Wrench for each hand, after all limits of the server, world axes.
    pub sent: [Wrench; MAX_TOOLS],
}

/// A pass of the device's loop: the wrench that a hand feels from now on.
#[derive(Clone, Debug, PartialEq)]
pub struct Pass {
    /// Displayed wrench of each hand, world axes.
    pub displayed: [Wrench; MAX_TOOLS],
    /// Newest wrench of the server, if any.
    pub newest: Option<Newest>,
    /// Whether a passivity controller damped a hand or reduced a wrench in this pass.
    pub braked: bool,
    /// Number of periods since the previous pass that the loop has overslept.
    pub overslept: u64,
}

/// Newest wrench of the server at a device.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Newest {
    /// Epoch of the datagram.
    pub epoch: u32,
    /// Tick of the wrench.
    pub tick: u64,
    /// Virtual time of arrival, nanoseconds.
    pub arrived_ns: u64,
    /// Force limit that the datagram names, newtons; 0 for none.
    pub force_limit_n: f64,
    /// Whether the datagram names a pause of either side.
    pub paused: bool,
}

/// Observation of a station.
#[derive(Clone, Debug, PartialEq)]
pub enum Seen {
    /// Begin of a connection's epoch at the server. The first one begins the session.
    Epoch(u32),
    /// Lost connection at the server: all tools are taken away.
    Gone,
    /// Command that the server has accepted.
    Ordered(Side, Command),
    /// A tick.
    Tick(Box<Tick>),
    /// Length of the recorder's queue.
    Queues {
        /// Entries that wait for the recorder.
        recorder: usize,
    },
    /// A pass of the device's loop.
    Pass(Box<Pass>),
    /// End of the session at the server.
    Finished {
        /// Number of ticks.
        ticks: u64,
        /// Number of skipped grid points.
        skipped: u64,
        /// Number of rows that the recorder's full queue dropped.
        rows_dropped: u64,
        /// Failure of the recorder.
        error: Option<String>,
    },
    /// Replay of the recording.
    Replayed {
        /// Number of rows in the recording.
        rows: u64,
        /// Whether each replayed tick is equal to its row, bit for bit.
        is_equal: bool,
        /// Whether the recording is signed, whole, and closed by an end record.
        is_whole: bool,
        /// Number of gaps of the connection that the recording names.
        gaps: u64,
    },
}
