//! Messages of a session to its test, one JSON value in a line, and the settings that both know.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};
use sulcus_core::MAX_TOOLS;
use sulcus_proto::Percentiles;

/// Mark before a message.
pub const MARK: &str = "@said ";
/// Devices by the slots of their tools: probe, mirror.
pub const DEVICES: [&str; MAX_TOOLS] = ["forcedimension:1234", "openhaptics:L1"];
/// Seat of the person on the dental clock, hours.
pub const SEAT_HOUR: f64 = 9.0;

/// Message of the session to its test.
#[derive(Serialize, Deserialize)]
pub enum Said {
    /// Ways of both tools down to the first contact, metres.
    Placed([f64; 2]),
    /// Both devices pass the whole force.
    Live,
    /// The session is over.
    Performed(Performed),
}

/// Measures of an ended session.
#[derive(Serialize, Deserialize)]
pub struct Performed {
    pub recording: PathBuf,
    pub pose_age_us: [Percentiles; MAX_TOOLS],
    pub trips: u64,
    /// Number of watched threads of devices, and of their allocations while both devices passed the whole force.
    pub threads: usize,
    pub allocations: u64,
    /// Time by the clock of the log, and tick of the newest wrench, in each period of the loop.
    pub heard: Vec<(u64, u64)>,
}
