//! Faults that a test commands at run time.

use serde::{Deserialize, Serialize};

use crate::options::Omit;
use crate::version::Version;

/// A fault of the service or of a device, or the end of one.
///
/// Faults of replies apply to the next replies of any connection, counted down by one for each reply.
/// The inventory of a new connection counts as a reply.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Fault {
    /// Every simulation connection breaks without a close message.
    DropConnections,
    /// Every connection of the channel of events breaks without a close message.
    DropEvents,
    /// Every simulation connection gets a close message instead of its next reply.
    CloseConnections,
    /// The service handles no message for this time, in ms; the arms and their watchdogs go on.
    Stall {
        /// Length in ms.
        ms: u64,
    },
    /// No new connection on either port while true; connections that stand are kept.
    RefuseConnections {
        /// True to refuse, false to listen again on the same ports.
        on: bool,
    },
    /// Replies are text that is no JSON.
    Malformed {
        /// Number of replies.
        replies: u32,
    },
    /// Replies end in their middle.
    Truncated {
        /// Number of replies.
        replies: u32,
    },
    /// A number of the pose of one device is no sane number.
    BadNumber {
        /// Id of the device.
        device: String,
        /// Vector that the number belongs to; its x is hit.
        place: Place,
        /// What stands in place of the number.
        value: BadNumber,
        /// Number of replies.
        replies: u32,
    },
    /// A part is left out of replies.
    Omit {
        /// Part.
        what: Omit,
        /// Number of replies.
        replies: u32,
    },
    /// The reply is sent twice for one message.
    TwiceReply {
        /// Number of replies.
        replies: u32,
    },
    /// Every device stands twice in its array, with the same state.
    TwiceDevice {
        /// Number of replies.
        replies: u32,
    },
    /// Messages get no reply.
    Silence {
        /// Number of messages.
        messages: u32,
    },
    /// Requests over HTTP get status 500.
    HttpError {
        /// Number of requests.
        requests: u32,
    },
    /// Event `device-safety-triggered`; the brake takes the force of the arm until it is released.
    Safety {
        /// Id of the arm.
        device: String,
        /// Cause.
        cause: SafetyCause,
    },
    /// Any other event, for example `device-battery-low`.
    Event {
        /// Name.
        name: String,
        /// Level, `info` to `panic`.
        level: String,
        /// Id of the device.
        device: String,
    },
    /// The device is gone from every reply; event `device-disconnected`.
    Disconnect {
        /// Id of the device.
        device: String,
    },
    /// The device is back, with its config in the next reply; event `device-connected`.
    Reconnect {
        /// Id of the device.
        device: String,
    },
    /// The grip sleeps: `awake` is false and its state stands still; event `device-sleep`.
    Sleep {
        /// Id of the grip.
        device: String,
    },
    /// The grip wakes.
    Wake {
        /// Id of the grip.
        device: String,
    },
    /// The arm is not calibrated; event `device-calibration-failed`. Its forces still act.
    CalibrationLost {
        /// Id of the arm.
        device: String,
    },
    /// The arm is calibrated again.
    Calibrated {
        /// Id of the arm.
        device: String,
    },
    /// The arm has no power supply and displays no force.
    PowerOff {
        /// Id of the arm.
        device: String,
    },
    /// The arm has its power supply again.
    PowerOn {
        /// Id of the arm.
        device: String,
    },
    /// Factor on every force.
    ForceScale {
        /// Factor.
        value: f64,
    },
    /// Version of the service, from now on; connections are kept.
    Version {
        /// Version.
        version: Version,
    },
}

/// Vector of a state that a bad number stands in.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Place {
    /// `cursor_position` of an arm.
    Position,
    /// `cursor_velocity` of an arm.
    Velocity,
    /// `orientation` of a grip.
    Orientation,
}

/// What stands in place of a number.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum BadNumber {
    /// Nothing: the field is absent.
    Missing,
    /// `null`.
    Null,
    /// A text.
    Text,
    /// `NaN` without quotes, which is no JSON.
    NanWord,
    /// `1e400`, beyond the greatest number of 64 bits.
    Overflow,
    /// A number of valid form.
    Absurd(f64),
}

impl BadNumber {
    /// JSON text of the number; none where the field is absent.
    pub(crate) fn text(self) -> Option<String> {
        match self {
            Self::Missing => None,
            Self::Null => Some("null".into()),
            Self::Text => Some("\"0.1\"".into()),
            Self::NanWord => Some("NaN".into()),
            Self::Overflow => Some("1e400".into()),
            Self::Absurd(value) => Some(format!("{value:e}")),
        }
    }
}

/// Cause of a safety event.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SafetyCause {
    /// The brake holds: no force.
    EbrakeTriggered,
    /// The brake is released.
    EbrakeReleased,
    /// The stage of the detection of a free fall or fault changed.
    FodStageChanged,
    /// A motor stalls.
    StallDetected,
    /// The force was held at the ceiling of stability.
    StabilityCeiling,
}

impl SafetyCause {
    /// Name in the event.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::EbrakeTriggered => "ebrake_triggered",
            Self::EbrakeReleased => "ebrake_released",
            Self::FodStageChanged => "fod_stage_changed",
            Self::StallDetected => "stall_detected",
            Self::StabilityCeiling => "stability_ceiling",
        }
    }
}
