//! Source of plans while a server runs.

use std::sync::Arc;

use serde_json::Value;

use crate::station::config::SessionPlan;
use crate::station::door::Door;

/// Plan that an instructor sets for the next session of a station.
#[derive(Clone, Debug)]
pub struct NewPlan {
    /// Name of the station.
    pub station: String,
    /// Parts of the plan that change, as TOML.
    pub text: String,
    /// Opaque id of the instructor's token.
    pub by: String,
    /// Whether the instructor may set plans of exams.
    pub exams: bool,
}

/// Question for the state of the folder of recordings. The answer is a JSON object for the control socket.
pub type RecordingsState = Arc<dyn Fn() -> Value + Send + Sync>;

/// Source of plans. The server calls it on blocking threads, because a scene takes seconds to compile.
pub trait Planner: Send + Sync {
    /// Takes the doors of the server's stations, once, before the first session.
    fn connect(&self, doors: &[Door]);

    /// Takes the question for the state of the recordings' folder, once, if the folder has a quota.
    fn connect_recordings(&self, _state: RecordingsState) {}

    /// Changes the plan of a station, keeps it, and compiles it.
    ///
    /// # Errors
    /// The text is not valid, an exam runs or needs another role, or the scene cannot be compiled: one sentence.
    fn change(&self, asked: &NewPlan) -> Result<SessionPlan, String>;

    /// Compiles the present plan of a station again, with a patient drawn anew.
    ///
    /// # Errors
    /// The scene cannot be compiled: one sentence.
    fn renew(&self, station: &str) -> Result<SessionPlan, String>;

    /// Ends the seat of a learner at a station, and compiles the plan of the next session: with `had_task` the plan of
    /// the file of stations, else the present plan without a learner.
    ///
    /// # Errors
    /// The plan cannot be kept or compiled: one sentence.
    fn leave(&self, station: &str, had_task: bool) -> Result<SessionPlan, String>;
}

/// Planner of a server whose plans are fixed, such as that of the demo.
pub struct NoPlanner;

impl Planner for NoPlanner {
    fn connect(&self, _: &[Door]) {}

    fn change(&self, _: &NewPlan) -> Result<SessionPlan, String> {
        Err("plans of this server are fixed".into())
    }

    fn renew(&self, _: &str) -> Result<SessionPlan, String> {
        Err("plans of this server are fixed".into())
    }

    fn leave(&self, _: &str, _: bool) -> Result<SessionPlan, String> {
        Err("plans of this server are fixed".into())
    }
}
