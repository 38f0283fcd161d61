//! Options of the service at its start.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use crate::device::{ArmOptions, GripOptions, Handedness};
use crate::version::Version;

/// Options of the service at its start.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Options {
    /// Version that `GET /version` tells; it decides the name of the field of a force.
    pub version: Version,
    /// Arms.
    pub arms: Vec<ArmOptions>,
    /// Grips.
    pub grips: Vec<GripOptions>,
    /// Names of arrays of a type that no client knows; each holds one device.
    pub unknown_arrays: Vec<String>,
    /// Time without a command after which an arm goes idle, in ms.
    pub watchdog_ms: f64,
    /// What later replies hold.
    pub replies: Replies,
    /// Factor on every force, as in `/settings/devices/force_scale`.
    pub force_scale: f64,
    /// Greatest force that an arm displays, in N; the service shortens a greater force.
    pub peak_force_n: f64,
    /// Period of the event `system-rate-report`, in ms; none where absent.
    pub rate_report_ms: Option<u64>,
    /// True where a setting over HTTP is a bare value; else it is an object with the name of the setting.
    pub bare_settings: bool,
    /// Port of the simulation channel; a free one where absent.
    pub port: Option<u16>,
    /// Port of the channel of events; a free one where absent.
    pub events_port: Option<u16>,
    /// True: the threads of the service ask for the real-time class, as if the service had a computer of its own.
    pub realtime: bool,
    /// File that the log is appended to; a file in a temporary folder where absent.
    pub log: Option<PathBuf>,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            version: Version::V3_5,
            arms: vec![ArmOptions::new("049D", Handedness::Right)],
            grips: vec![GripOptions::wireless("61576")],
            unknown_arrays: Vec::new(),
            watchdog_ms: 20.0,
            replies: Replies::default(),
            force_scale: 1.0,
            peak_force_n: 10.0,
            rate_report_ms: None,
            bare_settings: false,
            port: None,
            events_port: None,
            realtime: false,
            log: None,
        }
    }
}

impl Options {
    /// Two arms, right `049D` and left `04A1`, with the wireless grips `61576` and `61577`.
    #[must_use]
    pub fn pair() -> Self {
        Self {
            arms: vec![
                ArmOptions::new("049D", Handedness::Right),
                ArmOptions::new("04A1", Handedness::Left),
            ],
            grips: vec![
                GripOptions::wireless("61576"),
                GripOptions::wireless("61577"),
            ],
            ..Self::default()
        }
    }
}

/// What the replies after the inventory hold.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Replies {
    /// Every how many replies the config is told; 0 for never.
    pub config_every: u64,
    /// Every how many replies the status is told; 0 for never.
    pub status_every: u64,
    /// Parts left out of certain replies.
    pub omissions: Vec<Omission>,
}

impl Default for Replies {
    fn default() -> Self {
        Self {
            config_every: 0,
            status_every: 1,
            omissions: Vec::new(),
        }
    }
}

/// A part left out of certain replies of every connection.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Omission {
    /// Part.
    pub what: Omit,
    /// Number of the first reply without the part; the inventory has number 0.
    pub first: u64,
    /// Number of the last reply without the part.
    pub last: u64,
}

/// A part of a reply that is left out.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Omit {
    /// Config of every device.
    Config,
    /// State of every device.
    State,
    /// Status of every device.
    Status,
    /// Whole array of this name, for example `inverse3`.
    Array(String),
    /// Every field of this name, for example `cursor_velocity`.
    Field(String),
    /// One device by its id, in every array.
    Device(String),
}
