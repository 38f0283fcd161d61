//! Compiler of plans: from the text of a plan to a session that is ready to run.

use crate::station::config::SessionPlan;

/// Compiler of plans. The server calls it on a blocking thread, because a scene takes seconds to compile.
pub trait Planner: Send + Sync {
    /// Compiles the text of a plan for a station.
    ///
    /// # Errors
    /// The text is not valid, or the scene cannot be compiled: one sentence.
    fn prepare(&self, station: &str, text: &str) -> Result<SessionPlan, String>;

    /// Stores the text of a plan that `by` has set, so that it outlives the server.
    ///
    /// # Errors
    /// The file cannot be written: one sentence.
    fn keep(&self, station: &str, text: &str, revision: u32, by: &str) -> Result<(), String>;
}

/// Planner of a server whose plans are fixed, such as that of the demo.
pub struct NoPlanner;

impl Planner for NoPlanner {
    fn prepare(&self, _: &str, _: &str) -> Result<SessionPlan, String> {
        Err("plans of this server are fixed".into())
    }

    fn keep(&self, _: &str, _: &str, _: u32, _: &str) -> Result<(), String> {
        Ok(())
    }
}
