//! Requests of a test to the running service; one JSON text a line in the program.

use std::fmt;
use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use crate::Vector;
use crate::device::{ArmStatus, Buttons, Motion, Turn};
use crate::fault::Fault;

/// A request of the test to the running service.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Request {
    /// A fault begins or ends.
    Fault(Fault),
    /// Motion of the hand at an arm; its time starts now.
    Hand {
        /// Id of the arm.
        device: String,
        /// Motion.
        motion: Motion,
    },
    /// Rotation of a grip; its time starts now.
    Turn {
        /// Id of the grip.
        device: String,
        /// Rotation.
        turn: Turn,
    },
    /// Buttons of a grip.
    Buttons {
        /// Id of the grip.
        device: String,
        /// Buttons.
        buttons: Buttons,
    },
    /// Status of an arm.
    Status {
        /// Id of the arm.
        device: String,
        /// Status.
        status: ArmStatus,
    },
    /// Force of a second source at an arm, in N; it acts with or without a client.
    SecondSource {
        /// Id of the arm.
        device: String,
        /// Force in N.
        force: Vector,
    },
    /// Time of the clock of the log; the answer is `ok` and the time in ns.
    Now,
    /// End of the program.
    Quit,
}

/// A request that the service could not carry out.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum RequestError {
    /// No arm or grip has this id.
    UnknownDevice(String),
    /// The program is gone or answered with an error.
    Program(String),
}

impl fmt::Display for RequestError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::UnknownDevice(id) => write!(f, "no device of the wanted type has the id '{id}'"),
            Self::Program(text) => write!(f, "{text}"),
        }
    }
}

impl std::error::Error for RequestError {}

/// First line of the program: `ready` and this as JSON.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Ready {
    /// Port of the simulation channel and of HTTP.
    pub port: u16,
    /// Port of the channel of events.
    pub events_port: u16,
    /// File of the log.
    pub log: PathBuf,
}
