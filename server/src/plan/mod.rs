//! Plans: the task of each station, set by an instructor, a class file or a command, session by session.
//!
//! - [`Plan`]: exercise, patient, mode, learner and limits of the next session of a station
//! - [`StationsFile`]: stations and their plans in a file for `serve --config`
//! - [`PlanBook`]: present plans of all stations, with revisions, kept in the state folder
//! - [`prepare()`]: scene, exercise and rubric of a plan, loaded and compiled
//!
//! # Rules
//! - A change takes effect with the next session.
//! - The plan of an exam cannot be changed while its session runs. A change before the session is kept in the plan's
//!   history.
//! - The patient of an exam has a seed of 64 random bits of the system. A typed seed is refused, because the generator
//!   is public.
//! - A plan that was set at run time stands in the state folder and replaces the plan of the file, until the command
//!   `plan set STATION --from-config`.

pub mod book;
pub mod change;
pub mod desk;
pub mod error;
mod fields;
pub mod names;
pub mod prepare;
pub mod revision;
pub mod stations;

pub use book::{PlanBook, Running, StationPlan};
pub use change::{Fault, PlanChange};
pub use desk::Desk;
pub use error::PlanError;
pub use fields::{ClockInGap, PatientSeed};
pub use prepare::{Prepared, prepare};
pub use revision::Revision;
pub use stations::{Station, StationsFile};

use std::path::PathBuf;

use serde::{Deserialize, Serialize};
use sulcus_sessions::Mode;

/// Time that a session waits for a lost student by default, seconds.
pub const RESUME_WITHIN_S: u32 = 30;

/// Task of a station: what its next session does.
///
/// A file gives any part of a plan as a [`PlanChange`]; other parts have their defaults.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "PlanChange")]
pub struct Plan {
    /// Name of a built-in exercise, path of an exercise file that ends in `.toml`, or `free` without a grade. Default:
    /// `crown`; `free` with a scene of its own.
    pub exercise: String,
    /// Scene file (TOML) or compiled scene (.scene); `None`: the scene of the exercise.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub scene: Option<PathBuf>,
    /// Seed of the generated patient; `None`: the seed of the scene file, in an exam 64 random bits.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub patient_seed: Option<PatientSeed>,
    /// Ticks per second, 250 to 8000; `None`: the rate of the scene.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rate_hz: Option<u16>,
    /// Purpose of the sessions: recorded, signed, and the rule by which a grade is presented.
    #[serde(serialize_with = "fields::mode::serialize")]
    pub mode: Mode,
    /// Opaque learner id for sessions whose token and client name none; never a name; may be empty.
    pub learner: String,
    /// Rubric file; `None`: the rubric of the exercise.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rubric: Option<PathBuf>,
    /// Longest session, seconds, 1 to 86,400; `None`: no limit.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub time_limit_s: Option<u32>,
    /// Time that a session waits for a lost student, seconds, 0 to 3600. Default 30. 0 ends a session with its
    /// connection.
    pub resume_within_s: u32,
    /// Whether the time limit includes gaps without the student. Default: runs, so that a pulled cable gives no time.
    pub clock_in_gap: ClockInGap,
    /// Largest force, newtons, above 0; `None`: the limit of the scene, which is the upper bound.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub force_limit_n: Option<f32>,
    /// Whether a client may run the ticks at the hand, which then holds the compiled mouth. `None`: except in an exam.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tick_at_hand: Option<bool>,
    /// Largest mean CPU time of a tick at the fine level of tissue, microseconds, 10 to 900; `None`: always the coarse
    /// level. A graded session needs `None`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub detail_budget_us: Option<u32>,
}

impl Default for Plan {
    fn default() -> Self {
        Self {
            exercise: "crown".into(),
            scene: None,
            patient_seed: None,
            rate_hz: None,
            mode: Mode::default(),
            learner: String::new(),
            rubric: None,
            time_limit_s: None,
            resume_within_s: RESUME_WITHIN_S,
            clock_in_gap: ClockInGap::default(),
            force_limit_n: None,
            tick_at_hand: None,
            detail_budget_us: None,
        }
    }
}

impl Plan {
    /// Name of free exploration, an exercise without a grade.
    pub const FREE: &'static str = "free";

    /// Plan with all parts of a change and defaults elsewhere, checked.
    ///
    /// # Errors
    /// Parts that do not fit each other.
    pub fn of(change: &PlanChange) -> Result<Self, Fault> {
        Self::default().with(change)
    }

    /// Plan after a change, checked. The exercise of a plan that gets a scene and no exercise is `free`.
    ///
    /// # Errors
    /// Parts that do not fit each other.
    pub fn with(&self, change: &PlanChange) -> Result<Self, Fault> {
        let plan = change.applied(self)?;
        plan.check()?;
        Ok(plan)
    }

    /// Whether the system draws the seed of the patient, for each session anew.
    pub fn draws_its_patient(&self) -> bool {
        match self.patient_seed {
            Some(PatientSeed::Number(_)) => false,
            Some(PatientSeed::System) => true,
            None => self.mode == Mode::Exam,
        }
    }

    /// Seed of the patient of the next session: drawn from the system, given, or `None` for the scene's own.
    ///
    /// `has_generated_patient` tells whether the scene takes a seed. Call the function once a session: each call draws
    /// anew.
    ///
    /// # Errors
    /// The system has no random numbers.
    pub fn seed_of_session(&self, has_generated_patient: bool) -> std::io::Result<Option<u64>> {
        let asks = match self.patient_seed {
            Some(PatientSeed::Number(seed)) => return Ok(Some(seed)),
            Some(PatientSeed::System) => true,
            None => self.mode == Mode::Exam && has_generated_patient,
        };
        if !asks {
            return Ok(None);
        }
        let mut bytes = [0; 8];
        getrandom::fill(&mut bytes).map_err(|error| std::io::Error::other(error.to_string()))?;
        Ok(Some(u64::from_le_bytes(bytes)))
    }

    /// Names of the parts that differ from those of `other`.
    pub fn differences(&self, other: &Plan) -> Vec<String> {
        let [mine, others] = [self, other].map(|plan| {
            // A plan is always an object of plain values.
            match serde_json::to_value(plan) {
                Ok(serde_json::Value::Object(parts)) => parts,
                _ => serde_json::Map::new(),
            }
        });
        PlanChange::NAMES
            .into_iter()
            .filter(|name| mine.get(*name) != others.get(*name))
            .map(str::to_owned)
            .collect()
    }
}

impl TryFrom<PlanChange> for Plan {
    type Error = Fault;

    fn try_from(change: PlanChange) -> Result<Self, Fault> {
        Self::of(&change)
    }
}

#[cfg(test)]
mod tests;
