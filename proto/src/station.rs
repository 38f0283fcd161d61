//! Status of a station for instructors, five times a second.

use serde::{Deserialize, Serialize};

use crate::TOOLS;

/// Phase of a station.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Phase {
    /// No session.
    #[default]
    Free,
    /// A student is attached and has not started the session.
    Ready,
    /// A session runs with its student attached.
    Running,
    /// A session runs without its student, and waits for the student's return.
    Waiting,
    /// The session's recording is being finished.
    Ending,
}

/// State of a tool in a session.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ToolStatus {
    /// Whether a hand holds the tool.
    pub present: bool,
    /// Force sent to the hand, newtons.
    pub force_n: f32,
    /// Largest force sent since the previous status, newtons.
    pub peak_force_n: f32,
    /// FDI number of the tooth whose pocket holds the tip; 0 outside of pockets.
    pub tooth: u8,
    /// Name of the site that is probed, such as `mesiobuccal`; empty outside of pockets.
    pub site: String,
    /// Probing depth at the site, millimetres; 0 outside of pockets.
    pub depth_mm: f32,
    /// Force on the pocket's floor, newtons; 0 outside of pockets.
    pub floor_force_n: f32,
    /// Depth of the site by the scene, millimetres; 0 outside of pockets. A student never gets this value.
    pub true_depth_mm: f32,
    /// Zone of the floor's force: 0 light, 1 too heavy, 2 trauma, 3 damage.
    pub zone: u8,
    /// Heaviest zone since the previous status.
    pub peak_zone: u8,
    /// Age of the newest pose, milliseconds; at most 65,535.
    pub pose_age_ms: u16,
    /// Status bits of [`crate::status`].
    pub status: u16,
    /// Stage of a haptic device, as recordings name it, such as `waiting`, `live` or `tripped_driver`; empty without
    /// such a device.
    pub device_stage: String,
    /// Number of the device's periods in which its continuous force, a model of the warm motors, limited the force.
    pub device_limited: u64,
}

/// Status of a station.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct StationStatus {
    /// Name of the station.
    pub station: String,
    /// Phase of the station.
    pub phase: Phase,
    /// Opaque learner id; empty for an anonymous learner or without a session.
    pub learner: String,
    /// Exercise of the plan.
    pub exercise: String,
    /// Purpose of the session: practice, assessment or exam.
    pub mode: String,
    /// Revision of the plan, from 1 on.
    pub plan_revision: u32,
    /// File name of the running recording; empty without one.
    pub recording: String,
    /// Newest tick of the session.
    pub tick: u64,
    /// Ticks per second.
    pub rate_hz: u16,
    /// Session time without gaps, milliseconds.
    pub elapsed_ms: u64,
    /// Whether the station's side has paused.
    pub paused: bool,
    /// Whether the student has paused.
    pub paused_by_student: bool,
    /// Force limit of the station's side, newtons; 0 for the scene's limit.
    pub force_limit_n: f32,
    /// Id of the token that set pause or limit last; empty before the first.
    pub set_by: String,
    /// Time without the student in the present gap, milliseconds; 0 while the student is attached.
    pub gap_ms: u32,
    /// Time by which the recorded ticks are behind those at the hand, milliseconds; `None` if the server ticks.
    pub behind_ms: Option<u32>,
    /// Number of gaps so far.
    pub gaps: u32,
    /// Missed deadlines: late and skipped ticks.
    pub deadline_misses: u64,
    /// Tool-ticks that reached the limit of substeps or of work.
    pub exhausted: u64,
    /// Rows that the recorder's queue dropped.
    pub rows_dropped: u64,
    /// Status and display frames that a full queue dropped.
    pub frames_dropped: u64,
    /// CPU time of a tick, 99th percentile of the last second, microseconds.
    pub tick_p99_us: f32,
    /// Free space for recordings, mebibytes: of the disk, or of the quota of their folder where that is less.
    pub disk_free_mib: u64,
    /// Pose datagrams that the network lost.
    pub poses_lost: u64,
    /// Tools, in the order of the slots.
    pub tools: [ToolStatus; TOOLS],
}

/// Event of a session for instructors, as the recording holds it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StationEvent {
    /// Name of the station.
    pub station: String,
    /// Tick of the event.
    pub tick: u64,
    /// Text of the event: kind, tick and JSON, as in the recording's log.
    pub text: String,
}
