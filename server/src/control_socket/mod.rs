//! Control of a running server from the same machine: a unix socket in the state folder.
//!
//! A connection carries one JSON object a line, a [`Request`] and then its [`Reply`], any number of times. The socket
//! has mode 0600 in a folder of mode 0700, so only the user of the server and the administrator can connect. A line is
//! at most [`MOST_LINE`] bytes long, and a connection without a whole line for [`PATIENCE`] is closed.

pub mod client;
pub mod place;
pub mod server;

pub use client::{AskError, ask};
pub use place::{Claimed, claim};
pub use server::{Listening, serve};

use std::time::Duration;

use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::plan::{PlanChange, PlanError, StationPlan};

/// Longest line, bytes, with its line feed.
pub const MOST_LINE: usize = 64 * 1024;
/// Longest reply that a client reads, bytes: the plans of 64 stations with their histories.
pub const MOST_REPLY: usize = 16 << 20;
/// Longest wait for a line, and for a reader of a reply.
pub const PATIENCE: Duration = Duration::from_secs(5);

/// Request to a running server.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "do", rename_all = "snake_case", deny_unknown_fields)]
pub enum Request {
    /// Plans of all stations. The reply is a list of [`StationPlan`].
    Plans {},
    /// Change of a plan. The reply is the new [`StationPlan`].
    SetPlan {
        /// Name of the station.
        station: String,
        /// Parts to change.
        change: PlanChange,
    },
    /// Return to the plan of the file. The reply is the new [`StationPlan`].
    ResetPlan {
        /// Name of the station.
        station: String,
    },
    /// State of the server, an object that the server defines.
    Status {},
    /// Pause, resumption or force limit of a station, as by an instructor.
    Command {
        /// Name of the station.
        station: String,
        /// Command.
        command: StationCommand,
    },
}

/// Command of an instructor to a station.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum StationCommand {
    /// Forces ramp to zero and stay zero.
    Pause,
    /// End of the instructor's pause.
    Resume,
    /// Largest force, newtons; 0 lifts the limit.
    ForceLimit(f32),
}

/// Answer to a request: the result, or one sentence.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Reply {
    /// Result of the request.
    Ok(Value),
    /// Reason why the request has no result.
    Error(String),
}

/// Server as seen by the socket. Calls come from threads of the socket, several at a time, and should not block long.
pub trait Control: Send + Sync {
    /// Plans of all stations, in the order of the file.
    fn plans(&self) -> Vec<StationPlan>;

    /// Changes the plan of a station; `by` names the author.
    ///
    /// # Errors
    /// The reasons of [`crate::plan::PlanBook::set`].
    fn set_plan(
        &self,
        station: &str,
        change: &PlanChange,
        by: &str,
    ) -> Result<StationPlan, PlanError>;

    /// Returns a station to the plan of the file; `by` names the author.
    ///
    /// # Errors
    /// The reasons of [`crate::plan::PlanBook::reset`].
    fn reset_plan(&self, station: &str, by: &str) -> Result<StationPlan, PlanError>;

    /// State of the server as a JSON object, without secrets.
    fn status(&self) -> Value;

    /// Gives a command to a station; `by` names the author. The result is the state of the station as a JSON object.
    ///
    /// # Errors
    /// The station is unknown, or does not take the command: one sentence.
    fn command(&self, station: &str, command: StationCommand, by: &str) -> Result<Value, String>;
}

impl Request {
    /// Request of a line.
    ///
    /// # Errors
    /// The line is no request: one sentence.
    pub fn parse(line: &[u8]) -> Result<Self, String> {
        let request: Self = serde_json::from_slice(line)
            .map_err(|error| format!("the line is no request: {error}"))?;
        if let Self::Command {
            command: StationCommand::ForceLimit(newtons),
            ..
        } = request
            && !(newtons.is_finite() && newtons >= 0.0)
        {
            return Err(format!(
                "force_limit is {newtons}, expected 0 or a positive force in newtons"
            ));
        }
        Ok(request)
    }

    /// Answer of `control` to this request from `by`.
    pub fn answer(&self, control: &dyn Control, by: &str) -> Reply {
        let plan = |plan: Result<StationPlan, PlanError>| match plan {
            Ok(plan) => Reply::of(&plan),
            Err(error) => Reply::Error(error.to_string()),
        };
        match self {
            Self::Plans {} => Reply::of(&control.plans()),
            Self::SetPlan { station, change } => plan(control.set_plan(station, change, by)),
            Self::ResetPlan { station } => plan(control.reset_plan(station, by)),
            Self::Status {} => Reply::Ok(control.status()),
            Self::Command { station, command } => match control.command(station, *command, by) {
                Ok(state) => Reply::Ok(state),
                Err(why) => Reply::Error(why),
            },
        }
    }
}

impl Reply {
    fn of<T: Serialize>(value: &T) -> Self {
        match serde_json::to_value(value) {
            Ok(value) => Self::Ok(value),
            Err(error) => Self::Error(format!("the result cannot be written as JSON: {error}")),
        }
    }
}

#[cfg(test)]
mod tests;
